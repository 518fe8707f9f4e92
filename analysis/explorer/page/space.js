// The design space of a job: the bounds (47)-(49) of its lattice, as in src/job/lattice.cpp, and the
// planes through a design.

import { InputError } from "./input_error.js";
import { numberText } from "./numbers.js";

export const axes = ["r1", "r3", "r2"];
export const axisNames =
  { r1: "counterweight's arm r1", r3: "sling r3", r2: "throwing arm r2" };

/** The planes, by the axis that is constant in them: horizontal and vertical axis. */
export const planes = [
  { across: "r1", u: "r2", v: "r3" },
  { across: "r3", u: "r2", v: "r1" },
  { across: "r2", u: "r3", v: "r1" },
];

function refuseEmpty(key, value, why) {
  throw new InputError(key, `${key} = ${numberText(value)} leaves no design: ${why}`);
}

/** In steps: distances from a bound that are at most this long are due to rounding. */
const roundingAllowance = 1e-6;

const six = (x) => numberText(x, 6);

/** How many of the values first, first + step, ... are strictly below `high`. */
const countBelow = (high, first, step) => Math.max(0, Math.ceil((high - first) / step - roundingAllowance));

/** An axis between strict bounds: low + step, low + 2 step, ... */
function openInterval(low, high, step) {
  return { low, high, step, first: low + step, count: Math.max(0, countBelow(high, low, step) - 1) };
}

/** An axis that includes its ends. */
function closedInterval({ first, last, step }) {
  return { low: first, high: last, step, first, count: Math.floor((last - first) / step + roundingAllowance) + 1 };
}

/** The axis r1 within the bounds (47). */
function armAxis(get) {
  const h0 = get("scene.fulcrum-height"), r4 = get("scene.counterweight-hanger");
  const isStartGiven = ["scene.start-angle", "scene.start-tip-height"].some((name) => !Number.isNaN(get(name)));
  const rise = isStartGiven ? 0 : Math.max(0, get("scene.release-height") - h0 + r4);
  const high = h0 - r4, step = get("lattice.increment");
  const axis = openInterval(rise, high, step);
  if (axis.count > 0) return axis;
  const isHung = r4 > 0;
  const low = rise > 0 ? `${isHung ? "h - h0 + r4" : "h - h0"} = ${six(rise)}` : "0";
  const allowed = `r1 must be longer than ${low} m and shorter than ${isHung ? "h0 - r4" : "h0"} = ` +
    `${six(high)} m (47), in steps of ${numberText(step)} m`;
  if (high <= 0)
    refuseEmpty("scene.counterweight-hanger", r4, `${allowed}; choose a shorter hanger or give lattice.r1`);
  if (rise >= high)
    refuseEmpty("scene.release-height", get("scene.release-height"),
                `${allowed}; choose a height below ${six(2 * high)} m or give lattice.r1`);
  return refuseEmpty("lattice.increment", step, `${allowed}; choose a smaller step or give lattice.r1`);
}

/** The axis r3 within the bounds (48). */
function slingAxis(get) {
  const h0 = get("scene.fulcrum-height"), shortest = get("lattice.shortest-sling"), step = get("lattice.increment");
  const count = countBelow(h0, shortest, step);
  if (count === 0) refuseEmpty("lattice.shortest-sling", shortest, `r3 must be shorter than h0 = ${six(h0)} m (48)`);
  return { low: shortest, high: h0, step, first: shortest, count };
}

/** The axis r2 within the bounds (49) for the shortest sling. */
function throwingAxis(get, shortest) {
  const longest = get("scene.fulcrum-height") - shortest, step = get("lattice.increment");
  const axis = openInterval(0, longest, step);
  if (axis.count === 0)
    refuseEmpty(get("lattice.r3") ? "lattice.r3" : "lattice.shortest-sling", shortest,
                `r2 must be shorter than h0 - r3 = ${six(longest)} m (49), in steps of ${numberText(step)} m; ` +
                "choose shorter slings or give lattice.r2");
  return axis;
}

const maxCells = 1e12, maxCount = 1e7;

/** Refuses a lattice that is too large for the program. */
function checkSize(box, get) {
  const refuseStep = (axis, why) => {
    const isOwn = get(`lattice.${axis}`) && box[axis].step !== get("lattice.increment");
    const key = isOwn ? `lattice.${axis}` : "lattice.increment";
    throw new InputError(key, `${key}${isOwn ? " with a step" : ""} = ${numberText(box[axis].step)}${why}`);
  };
  for (const axis of axes) {
    const { first, step, count } = box[axis], last = first + (count - 1) * step;
    if (count > 1 && step < 1e-12 * last)
      refuseStep(axis, `: must be at least 1e-12 of the largest ${axis}, ${numberText(last)} m, for distinct values`);
  }
  const counts = axes.map((axis) => box[axis].count), cells = counts.reduce((a, b) => a * b);
  const largest = Math.max(...counts);
  if (largest <= maxCount && cells <= maxCells) return;
  const three = (x) => numberText(x, 3);
  refuseStep(axes[counts.indexOf(largest)],
             ` would make a lattice of ${counts.map(three).join(" x ")} (r1 x r3 x r2), ${three(cells)} cells; ` +
             `at most ${three(maxCells)} cells and ${three(maxCount)} along an axis are allowed`);
}

/**
 * The box of the designs: for each axis its bounds {low, high}, the values of its lattice {first, step, count}
 * and the number of the equation of its bounds, `rule`, unless they are explicit; and `reach`, the bound of
 * r2 + r3 (49), infinite where r2 is explicit. Throws InputError if it is empty.
 */
export function boxOf(get) {
  const box = { reach: Infinity };
  const explicit = (axis) => {
    const given = get(`lattice.${axis}`);
    return given ? closedInterval({ ...given, step: given.step || get("lattice.increment") }) : null;
  };
  box.r1 = explicit("r1") ?? { ...armAxis(get), rule: " (47)" };
  box.r3 = explicit("r3") ?? { ...slingAxis(get), rule: " (48)" };
  box.r2 = explicit("r2");
  if (!box.r2) {
    box.r2 = { ...throwingAxis(get, box.r3.low), rule: " (49)" };
    box.reach = get("scene.fulcrum-height");
  }
  checkSize(box, get);
  return box;
}

/** The whole number of steps nearest to a length, at least one, m. */
const wholeSteps = (length, step) => Number((Math.max(1, Math.round(length / step)) * step).toPrecision(15));

/** A thirtieth of the fulcrum's height, rounded up to one digit. */
function coarseIncrement(h0) {
  const least = h0 / 30, digit = 10 ** Math.floor(Math.log10(least));
  return wholeSteps(Math.ceil(least / digit - roundingAllowance) * digit, digit);
}

/** The values of a job with those of r3, r2 and the increment that a trough has by default. */
export function withTroughAxes(values, get) {
  if (get("scene.trough") !== "yes" || (values["lattice.r3"] && values["lattice.r2"])) return values;
  const h0 = get("scene.fulcrum-height"), step = values["lattice.increment"] ?? coarseIncrement(h0);
  const axis = { first: wholeSteps(0.4 * h0, step), last: wholeSteps(2.2 * h0, step), step };
  return { "lattice.r3": axis, "lattice.r2": axis, "lattice.increment": step, ...values };
}

/** The range of an axis that a plane shows: its bounds, or the surroundings of a single value. */
export function windowOf({ low, high }) {
  return high > low ? { low, high } : { low: 0.75 * low, high: 1.25 * low };
}

/** Why a design is outside the lattice, "" if it is inside; lengths that are equal to a bound are inside. */
export function outsideText(box, design) {
  const reasons = axes
    .filter((axis) => design[axis] < box[axis].low - 1e-9 || design[axis] > box[axis].high + 1e-9)
    .map((axis) => {
      const { low, high, rule = "" } = box[axis];
      return `${axis} must be from ${six(low)} to ${six(high)} m${rule}`;
    });
  if (design.r2 + design.r3 > box.reach * (1 + 1e-9)) reasons.push(`r2 + r3 below ${six(box.reach)} m (49)`);
  return reasons.join(", ");
}

/** The bounds that a design lies on, "" if none: better designs may be beyond them. */
export function edgeText(box, design) {
  const isAt = (x, bound) => Number.isFinite(bound) && Math.abs(x - bound) <= 1e-5 * bound;
  const edges = axes.flatMap((axis) => {
    const { low, high, rule = "" } = box[axis];
    const bounds = low < high ? [low, high].filter((bound) => isAt(design[axis], bound)) : [];
    return bounds.map((bound) => `${axis} = ${six(bound)} m${rule}`);
  });
  if (isAt(design.r2 + design.r3, box.reach)) edges.push(`r2 + r3 = ${six(box.reach)} m (49)`);
  return edges.join(", ");
}

export function isInside(box, design) {
  return outsideText(box, design) === "";
}

/** The nearest design within the bounds. */
export function clamped(box, design) {
  const nearest = {};
  for (const axis of axes)
    nearest[axis] = Math.min(Math.max(design[axis], box[axis].low), box[axis].high);
  const excess = nearest.r2 + nearest.r3 - box.reach;
  if (excess > 0) {
    const r3 = Math.max(box.r3.low, nearest.r3 - excess / 2);
    nearest.r2 = Math.max(box.r2.low, box.reach - r3);
    nearest.r3 = r3;
  }
  return nearest;
}

/**
 * The designs at the centres of n x n cells of a plane, v slowest, as a flat array of r1, r3, r2,
 * and the cells that they belong to; cells outside the lattice have no design.
 */
export function planeDesigns(box, plane, at, n) {
  const u = windowOf(box[plane.u]), v = windowOf(box[plane.v]);
  const designs = [], cells = [];
  const centre = ({ low, high }, i) => low + ((i + 0.5) / n) * (high - low);
  for (let j = 0; j < n; ++j)
    for (let i = 0; i < n; ++i) {
      const design = { [plane.across]: at, [plane.u]: centre(u, i), [plane.v]: centre(v, j) };
      if (design.r2 + design.r3 > box.reach * (1 + 1e-9)) continue;
      designs.push(design.r1, design.r3, design.r2);
      cells.push(j * n + i);
    }
  return { designs: Float64Array.from(designs), cells };
}

/** How many cells around a maximum, in each direction, are lower: fewer find the steps of edges. */
const maximumReach = 5;

/** Indices of the cells of a picture that exceed all cells around them that have a value. */
export function localMaxima({ values, columns, rows }) {
  const isHighest = (cell) => {
    const i = cell % columns, j = Math.floor(cell / columns);
    const last = Math.min(i + maximumReach, columns - 1), top = Math.min(j + maximumReach, rows - 1);
    for (let y = Math.max(j - maximumReach, 0); y <= top; ++y)
      for (let x = Math.max(i - maximumReach, 0); x <= last; ++x) {
        const other = y * columns + x;
        if (other !== cell && values[other] >= values[cell]) return false;
      }
    return true;
  };
  return Array.from(values.keys()).filter((cell) => !Number.isNaN(values[cell]) && isHighest(cell));
}

/**
 * A design after the user has moved some lengths: rounded to tenths of a step, within the bounds.
 */
export function moved(box, design, part) {
  const next = { ...design };
  for (const [axis, x] of Object.entries(part)) {
    const { low, high, step } = { ...windowOf(box[axis]), step: box[axis].step };
    const quantum = step / 10;
    const rounded = Number((Math.round(x / quantum) * quantum).toPrecision(12));
    next[axis] = Math.min(Math.max(rounded, low || quantum), high);
  }
  const excess = next.r2 + next.r3 - box.reach;
  if (excess <= 0) return next;
  const axis = "r2" in part ? "r2" : "r3";
  const shortened = next[axis] - excess;
  const isOutside = shortened <= 0 || shortened < box[axis].low - 1e-9;
  if (isOutside || ("r2" in part && "r3" in part)) {
    const { r3, r2 } = clamped(box, next);
    return { ...next, r3: Number(r3.toPrecision(12)), r2: Number(r2.toPrecision(12)) };
  }
  return { ...next, [axis]: Number(shortened.toPrecision(12)) };
}
