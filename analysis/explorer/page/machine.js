// The machine, drawn to scale from a trace, and the flight of its projectile.

import { dot, line, prepared, theme } from "./canvas.js";
import { limitsOf, ticks } from "./colours.js";

/** What the drawings need to know of a scene; `get(name)` is the value of a key. */
export function machineOf({ get }) {
  return {
    fulcrumHeight: get("scene.fulcrum-height"), hanger: get("scene.counterweight-hanger") > 0,
    trough: get("scene.trough") === "yes", troughHeight: get("scene.trough-height"),
  };
}

/** The time of the last row of a trace and, with a flight, that of the impact, s. */
export function endOf(trace) {
  const { rows, flight } = trace;
  return flight.t.length ? flight.t.at(-1) : (rows.t.at(-1) ?? 0);
}

/** The values of all columns at a time, interpolated. */
function rowAt(table, t) {
  const times = table.t, last = times.length - 1;
  const position = Math.min(Math.max((t - times[0]) / (times[last] - times[0] || 1), 0), 1) * last;
  const low = Math.min(Math.floor(position), Math.max(last - 1, 0)), part = position - low;
  const row = {};
  for (const [name, values] of Object.entries(table))
    row[name] = values[low] + part * ((values[low + 1] ?? values[low]) - values[low]);
  return row;
}

/** Maps metres to pixels such that a range fits, with equal scales. */
function mapping({ width, height }, [left, right], [bottom, top], padding) {
  const scale = Math.min((width - 2 * padding) / (right - left), (height - 2 * padding) / (top - bottom));
  const offset = [(width - scale * (right - left)) / 2, (height - scale * (top - bottom)) / 2];
  return { scale, point: (x, y) => [offset[0] + scale * (x - left), height - offset[1] - scale * (y - bottom)] };
}

/**
 * Draws the machines of the design and of the pinned one, which is faint, at time t (s): traces with
 * their scenes, or null. Their fulcrums coincide; the ground is that of the design, if it is shown.
 */
export function drawMachine(canvas, traces, t) {
  const frame = prepared(canvas);
  const { context, width, height } = frame;
  const colours = theme();
  const shown = traces.filter((trace) => trace && trace.rows.t.length);
  if (!shown.length) return;
  const [{ scene }] = shown;
  const ground = -scene.fulcrumHeight;
  const horizontal = limitsOf([...shown.flatMap(({ rows }) => [rows.x1, rows.xh, rows.xt, rows.x3]), [0]]);
  const vertical = limitsOf([...shown.flatMap(({ rows }) => [rows.y1, rows.yh, rows.yt, rows.y3]), [0, ground]]);
  const { scale, point } = mapping(frame, horizontal, vertical, 22);

  const level = point(0, ground)[1];
  context.fillStyle = colours.faint;
  context.fillRect(0, level, width, height - level);
  line(context, [[0, level], [width, level]], { colour: colours.line });
  const pixel = 60 / scale, bar = ticks(0, 2.5 * pixel, 2.5)[1]; // steps of 1, 2 and 5
  line(context, [[10, 12], [10 + scale * bar, 12]], { colour: colours.text, width: 2 });
  context.fillStyle = colours.text;
  context.textBaseline = "top";
  context.textAlign = "left";
  context.fillText(`${bar} m`, 10, 16);

  line(context, [point(-0.25 * scene.fulcrumHeight, ground), point(0, 0),
                 point(0.25 * scene.fulcrumHeight, ground)], { colour: colours.line, width: 2 });
  shown.slice().reverse().forEach((trace) => {
    const isPinned = trace !== traces[0];
    context.globalAlpha = isPinned ? 0.7 : 1;
    drawOne(context, trace, t, point, isPinned ? { ...colours, accent: colours.pinned } : colours);
    context.globalAlpha = 1;
  });
}

function drawOne(context, { rows, flight, fields, scene }, t, point, colours) {
  const at = rowAt(rows, t);
  if (scene.trough && fields["lift-off-time"] >= 0) {
    const height = scene.troughHeight - scene.fulcrumHeight;
    const end = rowAt(rows, fields["lift-off-time"]);
    line(context, [point(rows.x3[0], height), point(end.x3, height)], { colour: colours.wood, width: 4 });
  }
  const path = Array.from(rows.x3, (x, i) => point(x, rows.y3[i]));
  line(context, path, { colour: colours.accent, width: 1, dash: [3, 3] });
  line(context, [point(at.xh, at.yh), point(at.xt, at.yt)], { colour: colours.wood, width: 5 });
  line(context, [point(at.xh, at.yh), point(at.x1, at.y1)], { colour: colours.line, width: 2 });
  const released = flight.t.length > 0 && t > rows.t.at(-1);
  const ball = released ? rowAt(flight, t) : null;
  const position = ball ? point(ball.x, ball.height - scene.fulcrumHeight) : point(at.x3, at.y3);
  if (!released) line(context, [point(at.xt, at.yt), position], { colour: colours.text, width: 1.5 });
  const [x, y] = point(at.x1, at.y1);
  context.fillStyle = colours.line;
  context.fillRect(x - 9, y - 9, 18, 18);
  dot(context, point(0, 0), 4, colours.text);
  dot(context, position, 5, colours.accent);
}

/** Draws the flights of the design and of the pinned one, with the projectiles at time t (s). */
export function drawFlight(canvas, traces, t) {
  const frame = prepared(canvas);
  const { context, width } = frame;
  const colours = theme();
  const shown = traces.filter((trace) => trace && trace.flight.t.length);
  context.fillStyle = colours.text;
  context.textBaseline = "top";
  if (!shown.length || shown[0] !== traces[0]) {
    if (traces[0]) context.fillText("no flight to the ground", 8, 6);
    if (!shown.length) return;
  }
  const [{ scene }] = shown;
  const xs = limitsOf([...shown.map(({ flight }) => flight.x), [0]]);
  const ys = limitsOf([...shown.map(({ flight }) => flight.height), [0, scene.fulcrumHeight]]);
  const { point } = mapping({ width, height: frame.height - 16 }, xs, ys, 12);
  const level = point(0, 0)[1];
  line(context, [[0, level], [width, level]], { colour: colours.line });
  context.textAlign = "center";
  const length = point(xs[1], 0)[0] - point(xs[0], 0)[0];
  for (const tick of ticks(xs[0], xs[1], length / 60)) {
    const x = point(tick, 0)[0];
    line(context, [[x, level], [x, level + 4]], { colour: colours.line });
    context.fillText(`${tick} m`, x, level + 5);
  }
  context.textAlign = "left";
  line(context, [point(0, 0), point(0, scene.fulcrumHeight)], { colour: colours.wood, width: 3 });
  for (const trace of shown.reverse()) {
    const colour = trace === traces[0] ? colours.accent : colours.pinned;
    const { flight } = trace;
    line(context, Array.from(flight.x, (x, i) => point(x, flight.height[i])), { colour, width: 1.5 });
    if (t >= flight.t[0]) {
      const at = rowAt(flight, t);
      dot(context, point(at.x, at.height), 4, colour);
    }
  }
}
