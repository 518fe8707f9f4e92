// The keys of a job that the page has controls for, with the ranges of their sliders. Units and
// allowed values are those of src/job/key.cpp; explorer_test.py compares them with the help of
// trebsweep. Defaults and names come from the core.

/** A range of numbers; its text is that of the program's messages. */
const range = (low, high, { open = false, zero = false } = {}) => ({
  allows: (x) => (zero && x === 0) || (open ? low < x && x < high : low <= x && x <= high),
  text: high === Infinity
    ? `a finite number above ${low}`
    : (zero ? "0, or " : "") + (open ? `a number above ${low} and below ${high}`
      : `a number${low > 0 && !zero ? " above 0," : ""} from ${digits(low)} to ${digits(high)}`),
});

function digits(x) {
  return Math.abs(x) >= 1e9 ? `${x < 0 ? "-" : ""}1e+12` : String(x);
}

const physical = range(1e-12, 1e12);
const physicalOrZero = range(1e-12, 1e12, { zero: true });
const positive = range(0, Infinity, { open: true });
const lengths = range(-1e12, 1e12);
const angles = range(-3.14159265358979312, 3.14159265358979312);
angles.text = "a number from -3.14159265 to 3.14159265";
const openAngles = range(-3.14159265358979312, 3.14159265358979312, { open: true });
openAngles.text = "a number above -3.14159265 and below 3.14159265";
const turn = range(1e-12, 6.28318531);

const number = (name, label, unit, allowed, slider) =>
  ({ name, label, unit, allowed, slider, kind: "number" });
/** One of the core's names, without those in `excluded`. */
const choice = (name, label, excluded = []) => ({ name, label, unit: "", kind: "choice", excluded });
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
    number("scene.gravity", "gravity g", "m/s^2", physical, [1, 25]),
  ] },
  { title: "Counterweight, trough and release", open: true, keys: [
    number("scene.counterweight-hanger", "hanger r4 (0: fixed)", "m", physicalOrZero, [0, 4]),
    choice("scene.trough", "trough"),
    number("scene.trough-height", "height of the trough", "m", physicalOrZero, [0, 5]),
    number("scene.sling-angle", "initial angle phi2", "rad", angles, [-1.5, 1.5]),
    choice("solver.release", "release", ["window"]), // which is for fixed steps,
    number("solver.release-angle", "angle phi1 at release", "rad", turn, [1.5, 4.7]),
    number("solver.pin-angle", "pin: angle phi1 - phi2", "rad", openAngles, [-1, 3]),
    number("solver.max-time", "longest swing", "s", positive, [1, 20]),
  ] },
  { title: "Beam", keys: [
    number("scene.beam-density", "density", "kg/m^3", physicalOrZero, [0, 8000]),
    number("scene.beam-side", "side of the section", "m", physicalOrZero, [0, 0.6]),
    choice("scene.beam-inertia", "moment of inertia"),
    number("scene.beam-mass", "measured mass m2", "kg", physicalOrZero, [0, 2000]),
    number("scene.beam-centre", "measured centre of mass", "m", lengths, [-2, 5]),
    number("scene.beam-moment", "measured moment of inertia", "kg m^2", physicalOrZero, [0, 5000]),
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

/** The names that a choice allows. */
export function namesOf(key, core) {
  return core.choices[key.name].filter((name) => !key.excluded.includes(name));
}

/** What a key allows, in words. */
export function allowedText(key, core) {
  return key.kind === "choice" ? `one of ${namesOf(key, core).join(", ")}` : key.allowed.text;
}

export const keys = groups.flatMap((group) => group.keys);
export const keyByName = new Map(keys.map((key) => [key.name, key]));

/** Defaults of [lattice], which the numerical core does not know. */
export const latticeDefaults = { "lattice.increment": 0.01, "lattice.shortest-sling": 0.3 };
