// The numerical core, compiled to WebAssembly (explorer.cpp): numbers in, numbers out.

/** Where SwingResult has its members; explorer.cpp checks it. */
const RESULT = { bytes: 32, speed: 0, releaseTime: 8, steps: 16, status: 24 };
/** Fields that every result has, and fields with an integration of their own, which are left out. */
const BASIC = ["speed", "release-time", "status", "steps"];
const SEPARATE = ["speed-error", "stiffness", "decay-rate"];

export class Engine {
  /** @param module a WebAssembly.Module */
  constructor(module) {
    const imports = {};
    // The C library could print, but never does.
    for (const { module: space, name } of WebAssembly.Module.imports(module))
      (imports[space] ??= {})[name] = () => 0;
    this.core = new WebAssembly.Instance(module, imports).exports;
    this.core._initialize();
    const info = JSON.parse(this.#text(this.core.describe()));
    Object.assign(this, info);
    this.columns = info.columns.split(" ");
    this.flightColumns = info.flightColumns.split(" ");
    this.defaults = Object.fromEntries(this.keys.map((key, i) => [key, this.core.get_key(i)]));
    this.requestable = this.fields.map((field) => field.name)
      .filter((name) => !BASIC.includes(name) && !SEPARATE.includes(name));
  }

  /** Sets every key: those of `values` (numbers; NaN for a missing one), the others to defaults. */
  setJob(values) {
    this.keys.forEach((key, i) => this.core.set_key(i, values[key] ?? this.defaults[key]));
  }

  /**
   * Integrates designs, a flat array of r1, r3, r2 (m), at a tolerance.
   * Returns the values of a field, NaN where there is none, and the statuses.
   */
  integrate(designs, field, tolerance) {
    const count = designs.length / 3;
    const values = new Float64Array(count), statuses = new Uint8Array(count);
    const isBasic = BASIC.includes(field);
    const requested = field === "status" ? "range" : field; // a release below the ground needs the flight
    const fields = BASIC.includes(requested) ? [] : [requested];
    for (let first = 0; first < count; first += this.maxDesigns) {
      const n = Math.min(this.maxDesigns, count - first);
      this.#put(designs.subarray(3 * first, 3 * (first + n)), fields);
      this.core.integrate(n, fields.length, tolerance);
      for (let i = 0; i < n; ++i) {
        const result = this.#result(i);
        statuses[first + i] = result.status;
        if (isBasic) values[first + i] = this.#basic(result, field);
      }
      if (!isBasic) values.set(this.#numbers(this.core.values_address(), n), first);
    }
    return { values, statuses };
  }

  /**
   * The swing of one design (an object of r1, r3, r2), at a tolerance: its status, all fields, rows
   * and flight, each as an object of arrays by column.
   */
  trace(design, tolerance) {
    this.#put(Float64Array.of(design.r1, design.r3, design.r2), this.requestable);
    const rowCount = this.core.trace(this.requestable.length, tolerance);
    const result = this.#result(0);
    const values = this.#numbers(this.core.values_address(), this.requestable.length);
    const fields = { speed: result.speed, "release-time": result.releaseTime };
    this.requestable.forEach((name, i) => { fields[name] = values[i]; });
    return {
      design,
      fields,
      status: this.statuses[result.status],
      rows: this.#table(this.core.rows_address(), rowCount, this.columns),
      flight: this.#table(this.core.flight_address(), this.core.flight_count(), this.flightColumns),
    };
  }

  #put(designs, fields) {
    this.#numbers(this.core.designs_address(), designs.length).set(designs);
    const indices = fields.map((name) => this.fields.findIndex((field) => field.name === name));
    new Int32Array(this.core.memory.buffer, this.core.fields_address(), indices.length).set(indices);
  }

  #result(i) {
    const view = new DataView(this.core.memory.buffer, this.core.results_address() + RESULT.bytes * i);
    return {
      speed: view.getFloat64(RESULT.speed, true),
      releaseTime: view.getFloat64(RESULT.releaseTime, true),
      steps: Number(view.getBigUint64(RESULT.steps, true)),
      status: view.getUint8(RESULT.status),
    };
  }

  #basic(result, field) {
    return { "speed": result.speed, "release-time": result.releaseTime, "status": result.status,
             "steps": result.steps }[field];
  }

  #numbers(address, count) {
    return new Float64Array(this.core.memory.buffer, address, count);
  }

  #table(address, count, columns) {
    const numbers = this.#numbers(address, count * columns.length);
    return Object.fromEntries(columns.map((name, c) =>
      [name, Float64Array.from({ length: count }, (_, r) => numbers[r * columns.length + c])]));
  }

  #text(address) {
    const bytes = new Uint8Array(this.core.memory.buffer);
    return new TextDecoder().decode(bytes.slice(address, bytes.indexOf(0, address)));
  }
}
