// What a job may be: the values of its keys, and those rules of src/job/rules.cpp that concern the
// page, so that a field can show the program's message. explorer_test.py compares the messages.
// A job is an object of texts by key, as in a job file; a key that is not given has its default.

import { allowedText, keys, keyByName, latticeDefaults, namesOf } from "./keys.js";
import { InputError, refuse } from "./input_error.js";
import { boxOf } from "./space.js";

/** The number of a text, NaN if it is not one. */
export function parseNumber(text) {
  const trimmed = String(text).trim();
  return /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/.test(trimmed) ? Number(trimmed) : NaN;
}

/** Whether a number of metres can be a length. */
export const isLength = (x) => x >= 1e-12 && x <= 1e12;

/** An axis, {first, last, step}; the step of a single value is 0. */
function parseAxis(key, text) {
  const allowed =
    "first:last:step or a single value, in metres, each from 1e-12 to 1e+12, with first <= last";
  const [first, last = first, step = 0, ...rest] = text.split(":").map(parseNumber);
  const parts = text.split(":").length;
  if (rest.length || parts === 2 || !isLength(first) || !isLength(last) || first > last ||
      (parts === 3 && !isLength(step)))
    refuse(key, text, allowed);
  const steps = parts === 3 ? (last - first) / step : 0;
  if (Math.abs(steps - Math.round(steps)) > 1e-9 + 1e-15 * last / step)
    refuse(key, text, "a range whose last value is an integer number of steps from the first; the " +
      `nearest are ${shortest(first + Math.floor(steps) * step)} and ` +
      `${shortest(first + Math.ceil(steps) * step)}`);
  return { first, last, step };
}

/** A number with at most 15 digits. */
export function shortest(x) {
  return String(Number(x.toPrecision(15)));
}

/** The value of a key: a name, a number or an axis. Throws InputError. */
function valueOf(key, text, core) {
  if (key.kind === "choice") {
    if (!namesOf(key, core).includes(text)) refuse(key.name, text, allowedText(key, core));
    return text;
  }
  if (key.kind === "range") return parseAxis(key.name, text);
  const x = parseNumber(text);
  if (!key.allowed.allows(x)) refuse(key.name, text, key.allowed.text);
  return x;
}

/** Why each key that a job does not use must be left out. `get(name)` is the value of a key. */
function unusedKeys(get) {
  const unused = new Map();
  const leaveOut = (names, why) => names.forEach((name) => unused.set(name, `left out ${why}`));
  if (!Number.isNaN(get("scene.start-angle")))
    leaveOut(["scene.release-height"], "with scene.start-angle, which determines it");
  if (!Number.isNaN(get("scene.beam-mass")))
    leaveOut(["scene.beam-density", "scene.beam-side", "scene.beam-inertia"],
             "with scene.beam-mass, beam-centre and beam-moment, which describe the whole beam");
  if (get("scene.trough") === "yes")
    leaveOut(["scene.sling-angle"], "with scene.trough = yes, which determines it");
  else
    leaveOut(["scene.trough-height"], "unless scene.trough is yes");
  if (get("scene.projectile-diameter") === 0)
    leaveOut(["scene.drag-coefficient", "scene.air-density", "scene.wind"],
             "unless scene.projectile-diameter is above 0");
  if (get("solver.release") !== "crossing")
    leaveOut(["solver.release-angle"], "unless solver.release is crossing");
  if (get("solver.release") !== "pin")
    leaveOut(["solver.pin-angle"], "unless solver.release is pin");
  return unused;
}

function checkBeam(get) {
  const names = ["scene.beam-mass", "scene.beam-centre", "scene.beam-moment"];
  const given = names.filter((name) => !Number.isNaN(get(name)));
  const missing = names.filter((name) => Number.isNaN(get(name)));
  if (given.length === 0) return;
  if (missing.length)
    throw new InputError(missing[0], `${missing.join(", ")}: must be given with ` +
      `${given.join(", ")}: a measured beam has a mass, a centre and a moment of inertia`);
  const [mass, centre, moment] = names.map(get);
  const least = mass * centre * centre;
  if (moment < least * (1 - 1e-12))
    refuse(names[2], moment,
           `at least beam-mass * beam-centre^2 = ${least} kg m^2, that of a point mass`);
}

function checkRules(get) {
  if (get("solver.release") === "pin" && Number.isNaN(get("solver.pin-angle")))
    throw new InputError("solver.pin-angle",
                         "solver.pin-angle: must be given with solver.release = pin");
  checkBeam(get);
  const trough = get("scene.trough") === "yes", hanger = get("scene.counterweight-hanger") > 0;
  if (trough && get("scene.trough-height") >= get("scene.fulcrum-height"))
    refuse("scene.trough-height", get("scene.trough-height"),
           `below scene.fulcrum-height = ${get("scene.fulcrum-height")}`);
  const stiffness = get("scene.sling-stiffness");
  if (get("scene.sling-damping") > 0 && stiffness === 0)
    refuse("scene.sling-damping", get("scene.sling-damping"),
           "0 unless scene.sling-stiffness is above 0: a rigid sling does not stretch");
  if (stiffness > 0 && (hanger || trough))
    refuse("scene.sling-stiffness", stiffness,
           `0 with ${hanger ? "scene.counterweight-hanger above 0" : "scene.trough = yes"}: the ` +
           `equations of an elastic sling do not include ${hanger ? "a hanger" : "a trough"}`);
}

/** The default of a key; null for an axis without one. */
function defaultOf(name, core) {
  if (name in latticeDefaults) return latticeDefaults[name];
  const value = core.defaults[name], names = core.choices[name];
  return names ? names[value] : value ?? null;
}

/** The values that the core needs, as numbers. */
function numbersOf(values, unused, core) {
  const numbers = {};
  for (const [name, value] of Object.entries(values))
    if (name in core.defaults && !unused.has(name))
      numbers[name] = name in core.choices ? core.choices[name].indexOf(value) : value;
  return numbers;
}

/** A job without the keys that checkedJob refuses, as {job, mistakes}: their messages. */
export function mended(job, core) {
  const kept = { ...job }, mistakes = [];
  for (;;)
    try {
      checkedJob(kept, core);
      return { job: kept, mistakes };
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      mistakes.push(error.message);
      if (error.key in kept) delete kept[error.key];
      else Object.keys(kept).forEach((name) => delete kept[name]); // a rule between other keys
    }
}

/**
 * The numbers of a job for the core, the box of its design space, and the unused keys.
 * @param core {defaults: numbers by key, choices: names by key}
 * Throws InputError for the first mistake.
 */
export function checkedJob(job, core) {
  const values = {};
  for (const key of keys)
    if (job[key.name] !== undefined && job[key.name] !== "")
      values[key.name] = valueOf(key, job[key.name], core);
  const get = (name) => values[name] ?? defaultOf(name, core);
  const unused = unusedKeys(get);
  checkRules((name) => unused.has(name) ? defaultOf(name, core) : get(name));
  return { get, unused, box: boxOf(get), numbers: numbersOf(values, unused, core) };
}
