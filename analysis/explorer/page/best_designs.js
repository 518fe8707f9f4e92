// The best designs found: the buttons that lead to them, and the crosshair that waits for them.

import { quantityOf, valueText } from "./quantities.js";

const at = (id) => document.getElementById(id);

export class BestDesigns {
  /** @param adopt moves the crosshair to a design; isOwn: without an action of the user */
  constructor(adopt) {
    Object.assign(this, { adopt, maxima: null, isAwaited: false });
    at("best").onclick = () => adopt(this.maxima[0].design);
  }

  /** The best design, undefined while it is searched for and if there is none. */
  get design() {
    return this.maxima?.[0]?.design;
  }

  /** Takes the designs, best first, as {design, value}; null: they are searched for. */
  take(maxima, quantity) {
    this.maxima = maxima;
    const text = ({ value }) => `${valueText(quantity, value, 6)} ${quantity.unit}`;
    const [best] = maxima ?? [];
    at("best").disabled = !best;
    at("best").textContent = best ? `Go to the best ${quantity.label} found: ${text(best)}`
      : maxima ? `No design with a ${quantity.label} found` : `Searching for the best ${quantity.label} …`;
    at("maxima").replaceChildren(...(maxima ?? []).slice(1, 4).map((maximum) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = `Local maximum: ${text(maximum)}`;
      button.onclick = () => this.adopt(maximum.design);
      return button;
    }));
    if (this.isAwaited && best) this.#arrive();
  }

  /** Moves the crosshair to the best design as soon as it is known. */
  await() {
    this.isAwaited = true;
    if (this.design) this.#arrive();
  }

  #arrive() {
    this.isAwaited = false;
    this.adopt(this.design, true);
  }
}
