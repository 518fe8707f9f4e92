// The pictures of a plane: coarse first, then finer ones.

import { planeDesigns, windowOf } from "./space.js";

/** Cells along an axis, and the tolerance of all pictures except the last. */
const sizes = [8, 25, 50, 100], coarseTolerance = 1e-5;
/** A picture is left out if the next one takes less than this time, ms. */
const patience = 50;
/**
 * The limits of the steps of a swing, after which its status is step_budget. Where most swings need
 * few, those that do not, such as beams that stick and slip, are left to the end.
 */
const limits = [500, 2000, 8000, 20000];

/** The least limit within which nine of ten designs end, as `steps`, and the time per design, ms, as `cost`. */
export async function usualLimit(designs, integrate, isUnfinished) {
  for (const steps of limits) {
    const { statuses, milliseconds } = await integrate(designs, coarseTolerance, steps);
    const isUsual = statuses.filter(isUnfinished).length <= 0.1 * statuses.length;
    if (isUsual || steps === limits.at(-1)) return { steps, cost: milliseconds / statuses.length };
  }
}

/** A picture of n x n cells of a plane: its designs, and their results as they become known. */
class Picture {
  constructor({ box, plane, at, field }, n) {
    const { designs, cells } = planeDesigns(box, plane, at, n);
    Object.assign(this, { designs, cells, milliseconds: 0, field, columns: n, rows: n,
                          u: windowOf(box[plane.u]), v: windowOf(box[plane.v]),
                          values: new Float64Array(n * n).fill(NaN), statuses: new Uint8Array(n * n) });
  }

  /** Integrates some of the designs, given by their numbers. */
  async integrate(numbers, integrate, ...settings) {
    const designs = new Float64Array(3 * numbers.length);
    numbers.forEach((n, i) => designs.set(this.designs.subarray(3 * n, 3 * n + 3), 3 * i));
    const found = await integrate(designs, ...settings);
    this.milliseconds += found.milliseconds;
    numbers.forEach((n, i) => {
      this.values[this.cells[n]] = found.values[i];
      this.statuses[this.cells[n]] = found.statuses[i];
    });
  }

  /** What the page shows, which does not change later. */
  get answer() {
    const { field, columns, rows, u, v, milliseconds } = this;
    const picture = { field, columns, rows, u, v, values: this.values.slice(), statuses: this.statuses.slice() };
    return { picture, designs: this.cells.length, milliseconds };
  }
}

/**
 * Computes the pictures of a plane, and calls show({picture, designs, milliseconds}, isLast) with each.
 * integrate(designs, tolerance, steps, rank) is Workers.integrate(); isUnfinished(status): whether it is step_budget;
 * `late` is the rank of what few cells need.
 */
export async function drawPasses(request, integrate, isUnfinished, late, show) {
  const sample = new Picture(request, sizes[0]);
  let { steps, cost } = await usualLimit(sample.designs, integrate, isUnfinished);
  for (const [i, n] of sizes.slice(0, -1).entries()) {
    if (sizes[i + 1] ** 2 * cost < patience) continue;
    const picture = new Picture(request, n);
    await picture.integrate([...picture.cells.keys()], integrate, coarseTolerance, steps);
    cost = picture.milliseconds / n ** 2;
    show(picture.answer, false);
  }
  const last = new Picture(request, sizes.at(-1));
  await last.integrate([...last.cells.keys()], integrate, request.tolerance, steps);
  const rest = [...last.cells.keys()].filter((n) => isUnfinished(last.statuses[last.cells[n]]));
  if (steps < limits.at(-1) && rest.length > 0) {
    show(last.answer, false);
    await last.integrate(rest, integrate, request.tolerance, limits.at(-1), late);
  }
  show(last.answer, true);
}
