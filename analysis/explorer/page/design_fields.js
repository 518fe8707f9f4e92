// The three lengths of the design, as fields and sliders.

import { isLength, lengthText, parseNumber } from "./numbers.js";
import { axes, axisNames, windowOf } from "./space.js";
import { onSlide } from "./touch.js";

const resolution = 1000;

export class DesignFields {
  /** change({r1}) reports an edit. */
  constructor(parent, change) {
    this.ranges = {};
    this.shown = {}; // the last design
    for (const axis of axes) {
      const row = document.createElement("div");
      row.className = "key";
      row.innerHTML = `<label for="design.${axis}">${axisNames[axis]} (m)</label>` +
        `<input id="design.${axis}" type="text" inputmode="decimal" autocomplete="off" ` +
        `aria-describedby="design.${axis}.message">` +
        `<input id="design.${axis}.slider" type="range" min="0" max="${resolution}" step="1" ` +
        `aria-label="${axisNames[axis]}, slider">` +
        `<output id="design.${axis}.message" class="message"></output>`;
      parent.append(row);
      const [input, slider] = row.querySelectorAll("input");
      input.oninput = () => {
        const x = parseNumber(input.value);
        this.#report(axis, isLength(x) ? "" : `must be ${lengthText}`);
        if (isLength(x)) change({ [axis]: x });
      };
      onSlide(slider, () => change({ [axis]: this.#lengthAt(axis, slider.value) }));
    }
  }

  /** The length at a slider's position. */
  #lengthAt(axis, position) {
    const { low, high } = this.ranges[axis];
    const x = low + (position / resolution) * (high - low);
    const digits = Math.ceil(Math.log10(resolution * high / (high - low))); // tell positions apart
    return Number(Math.max(x, 1e-3 * high).toPrecision(digits));
  }

  /** Shows what is wrong with a field, or nothing. */
  #report(axis, mistake) {
    const input = document.getElementById(`design.${axis}`);
    document.getElementById(`design.${axis}.message`).textContent =
      mistake && `${axis}${input.value.trim() && ` = ${input.value}`}: ${mistake}`;
    input.setAttribute("aria-invalid", String(mistake !== ""));
  }

  show(design, box) {
    for (const axis of axes) {
      this.ranges[axis] = windowOf(box[axis]);
      const { low, high } = this.ranges[axis];
      const input = document.getElementById(`design.${axis}`);
      const slider = document.getElementById(`design.${axis}.slider`);
      const isOwnEdit = design[axis] === this.shown[axis] || design[axis] === parseNumber(input.value);
      if (input !== document.activeElement || !isOwnEdit) {
        input.value = String(design[axis]);
        this.#report(axis, "");
      }
      if (this.#lengthAt(axis, slider.value) !== design[axis])
        slider.value = ((design[axis] - low) / (high - low)) * resolution;
      slider.setAttribute("aria-valuetext", `${design[axis]} m`);
      this.shown[axis] = design[axis];
    }
  }
}
