// The table of quantities of the design and of the pinned one.

import { has, quantities, titleOf, valueText } from "./quantities.js";

function cell(tag, text, id) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (id) made.id = id;
  return made;
}

/** Shows the speed, or why there is none. */
export function showHeadline({ fields, status }, core) {
  const show = (id, text) => { document.getElementById(id).textContent = text; };
  show("headline", Number.isNaN(fields.speed) ? status.replaceAll("_", " ") : `${fields.speed.toFixed(8)} m/s`);
  if (status !== "released") show("reason", core.statusMeanings[core.statuses.indexOf(status)]);
  else if (fields["least-sling-tension"] < 0)
    show("reason", "The sling would go slack: its least tension is negative. The speed is unphysical.");
  else show("reason", "");
}

/** Fills the table; `pinned` is {trace, numbers} or null. Rows have the meanings of the core's fields. */
export function showReadouts(table, { trace, error, planeError }, numbers, pinned, core) {
  const value = (quantity, shown) =>
    quantity.field === "status" ? shown.status.replaceAll("_", " ")
      : valueText(quantity, shown.fields[quantity.field]);
  const head = document.createElement("tr");
  head.append(cell("th", ""), cell("th", "live"), cell("th", "pinned"));
  const rows = quantities.filter((quantity) => has(quantity, numbers)).map((quantity) => {
    const row = document.createElement("tr");
    row.title = core.fields.find(({ name }) => name === quantity.field).meaning;
    row.append(cell("th", titleOf(quantity)), cell("td", value(quantity, trace), `readout.${quantity.field}`));
    if (pinned) {
      const text = has(quantity, pinned.numbers) ? value(quantity, pinned.trace) : "–";
      row.append(cell("td", text, `pinned.${quantity.field}`));
    }
    return row;
  });
  table.replaceChildren(...(pinned ? [head] : []), ...rows);
  const rounding = 100 * Number.EPSILON * trace.fields.speed; // of some hundred steps
  const text = (x) => (Number.isNaN(x) ? "–" : `${Math.max(x, rounding).toExponential(0)} m/s`);
  document.getElementById("errors").textContent =
    `Error of the speed: about ${text(error)}; of the planes, here: ${text(planeError)}.`;
}
