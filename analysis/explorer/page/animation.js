// Plays the swing and the flight, and draws them together with the plots.

import { drawFlight, drawMachine, endOf } from "./machine.js";
import { drawPlots } from "./plots.js";

const at = (id) => document.getElementById(id);

export class Animation {
  constructor() {
    Object.assign(this, { traces: [], time: 0, isPlaying: false, last: null });
    at("play").onclick = () => this.#play(!this.isPlaying);
    at("time").oninput = () => {
      this.#play(false);
      this.time = (at("time").value / at("time").max) * this.#end();
      this.#draw();
    };
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.#play(true);
  }

  /** Shows the traces of the design and of the pinned one, each with its `scene`, or null. */
  show(traces) {
    this.traces = traces;
    this.#draw();
  }

  #end() {
    return this.traces[0] ? endOf(this.traces[0]) : 0;
  }

  #play(on) {
    this.isPlaying = on;
    this.last = null;
    at("play").textContent = on ? "Pause" : "Play";
    cancelAnimationFrame(this.frame);
    if (on) this.frame = requestAnimationFrame((now) => this.#step(now));
  }

  #step(now) {
    const seconds = this.last === null ? 0 : Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    this.time += seconds * Number(at("pace").value);
    if (this.time > this.#end() + 0.4) this.time = 0; // a moment on the ground
    this.#draw();
    this.frame = requestAnimationFrame((next) => this.#step(next));
  }

  #draw() {
    const end = this.#end(), t = Math.min(this.time, end);
    at("time").value = end > 0 ? (t / end) * at("time").max : 0;
    at("time").setAttribute("aria-valuetext", `${t.toFixed(3)} s`);
    at("clock").textContent = `${t.toFixed(3)} s`;
    drawMachine(at("machine"), this.traces, t);
    drawFlight(at("flight"), this.traces, t);
    drawPlots(at("plots"), this.traces, t);
  }
}
