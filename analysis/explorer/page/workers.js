// The workers, and the tasks that wait for them: the most urgent one first, and each in pieces, so
// that a more urgent one starts soon.

/**
 * Ranks of tasks, the most urgent first: traces, planes, whose coarser pictures come before finer ones, a
 * search in slow scenes, the finest pictures, a search otherwise, and what few cells of a plane need.
 */
export const ranks = { trace: 0, plane: 1, slowSearch: 2, finest: 3, search: 4, late: 5 };

/** Pieces that a worker has at a time: it starts the next one while the page takes the result of the last. */
const depth = 2;
/** Workers: as many as processors, within these limits. More than processors get their share of a busy machine. */
const fewest = 4, most = 16;
/** The time of a piece, and the longest of a step of one design, ms. */
const patience = 10, stepTime = 0.002;

/** Designs to integrate, a flat array of r1, r3, r2; `job` has numbers, steps, field and tolerance. */
class Integration {
  constructor(designs, job) {
    const count = designs.length / 3;
    const piece = Math.ceil(patience / (stepTime * job.steps));
    Object.assign(this, { designs, job, first: 0, piece, left: count, found: {
      values: new Float64Array(count), statuses: new Uint8Array(count), milliseconds: 0 } });
  }

  get isEmpty() {
    return this.left === 0;
  }

  /** The next piece, null after the last one. */
  next() {
    const { first } = this;
    const designs = this.designs.slice(3 * first, 3 * (first + this.piece));
    this.first += designs.length / 3;
    return designs.length > 0 ? { first, message: { ...this.job, type: "integrate", designs } } : null;
  }

  /** Takes the results of a piece; returns those of all designs after the last one. */
  take({ values, statuses, milliseconds }, { first }) {
    this.found.values.set(values, first);
    this.found.statuses.set(statuses, first);
    this.found.milliseconds += milliseconds;
    this.piece = Math.ceil(values.length * Math.min(2, patience / milliseconds));
    this.left -= values.length;
    return this.isEmpty ? this.found : null;
  }
}

/** A single message. */
class Single {
  constructor(message) {
    this.message = message;
  }

  next() {
    const { message } = this;
    this.message = null;
    return message && { message };
  }

  take(result) {
    return result;
  }
}

export class Workers {
  /** Starts the workers of a script's address; ready(core) when each has started, fail(message) if one cannot. */
  constructor(address, module, ready, fail) {
    this.tasks = [];
    this.workers = []; // those that have started
    const count = Math.min(Math.max(navigator.hardwareConcurrency ?? fewest, fewest), most);
    for (let n = 0; n < count; ++n) {
      const worker = { port: new Worker(address), sent: [] };
      const start = (core) => {
        this.workers.push(worker);
        ready(core);
        this.#send();
      };
      worker.port.onmessage = ({ data }) => (data.core ? start(data.core) : this.#take(worker, data));
      worker.port.onerror = (event) => fail(event.message);
      worker.port.postMessage({ type: "start", module });
    }
  }

  /**
   * Integrates designs; resolves to {values, statuses, milliseconds}, the last of computing. Tasks of the
   * lowest rank are the most urgent. Once their owner is not live, they end without a result.
   */
  integrate(owner, rank, designs, job) {
    const task = new Integration(designs, job);
    return task.isEmpty ? Promise.resolve(task.found) : this.#add(owner, rank, task);
  }

  /** Traces a swing; see worker.js. */
  trace(owner, rank, message) {
    return this.#add(owner, rank, new Single({ ...message, type: "trace" }));
  }

  #add(owner, rank, task) {
    return new Promise((resolve, reject) => {
      this.tasks.push(Object.assign(task, { owner, rank, resolve, reject }));
      this.tasks.sort((a, b) => a.rank - b.rank);
      this.#send();
    });
  }

  /** Sends pieces, first to idle workers. */
  #send() {
    for (let load = 0; load < depth; ++load)
      for (const { port, sent } of this.workers.filter((worker) => worker.sent.length === load)) {
        const piece = this.#nextPiece();
        if (!piece) return;
        sent.push(piece);
        port.postMessage(piece.message);
      }
  }

  #nextPiece() {
    for (; this.tasks.length > 0; this.tasks.shift()) {
      const [task] = this.tasks;
      const piece = task.owner.isLive ? task.next() : null;
      if (piece) return { ...piece, task };
    }
    return null;
  }

  #take({ sent }, result) {
    const piece = sent.shift(), { task } = piece;
    if (result.failure && task.owner.isLive) task.reject(new Error(result.failure));
    const found = result.failure ? null : task.take(result, piece);
    this.#send();
    if (found && task.owner.isLive) task.resolve(found);
  }
}
