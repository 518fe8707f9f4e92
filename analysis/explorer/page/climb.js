// Climbing to a local maximum by covariance matrix adaptation (Hansen and Ostermeier, 2001, reduced to
// the rank-mu update): random designs around a mean, whose scatter follows the best of them. Unlike a
// pattern along the axes, it follows ridges and edges in any direction.

import { axes, clamped } from "./space.js";

/** Designs of a generation, those of them that decide, and their weights. */
const size = 40, decisive = 10;
const logs = Array.from({ length: decisive }, (_, i) => Math.log((decisive + 0.5) / (i + 1)));
const weights = logs.map((x) => x / logs.reduce((a, b) => a + b));
/** How fast the scatter changes. */
const rate = 0.25;

const square = (f) => axes.map((_, i) => axes.map((_, j) => f(i, j)));
const weighted = (rows, f) => rows.reduce((sum, row, n) => sum + weights[n] * f(row), 0);

/** A reproducible generator of normally distributed numbers. */
function normalNumbers(seed) {
  let state = seed;
  const uniform = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state + 0.5) / 2 ** 32;
  };
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

/** The lower triangular root of a symmetric matrix. */
function root(matrix) {
  const lower = square(() => 0);
  for (let i = 0; i < axes.length; ++i)
    for (let j = 0; j <= i; ++j) {
      let rest = matrix[i][j];
      for (let k = 0; k < j; ++k) rest -= lower[i][k] * lower[j][k];
      lower[i][j] = i === j ? Math.sqrt(Math.max(rest, 1e-18)) : rest / lower[j][j];
    }
  return lower;
}

export class Climb {
  /** @param best {design, value}, from which it starts, with the given scatter, in fractions of the box */
  constructor(box, best, scatter) {
    Object.assign(this, { box, best, normal: normalNumbers(1), mean: this.#fractions(box, best.design) });
    this.covariance = square((i, j) => (i === j ? scatter ** 2 : 0));
  }

  #fractions(box, design) {
    return axes.map((axis) => {
      const { low, high } = box[axis];
      return high > low ? (design[axis] - low) / (high - low) : 0;
    });
  }

  /** The designs of the next generation. */
  generation() {
    const { box, mean } = this, lower = root(this.covariance);
    this.designs = Array.from({ length: size }, () => {
      const random = axes.map(this.normal);
      return clamped(box, Object.fromEntries(axes.map((axis, i) => {
        const { low, high } = box[axis];
        return [axis, low + (mean[i] + lower[i].reduce((sum, x, j) => sum + x * random[j], 0)) * (high - low)];
      })));
    });
    return this.designs;
  }

  /** Takes the values of the last generation, NaN where there is none. */
  take(values) {
    const trials = this.designs.map((design, i) =>
      ({ design, value: Number.isNaN(values[i]) ? -Infinity : values[i] }));
    const best = [this.best, ...trials].sort((a, b) => b.value - a.value).slice(0, decisive);
    this.best = best[0];
    const points = best.map(({ design }) => this.#fractions(this.box, design));
    const { mean, covariance } = this;
    this.covariance = square((i, j) => (1 - rate) * covariance[i][j] +
      rate * weighted(points, (x) => (x[i] - mean[i]) * (x[j] - mean[j])));
    this.mean = axes.map((_, i) => weighted(points, (x) => x[i]));
  }
}
