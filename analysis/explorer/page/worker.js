// The worker: planes, traces and searches, in pieces, so that a newer request replaces an older one.

import { Engine } from "./engine.js";
import { search } from "./search.js";
import { planeDesigns, windowOf } from "./space.js";

/** The time, ms, after which a newer request is looked for. */
const patience = 8;
/** Steps of a swing, after which its status is step_budget: stiff slings must not stall the page. */
const maxSteps = { plane: 20000, search: 20000, trace: 50000 };
const traceTolerance = 1e-12;
/** A looser tolerance: the difference bounds the error of the speed. */
const checkTolerance = 1e-10;

let engine, module;
const latest = {};

const channel = new MessageChannel();
const waiting = [];
channel.port1.onmessage = () => waiting.shift()();

/** Lets messages in. */
function pause() {
  return new Promise((resolve) => {
    waiting.push(resolve);
    channel.port2.postMessage(0);
  });
}

function answer({ type, kind, id }, content, isLast = true) {
  postMessage({ type, kind, id, isLast, ...content });
}

function setJob({ numbers, type }, tolerance = traceTolerance) {
  const steps = maxSteps[tolerance === traceTolerance ? "trace" : type];
  engine.setJob({ ...numbers, "solver.max-steps": steps });
}

/** Integrates designs in pieces; null if a newer request has arrived. */
async function integrated(request, designs, field, tolerance) {
  const count = designs.length / 3;
  const values = new Float64Array(count), statuses = new Uint8Array(count);
  let piece = 64;
  for (let first = 0; first < count;) {
    if (first > 0) await pause();
    if (latest[request.type] !== request.id) return null;
    const start = performance.now();
    setJob(request, tolerance);
    const part = engine.integrate(designs.subarray(3 * first, 3 * (first + piece)), field, tolerance);
    values.set(part.values, first);
    statuses.set(part.statuses, first);
    first += piece;
    const time = performance.now() - start;
    if (time < patience / 2) piece *= 2;
    if (time > patience) piece = Math.max(8, piece >> 1);
  }
  return { values, statuses };
}

async function sendPlane(request) {
  for (const [n, tolerance] of request.passes) {
    const start = performance.now();
    const { designs, cells } = planeDesigns(request.box, request.plane, request.at, n);
    const found = await integrated(request, designs, request.field, tolerance);
    if (!found) return;
    const values = new Float64Array(n * n).fill(NaN), statuses = new Uint8Array(n * n);
    cells.forEach((cell, i) => {
      values[cell] = found.values[i];
      statuses[cell] = found.statuses[i];
    });
    const milliseconds = performance.now() - start;
    const picture = {
      field: request.field, values, statuses, columns: n, rows: n,
      u: windowOf(request.box[request.plane.u]), v: windowOf(request.box[request.plane.v]),
    };
    answer(request, { index: request.index, picture, milliseconds, designs: cells.length },
           n === request.passes.at(-1)[0]);
    await pause();
  }
}

function sendTrace(request) {
  setJob(request);
  const trace = engine.trace(request.design, traceTolerance);
  const { r1, r3, r2 } = request.design;
  const error = (tolerance) => {
    const { values } = engine.integrate(Float64Array.of(r1, r3, r2), "speed", tolerance);
    return Math.abs(values[0] - trace.fields.speed);
  };
  answer(request, { trace, error: error(checkTolerance), planeError: error(request.planeTolerance) });
}

/** The values of a field of a few designs. */
function sendValues(request) {
  setJob(request);
  const { values } = engine.integrate(Float64Array.from(request.designs), request.field, traceTolerance);
  answer(request, { values });
}

async function sendMaxima(request) {
  const superseded = new Error("a newer request");
  try {
    const maxima = await search(request.box, async (designs, tolerance) => {
      const found = await integrated(request, designs, request.field, tolerance);
      await pause();
      if (!found || latest.search !== request.id) throw superseded;
      return found.values;
    }, traceTolerance);
    answer(request, { maxima });
  } catch (error) {
    if (error !== superseded) throw error;
  }
}

const handlers =
  { plane: sendPlane, trace: sendTrace, pinned: sendTrace, values: sendValues, search: sendMaxima };

function start(request) {
  module = request.module;
  engine = new Engine(module);
  const { defaults, choices, fields, statuses, statusMeanings } = engine;
  postMessage({ type: "ready", core: { defaults, choices, fields, statuses, statusMeanings } });
}

async function handle(request) {
  latest[request.type] = request.id;
  await pause(); // a newer request may already wait
  if (latest[request.type] !== request.id) return;
  try {
    await handlers[request.type](request);
  } catch (error) {
    engine = new Engine(module); // a trap leaves the stack of the old one as it was
    answer({ ...request, type: "failed" }, { failed: request.type, index: request.index, message: error.message });
  }
}

onmessage = ({ data }) => (data.type === "start" ? start(data) : handle(data));
