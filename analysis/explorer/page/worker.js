// A worker: computes one message after another. workers.js sends them.

import { Engine } from "./engine.js";

let engine, module;

function start(message) {
  module = message.module;
  engine = new Engine(module);
  const { defaults, choices, fields, statuses, statusMeanings } = engine;
  return { core: { defaults, choices, fields, statuses, statusMeanings } };
}

function setJob({ numbers, steps }) {
  engine.setJob({ ...numbers, "solver.max-steps": steps });
}

function integrate(message) {
  setJob(message);
  const start = performance.now();
  const found = engine.integrate(message.designs, message.field, message.tolerance);
  return { ...found, milliseconds: performance.now() - start };
}

/** A trace, and the changes of its speed at looser tolerances. */
function trace(message) {
  setJob(message);
  const { r1, r3, r2 } = message.design;
  const found = engine.trace(message.design, message.tolerance);
  const changes = message.looser.map((tolerance) => {
    const { values } = engine.integrate(Float64Array.of(r1, r3, r2), "speed", tolerance);
    return Math.abs(values[0] - found.fields.speed);
  });
  return { trace: found, changes };
}

const handlers = { start, integrate, trace };

onmessage = ({ data }) => {
  try {
    postMessage(handlers[data.type](data));
  } catch (error) {
    if (data.type === "start") throw error;
    engine = new Engine(module); // a trap leaves the stack of the old one as it was
    postMessage({ failure: error.message });
  }
};
