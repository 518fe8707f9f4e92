// The search for the best designs: the maxima of a coarse lattice, refined by a pattern search.

import { axes, clamped } from "./space.js";

/** Lattice points along an axis, maxima that are refined, and limits of the refinement. */
const points = 15, candidates = 6, halvings = 13, rounds = 40;

function flat(designs) {
  return Float64Array.from(designs.flatMap(({ r1, r3, r2 }) => [r1, r3, r2]));
}

/** The designs of a coarse lattice of points^3 over the box, without those outside (null). */
function coarseLattice(box) {
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

/** The designs of a coarse lattice that no neighbour exceeds, best first, each once. */
function coarseMaxima(box, lattice, values) {
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
  return distinct(box, maxima).slice(0, candidates); // an axis with a single value makes copies
}

/** The 27 designs around one, at distances of `step` times the box. */
function around(box, design, step) {
  return offsets.map((offset) => {
    const moved = { ...design };
    axes.forEach((axis, d) => { moved[axis] += offset[d] * step * (box[axis].high - box[axis].low); });
    return clamped(box, moved);
  });
}

/** Maxima without those closer to a better one than a hundredth of the box. */
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
  const length = (axis) =>
    Math.min(Math.max(Number(design[axis].toPrecision(7)), box[axis].low), box[axis].high);
  const r3 = length("r3");
  return { r1: length("r1"), r3, r2: Math.min(length("r2"), Number((box.reach - r3).toPrecision(12))) };
}

/**
 * The maxima with rounded lengths and their values at a tight tolerance. Next to an edge, at which
 * the values jump, both can lead across it: the best of the rounded designs around replaces them.
 */
async function settled(box, maxima, evaluate, tolerance) {
  const distances = Array.from({ length: 7 }, (_, n) => (0.5 / points) * 4 ** -n);
  const trials = maxima.map(({ design }) =>
    [design, ...distances.flatMap((distance) => around(box, design, distance))].map((trial) => rounded(box, trial)));
  const values = await evaluate(flat(trials.flat()), tolerance);
  let next = 0;
  return trials.map((designs) => designs.map((design) => ({ design, value: values[next++] }))
    .reduce((best, trial) => (trial.value > best.value || Number.isNaN(best.value) ? trial : best)))
    .filter(({ value }) => !Number.isNaN(value));
}

/**
 * The local maxima of a field over the box, best first, as {design, value}: rounded designs and their
 * values at `tolerance`. evaluate(designs, tolerance) resolves to the values of a flat array of
 * designs, NaN where there is none.
 */
export async function search(box, evaluate, tolerance) {
  const lattice = coarseLattice(box);
  const inside = lattice.filter((design) => design);
  const found = await evaluate(flat(inside), 1e-5);
  let next = 0;
  let maxima = coarseMaxima(box, lattice, lattice.map((design) => (design ? found[next++] : NaN)));
  let steps = maxima.map(() => 0.5 / points);
  const last = 0.5 / points / 2 ** halvings;
  for (let n = 0; n < rounds && steps.some((step) => step > last); ++n) {
    const trials = maxima.map(({ design }, m) => around(box, design, steps[m]));
    const values = await evaluate(flat(trials.flat()), 1e-7);
    maxima = maxima.map((maximum, m) => {
      let best = { ...maximum, value: values[27 * m + 13] };
      if (Number.isNaN(best.value)) best.value = -Infinity;
      const centre = best;
      trials[m].forEach((design, i) => {
        if (values[27 * m + i] > best.value) best = { design, value: values[27 * m + i] };
      });
      if (best === centre) steps[m] /= 2;
      return best;
    });
  }
  return distinct(box, await settled(box, distinct(box, maxima), evaluate, tolerance));
}
