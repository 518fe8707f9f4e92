// The table of quantities of the design and of the pinned one.

import { has, quantities, titleOf, valueText } from "./quantities.js";

function cell(tag, text, id) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (id) made.id = id;
  return made;
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
  const rounding = Number.EPSILON * trace.fields.speed;
  const text = (x) => (Number.isNaN(x) ? "–" : `${Math.max(x, rounding).toExponential(0)} m/s`);
  document.getElementById("errors").textContent =
    `Error of the speed: about ${text(error)}; of the planes, here: ${text(planeError)}.`;
}
