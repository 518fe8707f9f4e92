// A heat map through the design: drawing, and moving the crosshair by mouse, touch and keys.

import { line, prepared, star, theme } from "./canvas.js";
import { colourOf, statusColour, ticks } from "./colours.js";
import { axisNames, localMaxima, windowOf } from "./space.js";

const margin = { left: 46, right: 8, top: 6, bottom: 38 };

export class PlaneView {
  /** @param move called with a function of the design that returns the user's part, as {r1, r2} */
  constructor(canvas, plane, move) {
    Object.assign(this, { canvas, plane, move, data: null });
    this.image = document.createElement("canvas");
    canvas.addEventListener("pointerdown", (event) => this.#drag(event));
    canvas.addEventListener("pointermove", (event) => event.buttons && this.#drag(event));
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

  /** `view` is the page's state: box, design, field, limits, optimum and pinned design. */
  draw(view) {
    this.view = view;
    const { context, width, height } = prepared(this.canvas);
    const colours = theme();
    this.frame = { left: margin.left, top: margin.top, width: width - margin.left - margin.right,
                   height: height - margin.top - margin.bottom };
    const { left, top, width: w, height: h } = this.frame;
    this.#hatch(context, colours);
    if (this.data?.field === view.field) this.#paint(context, view);
    line(context, [[left, top], [left + w, top], [left + w, top + h], [left, top + h], [left, top]],
         { colour: colours.line });
    this.#axes(context, colours);
    this.#limits(context, colours);
    this.#markers(context, view, colours);
    this.canvas.setAttribute("aria-label", this.#description(view));
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
    const u = this.#window(plane.u), v = this.#window(plane.v);
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
    for (const tick of ticks(v.low, v.high, height / 45)) {
      line(context, [[left - 4, this.#y(tick)], [left, this.#y(tick)]], { colour: colours.line });
      context.fillText(String(tick), left - 6, this.#y(tick));
    }
    context.save();
    context.translate(10, top + height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(axisTitle(context, plane.v, height), 0, 0);
    context.restore();
  }

  /** The bound r2 + r3 < h0 (49), and the single values of axes. */
  #limits(context, colours) {
    const { box, design } = this.view;
    const { u, v } = this.plane;
    const style = { colour: colours.text, width: 1.5 };
    const uWindow = this.#window(u), vWindow = this.#window(v);
    context.save();
    context.beginPath();
    context.rect(this.frame.left, this.frame.top, this.frame.width, this.frame.height);
    context.clip();
    if (Number.isFinite(box.reach)) {
      const points = this.plane.across === "r1"
        ? [uWindow.low, uWindow.high].map((x) => [this.#x(x), this.#y(box.reach - x)])
        : [vWindow.low, vWindow.high].map((y) =>
          [this.#x(box.reach - design[this.plane.across]), this.#y(y)]);
      line(context, points, style);
    }
    if (box[u].low === box[u].high)
      line(context, [vWindow.low, vWindow.high].map((y) => [this.#x(box[u].low), this.#y(y)]), style);
    if (box[v].low === box[v].high)
      line(context, [uWindow.low, uWindow.high].map((x) => [this.#x(x), this.#y(box[v].low)]), style);
    context.restore();
  }

  #markers(context, { box, design, optimum, pinned, field }, colours) {
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
    const cross = (at, colour, dash) => {
      for (const [paint, w] of [["#00000080", 3], [colour, 1.5]]) {
        line(context, [[this.#x(at[u]), top], [this.#x(at[u]), top + height]],
             { colour: paint, width: w, dash });
        line(context, [[left, this.#y(at[v])], [left + width, this.#y(at[v])]],
             { colour: paint, width: w, dash });
      }
    };
    if (pinned) cross(pinned, colours.pinned, [2, 4]);
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
      `Crosshair at ${u} = ${design[u]}, ${v} = ${design[v]} m. Arrow keys move it.`;
  }

  #drag(event) {
    event.preventDefault();
    this.canvas.focus({ preventScroll: true });
    if (event.type === "pointerdown") this.canvas.setPointerCapture?.(event.pointerId);
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

  /** Arrow keys move by a step of the lattice, ten with Shift. */
  #press(event) {
    const directions = { ArrowLeft: [this.plane.u, -1], ArrowRight: [this.plane.u, 1],
                         ArrowDown: [this.plane.v, -1], ArrowUp: [this.plane.v, 1] };
    if (!(event.key in directions) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const [axis, sign] = directions[event.key];
    const step = this.view.box[axis].step * (event.shiftKey ? 10 : 1);
    this.move((design) => ({ [axis]: design[axis] + sign * step }));
  }
}

/** The name of an axis with its unit; only its symbol where the name is longer than the axis. */
function axisTitle(context, axis, length) {
  const title = `${axisNames[axis]} (m)`;
  return context.measureText(title).width <= length ? title : `${axis} (m)`;
}

/** The colour scale below the planes, with its limits. */
export function drawScale(canvas, limits, text) {
  const { context, width } = prepared(canvas);
  const colours = theme();
  const left = 30, right = width - 30;
  for (let x = left; x < right; ++x) {
    const [r, g, b] = colourOf(limits[0] + ((x - left) / (right - left)) * (limits[1] - limits[0]), limits);
    context.fillStyle = `rgb(${r}, ${g}, ${b})`;
    context.fillRect(x, 2, 1.5, 12);
  }
  context.fillStyle = colours.text;
  context.textAlign = "center";
  context.textBaseline = "top";
  const [low, high] = limits;
  for (const tick of ticks(low, high, width / 70))
    context.fillText(text(tick), left + ((tick - low) / (high - low || 1)) * (right - left), 17);
}
