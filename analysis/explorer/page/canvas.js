// Drawing on canvases that follow their size on the page, the screen's resolution and the theme.

/** The colours of the theme, from the style sheet. */
export function theme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    text: colour("text"), faint: colour("faint"), line: colour("line"), panel: colour("panel"),
    accent: colour("accent"), pinned: colour("pinned"), third: colour("third"), wood: colour("wood"),
  };
}

/** Clears a canvas and returns its context, in CSS pixels, with its width and height. */
export function prepared(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const scale = window.devicePixelRatio || 1;
  const pixels = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== pixels[0]) canvas.width = pixels[0];
  if (canvas.height !== pixels[1]) canvas.height = pixels[1];
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = "12px system-ui, sans-serif";
  return { context, width, height };
}

export function line(context, points, { colour, width = 1, dash = [] }) {
  context.beginPath();
  points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
}

export function dot(context, [x, y], radius, colour) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
}

/** A star with a dark outline, filled or hollow. */
export function star(context, x, y, radius, filled) {
  context.beginPath();
  for (let i = 0; i < 10; ++i) {
    const angle = (i * Math.PI) / 5, r = i % 2 ? 0.42 * radius : radius;
    const at = [x + r * Math.sin(angle), y - r * Math.cos(angle)];
    if (i) context.lineTo(...at);
    else context.moveTo(...at);
  }
  context.closePath();
  context.lineWidth = 1.5;
  if (filled) {
    context.fillStyle = "#ffffff";
    context.fill();
  }
  context.strokeStyle = "#000000";
  context.lineWidth = 2.5;
  context.stroke();
  context.strokeStyle = "#ffffff";
  context.lineWidth = 1;
  context.stroke();
}
