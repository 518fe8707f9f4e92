// The keys of a job, as in src/job/key.cpp, with controls and the ranges of their sliders, or without.
// explorer_test.py compares units and allowed values with those of trebsweep. Defaults and names of
// the scene come from the core.

import { numberText } from "./numbers.js";

/** A range of numbers; its text is that of the program's messages. */
function range(low, high, { open = false, zero = false } = {}) {
  const allows = (x) => (zero && x === 0) || (open ? low < x && x < high : low <= x && x <= high && x < Infinity);
  const [from, to] = [low, high].map((x) => x === Infinity ? "" : numberText(x, 9));
  const bounds = high === Infinity ? `a finite number ${open ? "above" : "of at least"} ${from}`
    : open ? `a number above ${from} and below ${to}`
      : `a number${low > 0 && !zero ? " above 0," : ""} from ${from} to ${to}`;
  return { allows, text: (zero ? "0, or " : "") + bounds };
}

const physical = range(1e-12, 1e12);
const physicalOrZero = range(1e-12, 1e12, { zero: true });
const positive = range(0, Infinity, { open: true });
const notNegative = range(0, Infinity);
const lengths = range(-1e12, 1e12);
const angles = range(-Math.PI, Math.PI);
const openAngles = range(-Math.PI, Math.PI, { open: true });
const turn = range(1e-12, 6.28318531);
const tolerances = range(1e-15, 0.1);

const number = (name, label, unit, allowed, slider) =>
  ({ name, label, unit, allowed, slider, kind: "number" });
/** One of the core's names. */
const choice = (name, label) =>
  ({ name, label, unit: "", kind: "choice", names: (core) => core.choices[name] });
const axis = (name, label) => ({
  name, label, unit: "m", kind: "range",
  allowed: { text: "first:last:step, including both ends, or a single value" },
});

/** Sections of the form. A slider has its ends and, with `log`, a logarithmic scale. */
export const groups = [
  { title: "Masses and heights", open: true, keys: [
    number("scene.counterweight-mass", "counterweight m1", "kg", physical, [10, 20000, "log"]),
    number("scene.projectile-mass", "projectile m3", "kg", physical, [0.1, 1000, "log"]),
    number("scene.fulcrum-height", "fulcrum height h0", "m", physical, [0.2, 12]),
    number("scene.release-height", "counterweight's initial height h", "m", physical, [0.1, 20]),
    number("scene.start-angle", "initial angle phi1", "rad", openAngles, [0.05, 2.5]),
    number("scene.start-tip-height", "initial height of the arm's tip", "m", physicalOrZero, [0, 5]),
    number("scene.gravity", "gravity g", "m/s^2", physical, [1, 25]),
  ] },
  { title: "Counterweight, trough and release", open: true, keys: [
    number("scene.counterweight-hanger", "hanger r4 (0: fixed)", "m", physicalOrZero, [0, 4]),
    number("scene.counterweight-inertia", "counterweight's own moment of inertia", "kg m^2", physicalOrZero, [0, 5000]),
    choice("scene.trough", "trough"),
    number("scene.trough-height", "height of the trough", "m", physicalOrZero, [0, 5]),
    number("scene.sling-angle", "initial angle phi2", "rad", angles, [-1.5, 1.5]),
    choice("solver.release", "release"),
    number("solver.release-angle", "angle phi1 at release", "rad", turn, [1.5, 4.7]),
    number("solver.pin-angle", "pin: angle phi1 - phi2", "rad", openAngles, [-1, 3]),
    number("solver.max-time", "longest swing", "s", positive, [1, 20]),
  ] },
  { title: "Beam", keys: [
    number("scene.beam-density", "density", "kg/m^3", physicalOrZero, [0, 8000]),
    number("scene.beam-side", "side of the section", "m", physicalOrZero, [0, 0.6]),
    number("scene.beam-width", "width of the section", "m", physical, [0.01, 0.6]),
    number("scene.beam-depth", "depth of the section, in the plane of the swing", "m", physical, [0.01, 0.6]),
    choice("scene.beam-inertia", "moment of inertia"),
    number("scene.beam-mass", "measured mass m2", "kg", physicalOrZero, [0, 2000]),
    number("scene.beam-centre", "measured centre of mass", "m", lengths, [-2, 5]),
    number("scene.beam-moment", "measured moment of inertia", "kg m^2", physicalOrZero, [0, 5000]),
    number("scene.beam-section-modulus", "measured section modulus", "m^3", physical, [1e-6, 0.05, "log"]),
  ] },
  { title: "Sling and friction", keys: [
    number("scene.sling-mass", "mass of the sling", "kg", physicalOrZero, [0, 50]),
    number("scene.sling-stiffness", "stiffness of the sling (0: rigid)", "N/m", physicalOrZero,
           [0, 1e6]),
    number("scene.sling-damping", "damping of the sling", "N s/m", physicalOrZero, [0, 2000]),
    number("scene.pivot-viscosity", "viscous friction", "N m s/rad", physicalOrZero, [0, 500]),
    number("scene.pivot-friction", "dry friction", "N m", physicalOrZero, [0, 3000]),
  ] },
  { title: "Flight", keys: [
    number("scene.projectile-diameter", "diameter (0: no drag)", "m", physicalOrZero, [0, 1]),
    number("scene.drag-coefficient", "drag coefficient", "", physicalOrZero, [0, 2]),
    number("scene.air-density", "density of the air", "kg/m^3", physicalOrZero, [0, 2]),
    number("scene.wind", "wind", "m/s", range(-1000, 1000), [-20, 20]),
  ] },
  { title: "Lattice", keys: [
    number("lattice.increment", "increment dr", "m", physical, [0.001, 0.5, "log"]),
    number("lattice.shortest-sling", "shortest sling", "m", physical, [0.05, 5]),
    axis("lattice.r1", "r1, first:last:step"),
    axis("lattice.r3", "r3, first:last:step"),
    axis("lattice.r2", "r2, first:last:step"),
  ] },
];

export const keys = groups.flatMap((group) => group.keys);

/** The steppers, and those of them that take steps of a fixed length. */
export const steppers = [
  "euler", "modified_midpoint", "rk4", "cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8",
  "adams_bashforth_moulton", "bulirsch_stoer", "rosenbrock4",
];
export const fixedSteppers = ["euler", "modified_midpoint", "rk4", "adams_bashforth_moulton"];

const notQuantities = ["status", "energy-drift", "steps", "speed-error", "stiffness", "decay-rate", "slack"];
const fields = (core) => core.fields.map(({ name }) => name);
const oneOf = (...names) => ({ kind: "choice", names: () => names });
const stepper = oneOf(...steppers), yesNo = oneOf("no", "yes");
const field = { kind: "choice", names: fields };
const quantity = { kind: "quantity", names: (core) => fields(core).filter((name) => !notQuantities.includes(name)) };
const integer = (low, high) =>
  ({ kind: "integer", allowed: { allows: range(low, high).allows, text: `an integer from ${low} to ${high}` } });
const numberIn = (allowed) => ({ kind: "number", allowed });
const listOf = (item) => ({ kind: "list", item });
const setOf = (item) => ({ kind: "list", item, isSet: true });

/** Keys that the page has no control for. It reads them, checks them, and writes them to job files. */
const otherKeys = Object.entries({
  "solver.stepper": stepper,
  "solver.time-step": numberIn(positive),
  "solver.tolerance": numberIn(tolerances),
  "solver.target-error": numberIn(positive),
  "solver.release-window": numberIn(range(0, Math.PI / 2, { open: true })),
  "solver.max-steps": integer(1, 1e12),
  "solver.check": yesNo,
  "output.file": { kind: "path" },
  "output.fields": setOf(field),
  "output.optimum": oneOf("all", "taut"),
  "output.maps": oneOf("all", "none"),
  "output.storage": oneOf("float64", "float32"),
  "output.compression": integer(0, 9),
  "optimum.objective": quantity,
  "optimum.minimize": { kind: "text" },
  "optimum.subject-to": { kind: "constraints", names: quantity.names },
  "optimum.variables": { kind: "text" },
  "optimum.deviation": numberIn(physicalOrZero),
  "optimum.robust": oneOf("no", "worst", "expected"),
  "optimum.buildable": yesNo,
  "optimum.refine": yesNo,
  "assess.scenes": { kind: "paths" },
  "assess.extremes": { kind: "paths" },
  "assess.steppers": setOf(stepper),
  "assess.time-steps": listOf(numberIn(positive)),
  "assess.tolerances": listOf(numberIn(tolerances)),
  "assess.designs": integer(1, 100000),
  "assess.repeats": integer(1, 1000),
  "assess.target-error": numberIn(positive),
  "assess.lattice-seconds": numberIn(notNegative),
}).map(([name, kind]) => ({ name, ...kind }));

export const keyByName = new Map([...keys, ...otherKeys].map((key) => [key.name, key]));

/** The sections of a job file. */
export const sections = ["scene", "lattice", "solver", "output", "optimum", "assess"];

/** What a key allows, in words. */
export function allowedText(key, core) {
  return key.kind === "choice" ? `one of ${key.names(core).join(", ")}` : key.allowed.text;
}

/** Defaults that the numerical core does not know, of keys that rules depend on. */
export const otherDefaults = {
  "lattice.increment": 0.01, "lattice.shortest-sling": 0.3, "solver.stepper": "vern8",
  "output.fields": ["speed", "release-time", "status"], "optimum.objective": "speed", "optimum.subject-to": [],
  "optimum.deviation": 0, "optimum.robust": "no",
};
