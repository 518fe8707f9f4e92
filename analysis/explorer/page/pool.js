// The workers: one per plane, and one for traces and searches.

import { planes } from "./space.js";

export class Pool {
  /**
   * Starts the workers of a script's address; receive(message) gets all answers, isCurrent in those
   * to the last request of their kind.
   */
  constructor(address, module, receive) {
    this.sent = new Map();    // texts of the last requests, by kind
    this.pending = new Map(); // ids of those that are not answered, by kind
    this.next = 0;
    this.workers = Array.from({ length: planes.length + 1 }, () => {
      const worker = new Worker(address);
      worker.onmessage = ({ data }) => {
        const isCurrent = this.pending.get(data.kind) === data.id;
        if (data.isLast && isCurrent) this.pending.delete(data.kind);
        receive({ ...data, isCurrent });
      };
      worker.onerror = (event) => receive({ type: "failed", isCurrent: true, message: event.message });
      worker.postMessage({ type: "start", module });
      return worker;
    });
  }

  /** Sends a request, unless it equals the last one of its kind. Returns whether it was sent. */
  send(kind, worker, request) {
    const text = JSON.stringify(request);
    if (this.sent.get(kind) === text) return false;
    this.sent.set(kind, text);
    this.workers[worker].postMessage({ ...request, kind, id: ++this.next });
    this.pending.set(kind, this.next);
    return true;
  }

  get isBusy() {
    return this.pending.size > 0;
  }

  sendPlane(index, request) {
    this.send(`plane ${index}`, index, { ...request, type: "plane", index });
  }

  sendOther(type, request) {
    return this.send(type, planes.length, { ...request, type });
  }
}
