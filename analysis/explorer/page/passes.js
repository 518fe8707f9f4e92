// The pictures of a plane: coarse first, then finer ones.

import { planeDesigns, windowOf } from "./space.js";
import { ranks } from "./workers.js";

/** Cells along an axis, and the tolerance of all pictures except the last. */
const sizes = [8, 25, 50, 100], coarseTolerance = 1e-5;
/** A picture is left out if a finer one takes less than the first time, ms; after another one, the second time. */
const patience = 50, laterPatience = 500;
/**
 * The limits of the steps of a swing, after which its status is step_budget. Where most swings need
 * few, those that do not, such as beams that stick and slip, are left to the end.
 */
const limits = [500, 2000, 8000, 20000];

/**
 * Integrates designs with the least limit within which nine of ten end. Returns what Workers.integrate() does,
 * and the limit, `steps`.
 */
export async function integratedMostly(designs, integrate, isUnfinished) {
  for (const steps of limits) {
    const found = await integrate(designs, coarseTolerance, steps);
    const isUsual = found.statuses.filter(isUnfinished).length <= 0.1 * found.statuses.length;
    if (isUsual || steps === limits.at(-1)) return { ...found, steps };
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

  /** Takes the results of some of the designs, given by their numbers. */
  take(found, numbers = this.cells.keys()) {
    this.milliseconds += found.milliseconds;
    let i = 0;
    for (const n of numbers) {
      this.values[this.cells[n]] = found.values[i];
      this.statuses[this.cells[n]] = found.statuses[i++];
    }
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
 * integrate(designs, tolerance, steps, rank) is Workers.integrate(); isUnfinished(status): whether it is step_budget.
 */
export async function drawPasses(request, integrate, isUnfinished, show) {
  const last = sizes.length - 1;
  let picture = new Picture(request, sizes[0]);
  const first = await integratedMostly(picture.designs, integrate, isUnfinished), { steps } = first;
  picture.take(first);
  let isShown = false;
  for (let i = 0; i < last;) {
    const cost = picture.milliseconds / sizes[i] ** 2;
    const isQuick = (n) => n ** 2 * cost < (isShown ? laterPatience : patience);
    if (!isQuick(sizes[i + 1])) {
      show(picture.answer, false);
      isShown = true;
    }
    i = Math.max(i + 1, sizes.findLastIndex(isQuick));
    picture = new Picture(request, sizes[i]);
    const settings = i === last ? [request.tolerance, steps, ranks.finest]
      : [coarseTolerance, steps, ranks.plane + i / sizes.length];
    picture.take(await integrate(picture.designs, ...settings));
  }
  const rest = [...picture.cells.keys()].filter((n) => isUnfinished(picture.statuses[picture.cells[n]]));
  if (steps < limits.at(-1) && rest.length > 0) {
    show(picture.answer, false);
    const designs = Float64Array.from(rest.flatMap((n) => [...picture.designs.subarray(3 * n, 3 * n + 3)]));
    picture.take(await integrate(designs, request.tolerance, limits.at(-1), ranks.late), rest);
  }
  show(picture.answer, true);
}
