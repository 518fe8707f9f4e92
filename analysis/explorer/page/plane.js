// A heat map through the design: drawing, and moving the crosshair by mouse, touch and keys.

import { line, prepared, star, theme } from "./canvas.js";
import { colourOf, statusColour, ticks } from "./colours.js";
import { titleOf, valueText } from "./quantities.js";
import { axisNames, localMaxima, windowOf } from "./space.js";
import { hasSlid } from "./touch.js";

const margin = { right: 14, top: 8, bottom: 38 };
/** Widths left of a plane, pixels: of the title of its axis, and of the marks with the gaps next to the numbers. */
const titleWidth = 18, markWidth = 9;

export class PlaneView {
  /** @param move called with a function of the design that returns the user's part, as {r1, r2} */
  constructor(canvas, plane, move) {
    Object.assign(this, { canvas, plane, move, data: null, drag: null });
    this.image = document.createElement("canvas");
    canvas.addEventListener("pointerdown", (event) => this.#start(event));
    canvas.addEventListener("pointermove", (event) => this.#follow(event));
    canvas.addEventListener("pointerup", (event) => this.#end(event));
    canvas.addEventListener("pointercancel", () => { this.drag = null; });
    canvas.addEventListener("keydown", (event) => this.#press(event));
  }

  /**
   * Takes a picture of columns x rows cells, v slowest: their values and statuses, the field, and
   * the ranges u and v of the axes. Null: no picture.
   */
  take(data) {
    this.data = data;
    this.painted = null;
    this.maxima = !data || data.field === "status" ? [] : localMaxima(data);
  }

  /** The cell with the largest value of a field, as {design, value}, in the plane through a design; or null. */
  highest(field, design) {
    if (this.data?.field !== field) return null;
    const { values, columns, rows, u, v } = this.data;
    let best = -1;
    values.forEach((value, cell) => {
      if (value > (values[best] ?? -Infinity)) best = cell;
    });
    if (best < 0) return null;
    const length = ({ low, high }, part) => Number((low + part * (high - low)).toPrecision(12));
    const part = {
      [this.plane.u]: length(u, ((best % columns) + 0.5) / columns),
      [this.plane.v]: length(v, (Math.floor(best / columns) + 0.5) / rows),
    };
    return { design: { ...design, ...part }, value: values[best] };
  }

  /** `view` is the page's state: box, design, field, limits, optimum and pinned design. */
  draw(view) {
    this.view = view;
    const { context, width, height } = prepared(this.canvas);
    const colours = theme();
    const { frame, rowTicks } = this.#layout(context, width, height);
    Object.assign(this, { frame, rowTicks });
    const { left, top, width: w, height: h } = this.frame;
    this.#hatch(context, colours);
    if (this.data?.field === view.field) this.#paint(context, view);
    line(context, [[left, top], [left + w, top], [left + w, top + h], [left, top + h], [left, top]],
         { colour: colours.line });
    this.#axes(context, colours);
    this.#limits(context, colours);
    this.#markers(context, view);
    this.canvas.setAttribute("aria-label", this.#description(view));
  }

  /** The frame of the picture, next to the numbers of its vertical axis. */
  #layout(context, width, height) {
    const { low, high } = this.#window(this.plane.v);
    const inner = height - margin.top - margin.bottom;
    const rowTicks = ticks(low, high, inner / 45);
    const numbers = Math.max(0, ...rowTicks.map((tick) => context.measureText(tick).width));
    const left = titleWidth + numbers + markWidth;
    return { frame: { left, top: margin.top, width: width - left - margin.right, height: inner }, rowTicks };
  }

  #window(axis) {
    return windowOf(this.view.box[axis]);
  }
  #x(u) {
    const { low, high } = this.#window(this.plane.u);
    return this.frame.left + ((u - low) / (high - low)) * this.frame.width;
  }
  #y(v) {
    const { low, high } = this.#window(this.plane.v);
    return this.frame.top + (1 - (v - low) / (high - low)) * this.frame.height;
  }

  /** The ground of cells without a design. */
  #hatch(context, colours) {
    const { left, top, width, height } = this.frame;
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    for (let x = -height; x < width; x += 9)
      line(context, [[left + x, top + height], [left + x + height, top]], { colour: colours.faint });
    context.restore();
  }

  #paint(context, { limits }) {
    const { columns, rows, u, v, values, statuses, field } = this.data;
    const key = `${limits}`;
    if (this.painted !== key) {
      this.image.width = columns;
      this.image.height = rows;
      const pixels = new ImageData(columns, rows);
      for (let cell = 0; cell < values.length; ++cell) {
        if (statuses[cell] === 0) continue;
        const [r, g, b] = field === "status" ? statusColour(statuses[cell])
          : colourOf(values[cell], limits);
        const row = rows - 1 - Math.floor(cell / columns);
        pixels.data.set([r, g, b, 255], 4 * (row * columns + (cell % columns)));
      }
      this.image.getContext("2d").putImageData(pixels, 0, 0);
      this.painted = key;
    }
    // The ranges may be those of an older box, until the worker has computed the new one.
    const { left, top, width, height } = this.frame;
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    context.imageSmoothingEnabled = false;
    const x = this.#x(u.low), y = this.#y(v.high);
    context.drawImage(this.image, x, y, this.#x(u.high) - x, this.#y(v.low) - y);
    context.restore();
  }

  #axes(context, colours) {
    const { left, top, width, height } = this.frame;
    const { plane } = this;
    const u = this.#window(plane.u);
    context.fillStyle = colours.text;
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const tick of ticks(u.low, u.high, width / 60)) {
      line(context, [[this.#x(tick), top + height], [this.#x(tick), top + height + 4]],
           { colour: colours.line });
      context.fillText(String(tick), this.#x(tick), top + height + 5);
    }
    context.fillText(axisTitle(context, plane.u, width), left + width / 2, top + height + 21);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const tick of this.rowTicks) {
      line(context, [[left - 4, this.#y(tick)], [left, this.#y(tick)]], { colour: colours.line });
      context.fillText(String(tick), left - 6, this.#y(tick));
    }
    context.save();
    context.translate(titleWidth / 2, top + height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(axisTitle(context, plane.v, height), 0, 0);
    context.restore();
  }

  /** The bound r2 + r3 < h0 (49), and the single values of axes. */
  #limits(context, colours) {
    const { box, design } = this.view;
    const { u, v } = this.plane;
    const uWindow = this.#window(u), vWindow = this.#window(v);
    context.save();
    context.beginPath();
    context.rect(this.frame.left, this.frame.top, this.frame.width, this.frame.height);
    context.clip();
    const limit = (points) => {
      line(context, points, { colour: colours.panel, width: 3 });
      line(context, points, { colour: colours.text, width: 1.5 });
    };
    if (Number.isFinite(box.reach)) {
      const points = this.plane.across === "r1"
        ? [uWindow.low, uWindow.high].map((x) => [this.#x(x), this.#y(box.reach - x)])
        : [vWindow.low, vWindow.high].map((y) =>
          [this.#x(box.reach - design[this.plane.across]), this.#y(y)]);
      limit(points);
    }
    if (box[u].low === box[u].high)
      limit([vWindow.low, vWindow.high].map((y) => [this.#x(box[u].low), this.#y(y)]));
    if (box[v].low === box[v].high)
      limit([uWindow.low, uWindow.high].map((x) => [this.#x(x), this.#y(box[v].low)]));
    context.restore();
  }

  #markers(context, { box, design, optimum, pinned, field }) {
    const { u, v, across } = this.plane;
    const { left, top, width, height } = this.frame;
    context.save();
    context.beginPath();
    context.rect(left - 1, top - 1, width + 2, height + 2);
    context.clip();
    if (this.data?.field === field)
      for (const cell of this.maxima) {
        const { columns, rows, u: across, v: up } = this.data;
        const part = [((cell % columns) + 0.5) / columns, (Math.floor(cell / columns) + 0.5) / rows];
        const x = this.#x(across.low + part[0] * (across.high - across.low));
        const y = this.#y(up.low + part[1] * (up.high - up.low));
        for (const [colour, w] of [["#000000", 3], ["#ffffff", 1.5]]) {
          line(context, [[x - 4, y], [x + 4, y]], { colour, width: w });
          line(context, [[x, y - 4], [x, y + 4]], { colour, width: w });
        }
      }
    // Black lines make the crosshairs visible on bright cells, and light ones on dark cells.
    const cross = (at, colour, dash) => {
      for (const style of [{ colour: "#000000", width: 3.5 }, { colour, width: 1.5, dash }]) {
        line(context, [[this.#x(at[u]), top], [this.#x(at[u]), top + height]], style);
        line(context, [[left, this.#y(at[v])], [left + width, this.#y(at[v])]], style);
      }
    };
    if (pinned) cross(pinned, "#ffa24d", [4, 4]);
    cross(design, "#ffffff", []);
    context.restore();
    const isWithin = (axis) => {
      const { low, high } = this.#window(axis);
      return low <= optimum[axis] && optimum[axis] <= high;
    };
    if (optimum && isWithin(u) && isWithin(v)) {
      const extent = this.#window(across);
      const isNear = Math.abs(optimum[across] - design[across]) < 0.01 * (extent.high - extent.low);
      star(context, this.#x(optimum[u]), this.#y(optimum[v]), 9, isNear);
    }
  }

  #description({ design, field }) {
    const { u, v, across } = this.plane;
    return `${field} over ${axisNames[u]} and ${axisNames[v]} at ${across} = ${design[across]} m. ` +
      `Crosshair at ${u} = ${design[u]}, ${v} = ${design[v]} m. ` +
      "Arrow keys, Home, End, Page Up and Page Down move it.";
  }

  /** Starts a drag; a finger may still scroll the page. */
  #start(event) {
    if (event.button !== 0 || !event.isPrimary) return;
    this.drag = { start: event, isMoving: event.pointerType !== "touch" };
    if (!this.drag.isMoving) return;
    event.preventDefault();
    this.canvas.setPointerCapture(event.pointerId);
    this.#moveTo(event);
  }

  #follow(event) {
    if (event.pointerId !== this.drag?.start.pointerId) return;
    this.drag.isMoving ||= hasSlid(this.drag.start, event);
    if (this.drag.isMoving) this.#moveTo(event);
  }

  /** Ends a drag; where a finger has not moved, it was a tap. */
  #end(event) {
    if (event.pointerId !== this.drag?.start.pointerId) return;
    if (!this.drag.isMoving) this.#moveTo(event);
    this.drag = null;
  }

  #moveTo(event) {
    this.canvas.focus({ preventScroll: true });
    const area = this.canvas.getBoundingClientRect();
    const { left, top, width, height } = this.frame;
    const at = (part, axis) => {
      const { low, high } = this.#window(axis);
      return low + Math.min(Math.max(part, 0), 1) * (high - low);
    };
    const part = {
      [this.plane.u]: at((event.clientX - area.left - left) / width, this.plane.u),
      [this.plane.v]: at(1 - (event.clientY - area.top - top) / height, this.plane.v),
    };
    this.move(() => part);
  }

  /**
   * Arrow keys move by a step of the lattice, ten with Shift; Page Up and Page Down by ten vertically;
   * Home and End to the bounds horizontally, with Shift vertically.
   */
  #press(event) {
    const { plane: { u, v }, view: { box } } = this;
    const many = event.shiftKey ? 10 : 1, far = event.shiftKey ? v : u;
    const moves = {
      ArrowLeft: [u, -many], ArrowRight: [u, many], ArrowDown: [v, -many], ArrowUp: [v, many],
      PageDown: [v, -10], PageUp: [v, 10], Home: [far, -Infinity], End: [far, Infinity],
    };
    if (!(event.key in moves) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const [axis, steps] = moves[event.key];
    this.move((design) => ({ [axis]: design[axis] + steps * box[axis].step }));
  }
}

/** The name of an axis with its unit; only its symbol where the name is longer than the axis. */
function axisTitle(context, axis, length) {
  const title = `${axisNames[axis]} (m)`;
  return context.measureText(title).width <= length ? title : `${axis} (m)`;
}

/** The colour scale below the planes: the quantity with its unit, and the colours with their values. */
export function drawScale(canvas, limits, quantity) {
  const { context, width } = prepared(canvas);
  const title = titleOf(quantity), text = (value, digits) => valueText(quantity, value, digits);
  const [low, high] = limits;
  const left = Math.ceil(context.measureText(title).width) + 30, right = width - 24;
  for (let x = left; x < right; ++x) {
    const [r, g, b] = colourOf(low + ((x - left) / (right - left)) * (high - low), limits);
    context.fillStyle = `rgb(${r}, ${g}, ${b})`;
    context.fillRect(x, 2, 1.5, 12);
  }
  context.fillStyle = theme().text;
  context.textBaseline = "top";
  context.textAlign = "left";
  context.fillText(title, 6, 2);
  context.textAlign = "center";
  for (const tick of ticks(low, high, Math.max((right - left) / 60, 2)))
    context.fillText(text(tick, 12), left + ((tick - low) / (high - low || 1)) * (right - left), 17);
  canvas.setAttribute("aria-label", `colour scale: ${title}, from ${text(low, 8)} to ${text(high, 8)}`);
}
