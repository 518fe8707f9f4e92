// What a job may be: the rules of src/job/rules.cpp, so that the page can show the program's messages.
// explorer_test.py compares them. A job is an object of texts by key, as in a job file; a key that is
// not given has its default.

import { fixedSteppers, keys, keyByName, otherDefaults, steppers } from "./keys.js";
import { InputError, refuse } from "./input_error.js";
import { numberText } from "./numbers.js";
import { boxOf, withTroughAxes } from "./space.js";
import { valueOf } from "./values.js";

/** Why each key that a job does not use must be left out. `get(name)` is the value of a key. */
export function unusedKeys(get) {
  const unused = new Map();
  const leaveOut = (names, why) => names.forEach((name) => unused.has(name) || unused.set(name, `left out${why}`));
  if (!Number.isNaN(get("scene.start-angle")))
    leaveOut(["scene.release-height"], " with scene.start-angle, which determines it");
  if (!Number.isNaN(get("scene.start-tip-height")))
    leaveOut(["scene.release-height", "scene.start-angle"], " with scene.start-tip-height, which determines it");
  if (!Number.isNaN(get("scene.beam-mass")))
    leaveOut(["scene.beam-density", "scene.beam-side", "scene.beam-width", "scene.beam-depth", "scene.beam-inertia"],
             " with scene.beam-mass, beam-centre and beam-moment, which describe the whole beam");
  else
    leaveOut(["scene.beam-section-modulus"],
             " unless scene.beam-mass is given: it follows from the section of other beams");
  if (!Number.isNaN(get("scene.beam-width")) || !Number.isNaN(get("scene.beam-depth")))
    leaveOut(["scene.beam-side"], " with scene.beam-width and beam-depth, which determine it");
  if (get("scene.trough") === "yes")
    leaveOut(["scene.sling-angle"], " with scene.trough = yes, which determines it");
  if (get("scene.trough") === "yes" && !get("lattice.r3"))
    leaveOut(["lattice.shortest-sling"], " with scene.trough = yes; give lattice.r3");
  if (get("scene.trough") === "no")
    leaveOut(["scene.trough-height"], " unless scene.trough is yes");
  if (get("scene.projectile-diameter") === 0)
    leaveOut(["scene.drag-coefficient", "scene.air-density", "scene.wind"],
             " unless scene.projectile-diameter is above 0");
  const stepper = get("solver.stepper"), isFixed = fixedSteppers.includes(stepper);
  const others = steppers.filter((name) => fixedSteppers.includes(name) !== isFixed).join(", ");
  const notUsed = (kind, instead) =>
    `: the ${kind} stepper ${stepper} does not use it; give ${instead} or choose one of ${others}`;
  if (isFixed)
    leaveOut(["solver.tolerance", "solver.target-error"], notUsed("fixed-step", "solver.time-step"));
  else
    leaveOut(["solver.time-step"], notUsed("adaptive", "solver.tolerance"));
  if (get("solver.target-error") !== null)
    leaveOut(["solver.tolerance"], " with solver.target-error, which determines it");
  for (const [name, release] of [["release-angle", "crossing"], ["pin-angle", "pin"], ["release-window", "window"]])
    if (get("solver.release") !== release)
      leaveOut([`solver.${name}`], ` unless solver.release is ${release}`);
  return unused;
}

function checkRelease(get) {
  const release = get("solver.release"), stepper = get("solver.stepper");
  if (release === "window" && !fixedSteppers.includes(stepper))
    refuse("solver.release", release,
           `crossing, pin, farthest or fastest for the adaptive stepper ${stepper}, whose steps may skip the window`);
  if (release === "pin" && Number.isNaN(get("solver.pin-angle")))
    throw new InputError("solver.pin-angle", "solver.pin-angle: must be given with solver.release = pin");
}

function checkSection(get) {
  const [given, missing] = ["scene.beam-width", "scene.beam-depth"]
    .sort((a, b) => Number.isNaN(get(a)) - Number.isNaN(get(b)));
  if (Number.isNaN(get(missing)) && !Number.isNaN(get(given)))
    throw new InputError(missing, `${missing}: must be given with ${given}: a section has both`);
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
    refuse(names[2], numberText(moment),
           `at least beam-mass * beam-centre^2 = ${numberText(least)} kg m^2, that of a point mass`);
}

function checkTrough(get) {
  if (get("scene.trough") === "yes" && get("scene.trough-height") >= get("scene.fulcrum-height"))
    refuse("scene.trough-height", numberText(get("scene.trough-height")),
           `below scene.fulcrum-height = ${numberText(get("scene.fulcrum-height"))}`);
}

/** Checks that an elastic sling is not so soft that it starts far below the ground. */
function checkStartStretch(get) {
  const stiffness = get("scene.sling-stiffness"), height = get("scene.fulcrum-height"), most = 10;
  const mass = get("scene.projectile-mass") + get("scene.sling-mass") / 2;
  const load = mass * get("scene.gravity") * Math.max(0, Math.cos(get("scene.sling-angle")));
  const least = load / (most * height);
  if (stiffness > 0 && stiffness < least)
    refuse("scene.sling-stiffness", numberText(stiffness),
           `0 (rigid), or at least ${numberText(1.01 * least, 3)} N/m: at the start, the weight that the sling ` +
           `carries must not stretch it by more than ${most} times scene.fulcrum-height = ${numberText(height)}`);
}

function checkSling(get) {
  const stiffness = get("scene.sling-stiffness"), damping = get("scene.sling-damping");
  if (damping > 0 && stiffness === 0)
    refuse("scene.sling-damping", numberText(damping),
           "0 unless scene.sling-stiffness is above 0: a rigid sling does not stretch");
  const hanger = get("scene.counterweight-hanger") > 0;
  if (stiffness > 0 && (hanger || get("scene.trough") === "yes"))
    refuse("scene.sling-stiffness", numberText(stiffness),
           `0 with ${hanger ? "scene.counterweight-hanger above 0" : "scene.trough = yes"}: the ` +
           `equations of an elastic sling do not include ${hanger ? "a hanger" : "a trough"}`);
  checkStartStretch(get);
}

/** Why a scene does not have a field, as the rest of a message; empty if it has it. */
function whyAbsent(field, get) {
  const isGiven = (name) => !Number.isNaN(get(name));
  if (field === "peak-beam-stress" && isGiven("scene.beam-mass") && !isGiven("scene.beam-section-modulus"))
    return "with scene.beam-mass, unless scene.beam-section-modulus is given: the cross-section of a measured beam " +
      "is not known";
  if (field === "peak-beam-stress" && !isGiven("scene.beam-mass") && !isGiven("scene.beam-width") &&
      get("scene.beam-side") === 0)
    return "if scene.beam-side is 0: the beam then has no cross-section";
  if (field === "lift-off-time" && get("scene.trough") === "no")
    return "unless scene.trough is yes: there is no lift-off without a trough";
  if (field === "peak-hanger-tension" && get("scene.counterweight-hanger") === 0)
    return "unless scene.counterweight-hanger is above 0: there is no hanger";
  return "";
}

const constraintText = ({ field, sign, limit }) => `${field} ${sign} ${numberText(limit)}`;

/** Checks that the scene has every field that the job asks for. */
function checkFields(get) {
  const check = (field, key, text, allowed) => {
    const why = whyAbsent(field, get);
    if (why) refuse(key, text, `${allowed} ${why}`);
  };
  const objective = get("optimum.objective");
  for (const field of get("output.fields")) check(field, "output.fields", field, "left out");
  check(objective, "optimum.objective", objective, "another field");
  for (const constraint of get("optimum.subject-to"))
    check(constraint.field, "optimum.subject-to", constraintText(constraint), "left out");
}

/** Checks that two constraints on the same field are a lower limit and a larger upper limit. */
function checkPair(a, b) {
  const key = "optimum.subject-to", [textOfA, textOfB] = [a, b].map(constraintText);
  if (a.sign === b.sign)
    refuse(key, textOfB, `the only ${a.sign === "<=" ? "upper" : "lower"} limit of ${a.field}; ${textOfA} is another`);
  const [low, high] = a.sign === "<=" ? [b.limit, a.limit] : [a.limit, b.limit];
  if (low >= high)
    refuse(key, `${textOfA}, ${textOfB}`, "a lower limit below the upper limit: " +
           (low === high ? "equal limits leave no room for a search" : "no design satisfies both"));
}

function checkOptimum(get) {
  const constraints = get("optimum.subject-to"), robust = get("optimum.robust");
  constraints.forEach((b, i) => constraints.slice(0, i).filter((a) => a.field === b.field)
    .forEach((a) => checkPair(a, b)));
  if (robust !== "no" && get("optimum.deviation") === 0)
    refuse("optimum.robust", robust, "no unless optimum.deviation is above 0");
}

/** The default of a key; null for an axis without one. */
export function defaultOf(name, core) {
  if (name in otherDefaults) return otherDefaults[name];
  const value = core.defaults[name], names = core.choices[name];
  return names ? names[value] : value ?? null;
}

/** The values that the core needs, as numbers; release by the window of a fixed step becomes crossing. */
function numbersOf(values, unused, core) {
  const numbers = {};
  for (const { name, names } of keys) {
    const value = values[name];
    if (value === undefined || !(name in core.defaults) || unused.has(name) || value === "window") continue;
    numbers[name] = names ? names(core).indexOf(value) : value;
  }
  return numbers;
}

/**
 * A job without the keys that checkedJob refuses, as {job, checked, mistakes}: what checkedJob returns, and the
 * messages. Throws InputError for a key that must stay.
 */
export function mended(job, core, mayLeaveOut = () => true) {
  const kept = { ...job }, mistakes = [];
  for (;;)
    try {
      return { checked: checkedJob(kept, core), job: kept, mistakes };
    } catch (error) {
      if (!(error instanceof InputError) || !mayLeaveOut(error.key)) throw error;
      mistakes.push(error.message);
      if (error.key in kept) delete kept[error.key];
      else Object.keys(kept).forEach((name) => delete kept[name]); // a rule between other keys
    }
}

/** What follows from the values of a single scene's keys. Throws InputError for the first mistake. */
export function checkedValues(values, core) {
  const get = (name) => values[name] ?? defaultOf(name, core);
  const unused = unusedKeys(get);
  const used = (name) => unused.has(name) ? defaultOf(name, core) : get(name);
  const checks = [checkRelease, checkSection, checkBeam, checkTrough, checkSling, checkFields, checkOptimum];
  for (const check of checks) check(used);
  const completed = withTroughAxes(values, get), getCompleted = (name) => completed[name] ?? defaultOf(name, core);
  return { get: getCompleted, unused, box: boxOf(getCompleted), numbers: numbersOf(values, unused, core) };
}

/**
 * The numbers of a job for the core, the box of its design space, and the unused keys.
 * @param core {defaults: numbers by key, choices: names by key, fields}
 * Throws InputError for the first mistake.
 */
export function checkedJob(job, core) {
  const values = {};
  for (const [name, text] of Object.entries(job))
    if (text !== "") values[name] = valueOf(keyByName.get(name), text, core);
  return checkedValues(values, core);
}
