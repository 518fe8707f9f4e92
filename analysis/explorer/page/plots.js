// Angles, speed and loads of a swing against time.

import { line, prepared, theme } from "./canvas.js";
import { limitsOf, ticks } from "./colours.js";

const margin = { left: 46, right: 8, top: 22, bottom: 20 };
const titleLeft = 8;

/** The plots; a curve is shown if the scene has what it shows. */
const plots = [
  { title: "angles (rad)", curves: [
    { column: "phi1", label: "phi1" }, { column: "phi2", label: "phi2" },
    { column: "phi3", label: "phi3", if: (scene) => scene.hanger }] },
  { title: "speed (m/s)", curves: [{ column: "speed", label: "projectile" }] },
  { title: "forces (kN)", factor: 1e-3, curves: [
    { column: "tip_tension", label: "sling" }, { column: "axle", label: "axle" },
    { column: "hanger_tension", label: "hanger", if: (scene) => scene.hanger }] },
];

/** Draws all plots, one below the other; `traces` are the design's and the pinned one's. */
export function drawPlots(canvas, traces, t) {
  const { context, width, height } = prepared(canvas);
  const colours = theme();
  const shown = traces.filter((trace) => trace && trace.rows.t.length);
  if (!shown.length) return;
  plots.forEach((plot, i) => {
    const part = height / plots.length;
    drawPlot(context, plot, shown, t, colours, {
      left: margin.left, top: i * part + margin.top, width: width - margin.left - margin.right,
      height: part - margin.top - margin.bottom,
    }, traces[0]);
  });
}

function drawPlot(context, { title, curves, factor = 1 }, traces, t, colours, frame, first) {
  const { left, top, width, height } = frame;
  const used = curves.filter((curve) => !curve.if || traces.some(({ scene }) => curve.if(scene)));
  const end = Math.max(...traces.map(({ rows }) => rows.t.at(-1)));
  const values = limitsOf(traces.flatMap(({ rows }) => used.map(({ column }) => rows[column])))
    .map((value) => value * factor);
  const [low, high] = values[1] > values[0] ? values : [values[0] - 1, values[0] + 1];
  const x = (time) => left + (time / (end || 1)) * width;
  const y = (value) => top + (1 - (value - low) / (high - low)) * height;

  context.fillStyle = colours.text;
  context.textBaseline = "middle";
  context.textAlign = "right";
  for (const tick of ticks(low, high, height / 28)) {
    line(context, [[left, y(tick)], [left + width, y(tick)]], { colour: colours.faint });
    context.fillText(String(tick), left - 5, y(tick));
  }
  context.textBaseline = "top";
  context.textAlign = "center";
  for (const tick of ticks(0, end, width / 60)) context.fillText(`${tick} s`, x(tick), top + height + 4);
  const palette = [colours.accent, colours.text, colours.third];
  context.textBaseline = "bottom";
  context.textAlign = "left";
  context.fillText(title, titleLeft, top - 5);
  let at = titleLeft + context.measureText(title).width + 14;
  used.forEach((curve, i) => {
    const { column, label } = curve;
    for (const trace of traces.filter(({ scene }) => !curve.if || curve.if(scene)))
      line(context, Array.from(trace.rows.t, (time, k) => [x(time), y(trace.rows[column][k] * factor)]),
           { colour: palette[i], width: trace === first ? 1.8 : 1, dash: trace === first ? [] : [3, 4] });
    context.fillStyle = palette[i];
    context.fillText(label, at, top - 5);
    at += context.measureText(label).width + 10;
  });
  if (t <= end) line(context, [[x(t), top], [x(t), top + height]], { colour: colours.line, width: 1 });
}
