// The search for the best designs: climbs from the maxima of a coarse lattice.

import { Climb } from "./climb.js";
import { integratedMostly } from "./passes.js";
import { axes, clamped } from "./space.js";
import { ranks } from "./workers.js";

/** The time of the lattice, ms of one worker, and how many points it has along an axis. */
const latticeTime = 1000, fewestPoints = 15, mostPoints = 30;
const latticeTolerance = 1e-5, climbTolerance = 1e-7;
/** How many climbs there are from each generation on; the worst ones end. */
const climbers = [[0, 20], [10, 10], [20, 5]], generations = 50, shownEvery = 5;
/** Relative: a rounded design whose value differs by less is as good. */
const sameValue = 1e-7;

function flat(designs) {
  return Float64Array.from(designs.flatMap(({ r1, r3, r2 }) => [r1, r3, r2]));
}

/** A box without slings that are too long for any throwing arm, which explicit axes may contain. */
function withUsableSlings(box) {
  return { ...box, r3: { ...box.r3, high: Math.min(box.r3.high, box.reach - box.r2.low) } };
}

/** The designs at the centres of points^3 cells of the box, without those outside (null). */
function latticeOf(box, points) {
  const value = (axis, i) => {
    const { low, high } = box[axis];
    return low + ((i + 0.5) / points) * (high - low);
  };
  const lattice = [];
  for (let i = 0; i < points; ++i)
    for (let j = 0; j < points; ++j)
      for (let k = 0; k < points; ++k) {
        const design = { r1: value("r1", i), r3: value("r3", j), r2: value("r2", k) };
        lattice.push(design.r2 + design.r3 < box.reach ? design : null);
      }
  return lattice;
}

const offsets = [-1, 0, 1].flatMap((i) => [-1, 0, 1].flatMap((j) => [-1, 0, 1].map((k) => [i, j, k])));

/** The designs of a lattice that no neighbour exceeds, best first, each once. */
function latticeMaxima(box, points, lattice, values) {
  const worth = (i, j, k) => {
    const isInside = [i, j, k].every((x) => x >= 0 && x < points);
    const value = isInside ? values[(i * points + j) * points + k] : NaN;
    return Number.isNaN(value) ? -Infinity : value;
  };
  const maxima = [];
  lattice.forEach((design, n) => {
    const k = n % points, j = Math.floor(n / points) % points, i = Math.floor(n / points ** 2);
    const value = worth(i, j, k);
    if (value > -Infinity && offsets.every(([a, b, c]) => worth(i + a, j + b, k + c) <= value))
      maxima.push({ design, value });
  });
  return distinct(box, maxima); // an axis with a single value makes copies
}

/** Maxima, best first, without those closer to a better one than a hundredth of the box. */
function distinct(box, maxima) {
  const near = (a, b) => axes.every((axis) =>
    Math.abs(a.design[axis] - b.design[axis]) <= 0.01 * (box[axis].high - box[axis].low));
  const kept = [];
  for (const maximum of maxima.sort((a, b) => b.value - a.value))
    if (!kept.some((other) => near(other, maximum))) kept.push(maximum);
  return kept;
}

/** A design with lengths of seven digits, which people can read, within the bounds. */
function rounded(box, design) {
  const length = (axis) => Number(
    Math.min(Math.max(Number(design[axis].toPrecision(7)), box[axis].low), box[axis].high).toPrecision(12));
  const r3 = length("r3");
  return { r1: length("r1"), r3, r2: Math.min(length("r2"), Number((box.reach - r3).toPrecision(12))) };
}

/** Rounded designs around one, at distances from 1e-6 of the box. */
function around(box, design) {
  return Array.from({ length: 7 }, (_, n) => 0.03 * 4 ** -n).flatMap((step) => offsets.map((offset) => {
    const moved = { ...design };
    axes.forEach((axis, d) => { moved[axis] += offset[d] * step * (box[axis].high - box[axis].low); });
    return rounded(box, clamped(box, moved));
  }));
}

/**
 * The maxima with rounded lengths and their values at a tight tolerance. Next to an edge, at which
 * the values jump, both can lead across it: the best of the rounded designs around replaces them.
 */
async function settled(box, maxima, integrate) {
  const evaluated = async (designs) => {
    const { values } = await integrate(flat(designs));
    return designs.map((design, i) => ({ design, value: values[i] }));
  };
  const rounds = await evaluated(maxima.map(({ design }) => rounded(box, design)));
  const holds = ({ value }, i) => value >= maxima[i].value - sameValue * Math.abs(maxima[i].value);
  const settling = await Promise.all(rounds.map(async (round, i) => (holds(round, i) ? round
    : [round, ...await evaluated(around(box, maxima[i].design))].reduce((best, trial) =>
      (trial.value > best.value || Number.isNaN(best.value) ? trial : best)))));
  return distinct(box, settling.filter(({ value }) => !Number.isNaN(value)));
}

/**
 * Searches the bounds for the local maxima of a field, and calls show({maxima, progress}, isLast) with those
 * known so far, best first, as {design, value}; at last, rounded designs and their values at the
 * tolerance of traces. See passes.js for `integrateRanked`, whose defaults are those of traces, and isUnfinished.
 */
export async function search(bounds, integrateRanked, isUnfinished, show) {
  const box = withUsableSlings(bounds);
  // In slow scenes, a search costs less than the finest pictures of the planes.
  let rank = ranks.slowSearch;
  const integrate = (designs, tolerance, steps) => integrateRanked(designs, tolerance, steps, rank);
  const inside = (designs) => designs.filter((design) => design);
  const sample = inside(latticeOf(box, 5));
  const { steps, milliseconds } = await integratedMostly(flat(sample), integrate, isUnfinished);
  const affordable = Math.floor(Math.cbrt(latticeTime * sample.length / milliseconds));
  const points = Math.min(Math.max(affordable, fewestPoints), mostPoints);
  if (points > fewestPoints) rank = ranks.search;
  const lattice = latticeOf(box, points);
  const { values } = await integrate(flat(inside(lattice)), latticeTolerance, steps);
  let next = 0;
  const maxima = latticeMaxima(box, points, lattice, lattice.map((design) => (design ? values[next++] : NaN)));
  let climbs = maxima.slice(0, climbers[0][1]).map((maximum) => new Climb(box, maximum, 0.5 / points));
  const found = () => distinct(box, climbs.map(({ best }) => best));
  for (let n = 0; n < generations; ++n) {
    const count = climbers.findLast(([first]) => n >= first)[1];
    climbs = climbs.sort((a, b) => b.best.value - a.best.value).slice(0, count);
    if (n % shownEvery === 0) show({ maxima: found(), progress: n / generations }, false);
    const designs = climbs.map((climb) => climb.generation());
    const trials = await integrate(flat(designs.flat()), climbTolerance, steps);
    let first = 0;
    climbs.forEach((climb, i) => climb.take(trials.values.subarray(first, first += designs[i].length)));
  }
  show({ maxima: await settled(box, found(), integrate), progress: 1 }, true);
}
