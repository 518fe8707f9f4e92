// What the page asks for: planes, traces, values and searches, each the last one of its kind.

import { drawPasses } from "./passes.js";
import { search } from "./search.js";
import { ranks, Workers } from "./workers.js";

/** Answers that are shown even if they are no longer to the last request. */
const shownLate = ["trace", "plane"];
const traceTolerance = 1e-12, traceSteps = 50000;
/** A looser tolerance: the difference of the speeds is an estimate of their error. */
const checkTolerance = 1e-10;

export class Pool {
  /**
   * Starts the workers of a script's address; receive(message) gets all answers, isCurrent in those
   * to the last request of their kind.
   */
  constructor(address, module, receive) {
    this.receive = receive;
    this.sent = new Map();    // texts of the last requests, by kind
    this.running = new Map(); // requests that are computed, by kind
    this.held = new Map();    // requests that wait for the first answer to the one before, by kind
    const ready = (core) => {
      this.core = core;
      receive({ type: "ready", core });
    };
    this.workers = new Workers(address, module, ready, (message) =>
      receive({ type: "failed", isCurrent: true, message }));
  }

  /** Sends a request, unless it equals the last one of its kind. Returns whether it was sent. */
  #send(kind, content) {
    const text = JSON.stringify(content);
    if (this.sent.get(kind) === text) return false;
    this.sent.set(kind, text);
    const request = { ...content, kind, isLive: true, hasAnswer: false };
    const before = this.running.get(kind);
    if (before && !before.hasAnswer && shownLate.includes(content.type)) this.held.set(kind, request);
    else this.#start(request);
    return true;
  }

  get isBusy() {
    return this.running.size > 0;
  }

  sendPlane(index, request) {
    this.#send(`plane ${index}`, { ...request, type: "plane", index });
  }

  sendOther(type, request) {
    return this.#send(type, { ...request, type });
  }

  async #start(request) {
    const before = this.running.get(request.kind);
    if (before) before.isLive = false;
    this.running.set(request.kind, request);
    try {
      await this.#compute(request);
    } catch (error) {
      if (!request.isLive) throw error; // by the page, which has the last answer
      this.#answer(request, { type: "failed", failed: request.type, message: error.message });
    }
  }

  #answer(request, content, isLast = true) {
    const { kind, type, index } = request, next = this.held.get(kind);
    if (!request.isLive) return;
    request.hasAnswer = true;
    if (isLast || next) {
      request.isLive = false;
      this.running.delete(kind);
    }
    if (next) {
      this.held.delete(kind);
      this.#start(next);
    }
    this.receive({ type, index, isLast, isCurrent: !next, ...content });
  }

  #compute(request) {
    const { numbers, field, box } = request;
    const show = (content, isLast) => this.#answer(request, content, isLast);
    const integrate = (designs, tolerance = traceTolerance, steps = traceSteps, rank = ranks[request.type] ?? 0) =>
      this.workers.integrate(request, rank, designs, { numbers, field, tolerance, steps });
    const budget = this.core.statuses.indexOf("step_budget"), isUnfinished = (status) => status === budget;
    const trace = async () => {
      const looser = [checkTolerance, request.planeTolerance];
      const { trace, changes: [error, planeError] } = await this.workers.trace(request, ranks.trace,
        { numbers, design: request.design, looser, tolerance: traceTolerance, steps: traceSteps });
      show({ trace, error, planeError });
    };
    const values = async () => show({ values: (await integrate(Float64Array.from(request.designs))).values });
    return {
      trace,
      pinned: trace,
      values,
      offer: values,
      plane: () => drawPasses(request, integrate, isUnfinished, show),
      search: () => search(box, integrate, isUnfinished, show),
    }[request.type]();
  }
}
