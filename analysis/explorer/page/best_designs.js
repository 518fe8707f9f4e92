// The best designs found: the buttons that lead to them, and the crosshair that waits for them.

import { valueText } from "./quantities.js";

const at = (id) => document.getElementById(id);

export class BestDesigns {
  /** @param adopt moves the crosshair to a design; isOwn: without an action of the user */
  constructor(adopt) {
    Object.assign(this, { adopt, maxima: null, isAwaited: false, isSearching: true });
    at("best").onclick = () => adopt(this.maxima[0].design);
  }

  /** The best design so far, undefined if none is known. */
  get design() {
    return this.maxima?.[0]?.design;
  }

  /** Takes the designs, best first, as {design, value}; null: none is known yet. The search ends at progress 1. */
  take(maxima, quantity, progress = 1) {
    Object.assign(this, { maxima, quantity });
    const text = ({ value }) => `${valueText(quantity, value, 6)} ${quantity.unit}`;
    const [best] = maxima ?? [];
    this.isSearching = !maxima || progress < 1;
    at("best").disabled = this.isSearching || !best;
    const soFar = best ? `: so far ${text(best)} (${Math.floor(100 * progress)} %)` : " …";
    at("best").textContent = this.isSearching ? `Searching for the best ${quantity.label}${soFar}`
      : best ? `Go to the best ${quantity.label} found: ${text(best)}` : `No design with a ${quantity.label} found`;
    const others = this.isSearching ? [] : maxima.slice(1, 4);
    at("maxima").replaceChildren(...others.map((maximum) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = `Local maximum: ${text(maximum)}`;
      button.onclick = () => this.adopt(maximum.design);
      return button;
    }));
    if (this.isAwaited && best && !this.isSearching) this.#arrive();
  }

  /** Takes a design that the search has missed, if it is better than those found. */
  offer(trial) {
    if (this.isSearching || !this.isMissed(trial.value)) return;
    this.take([trial, ...this.maxima], this.quantity);
  }

  /** Whether a value is larger than that of the best design, by more than rounding. */
  isMissed(value) {
    const best = this.maxima[0]?.value ?? -Infinity;
    return value > best && !(value - best <= 1e-6 * Math.abs(best));
  }

  /** Moves the crosshair to the best design as soon as it is known. */
  await() {
    this.isAwaited = true;
    if (this.design && !this.isSearching) this.#arrive();
  }

  #arrive() {
    this.isAwaited = false;
    this.adopt(this.design, true);
  }
}
