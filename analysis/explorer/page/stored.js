// The planes of an archive through its optimum, next to live values of the same designs.

import { limitsOf } from "./colours.js";
import { ignoredKeys, parsed } from "./jobfile.js";
import { drawScale, PlaneView } from "./plane.js";
import { quantityOf, valueText } from "./quantities.js";
import { checkedJob } from "./rules.js";
import { planes } from "./space.js";

const at = (id) => document.getElementById(id);

export class StoredPlanes {
  /**
   * @param archive null, or {name, job, field, design, progress, r1, r3, r2: {first, step, count}, planes: values
   *   by the axis that is constant}
   */
  constructor(archive, core, move) {
    this.views = [];
    if (!archive) return;
    Object.assign(this, archive);
    this.quantity = quantityOf.get(this.field);
    const written = parsed(archive.job), { numbers, box, unused } = checkedJob(written, core);
    // Of a study's scene, the program also writes keys that other scenes use.
    this.job = Object.fromEntries(Object.entries(written).filter(([key]) => !unused.has(key)));
    const solver = ignoredKeys(this.job).filter((text) => text.startsWith("solver.")).join(", ");
    at("stored.solver").textContent =
      solver && `The archive was computed with ${solver}, which the page does not have: its values differ.`;
    at("stored").hidden = false;
    at("stored.title").textContent = `Stored in ${this.name}: ${this.quantity.label}, planes through ` +
      `${Object.entries(this.design).map(([axis, x]) => `${axis} = ${x}`).join(", ")} m` +
      (this.progress && ` (${this.progress})`);
    this.numbers = numbers;
    this.box = { reach: box.reach };
    for (const axis of ["r1", "r3", "r2"]) {
      const { first, step, count } = this[axis];
      this.box[axis] = { low: first - step / 2, high: first + (count - 0.5) * step, step };
    }
    this.views = planes.map((plane, i) => this.#view(plane, i, move));
  }

  #view(plane, i, move) {
    const figure = document.createElement("figure");
    figure.innerHTML = `<canvas id="stored.${i}" tabindex="0" role="application" ` +
      `aria-roledescription="heat map"></canvas><figcaption>stored, ${plane.across} = ` +
      `${this.design[plane.across]} m</figcaption>`;
    at("stored.planes").append(figure);
    const view = new PlaneView(figure.firstChild, plane, move);
    const values = this.planes[plane.across];
    view.take({
      field: this.field, values, statuses: Uint8Array.from(values, (_, cell) => Number(this.#isDesign(plane, cell))),
      columns: this[plane.u].count, rows: this[plane.v].count, u: this.box[plane.u], v: this.box[plane.v],
    });
    return view;
  }

  /** The design of a cell of a plane. */
  #point(plane, cell) {
    const { count } = this[plane.u];
    const length = (axis, i) => Number((this[axis].first + i * this[axis].step).toPrecision(12));
    return { [plane.across]: this.design[plane.across], [plane.u]: length(plane.u, cell % count),
             [plane.v]: length(plane.v, Math.floor(cell / count)) };
  }

  #isDesign(plane, cell) {
    const { r2, r3 } = this.#point(plane, cell);
    return r2 + r3 < this.box.reach - 1e-9;
  }

  /** Values for the limits of a colour scale. */
  values(field) {
    return field === this.field ? this.views.map((view) => view.data.values) : [];
  }

  /**
   * Draws the planes, with limits of their own if the page shows another field; asks for live values
   * of the stored designs nearest to the crosshairs.
   */
  draw({ design, field, limits, pool }) {
    if (!this.views.length) return;
    this.nearest = this.views.map((view) => this.#nearest(view, design));
    const isShared = field === this.field;
    const scale = isShared ? limits : limitsOf(this.values(this.field));
    at("stored.scale").hidden = isShared;
    if (!isShared) drawScale(at("stored.scale"), scale, this.quantity);
    this.views.forEach((view) => view.draw({
      box: this.box, design: { ...design, [view.plane.across]: this.design[view.plane.across] }, field: this.field,
      limits: scale, optimum: this.design, pinned: null }));
    const designs = this.nearest.flatMap(({ point }) => [point.r1, point.r3, point.r2]);
    pool.sendOther("values", { numbers: this.numbers, field: this.field, designs });
  }

  /** The stored design of a plane that is nearest to the crosshair, and its value. */
  #nearest({ plane, data }, design) {
    const index = (axis) => {
      const { first, step, count } = this[axis];
      return Math.min(Math.max(Math.round((design[axis] - first) / step), 0), count - 1);
    };
    const cell = index(plane.v) * data.columns + index(plane.u);
    return { point: this.#point(plane, cell), value: data.values[cell], isDesign: this.#isDesign(plane, cell) };
  }

  /** Shows stored values with live ones. */
  takeLive(live) {
    const text = (value) => `${valueText(this.quantity, value, 7)} ${this.quantity.unit}`; // 32-bit floats
    const row = (tag, cells) => `<tr>${cells.map((cell) => `<${tag}>${cell}</${tag}>`).join("")}</tr>`;
    at("stored.values").innerHTML = row("th", ["design (m)", "stored", "computed here, archive's scene"]) +
      this.nearest.map(({ point, value, isDesign }, i) =>
        row("td", [`r1 = ${point.r1}, r3 = ${point.r3}, r2 = ${point.r2}`,
                   isDesign ? text(value) : "outside the lattice", text(live[i])])).join("");
  }
}
