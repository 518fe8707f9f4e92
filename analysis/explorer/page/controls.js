// Fields and sliders for the keys of a job.

import { allowedText, groups, keys } from "./keys.js";
import { parseNumber } from "./numbers.js";
import { onSlide } from "./touch.js";

const resolution = 1000;

/** Maps a slider's position, 0 to resolution, to a value with three digits, and back. */
function scaleOf([low, high, log]) {
  const round = (x) => String(Number(x.toPrecision(3)));
  if (log)
    return {
      value: (at) => round(low * (high / low) ** (at / resolution)),
      position: (x) => (resolution * Math.log(Math.max(x, low) / low)) / Math.log(high / low),
    };
  return {
    value: (at) => round(low + (at / resolution) * (high - low)),
    position: (x) => (resolution * (x - low)) / (high - low),
  };
}

function element(tag, properties, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** A default as a field shows it. */
function shortText(value) {
  if (typeof value === "number") return String(Number(value.toPrecision(8)));
  return typeof value === "string" ? value : [value.first, value.last, value.step].map(shortText).join(":");
}

/** A field for a key with its label, slider and message. change(name, text) reports an edit. */
function row(key, core, change) {
  const id = key.name;
  let input;
  if (key.kind === "choice")
    input = element("select", { id, onchange: () => change(id, input.value) },
                    ...key.names(core).map((name) => element("option", { value: name, textContent: name })));
  else
    input = element("input", { id, type: "text", inputMode: key.kind === "number" ? "decimal" : "text",
                               autocomplete: "off", oninput: () => change(id, input.value.trim()) });
  input.setAttribute("aria-describedby", `${id}.message ${id}.why`);
  const parts = [
    element("label", { htmlFor: id }, key.label, key.unit ? ` (${key.unit})` : ""), input,
  ];
  if (key.slider) {
    const scale = scaleOf(key.slider);
    const slider = element("input", { id: `${id}.slider`, type: "range", min: 0, max: resolution, step: 1 });
    onSlide(slider, () => change(id, scale.value(Number(slider.value))));
    slider.setAttribute("aria-label", `${key.label}, slider`);
    slider.setPosition = (x) => {
      const isOwnEdit = scale.value(Number(slider.value)) === String(x);
      if (!isOwnEdit) slider.value = scale.position(x);
      slider.setAttribute("aria-valuetext", `${x} ${key.unit}`);
    };
    parts.push(slider);
  }
  parts.push(element("span", { id: `${id}.why`, className: "why" }),
             element("output", { id: `${id}.message`, className: "message" }));
  return element("div", { className: `key ${key.kind}`, title: `${id}: ${allowedText(key, core)}` }, ...parts);
}

export class Controls {
  constructor(form, core, change) {
    for (const { title, open = false, keys: members } of groups)
      form.append(element("details", { open }, element("summary", { textContent: title }),
                          ...members.map((key) => row(key, core, change))));
  }

  /** Shows a job, texts by key, with the values and unused keys of the last valid one. */
  show(job, { get, unused, job: validJob }) {
    for (const key of keys) {
      const input = document.getElementById(key.name);
      const value = get(key.name);
      const isMissing = value === null || Number.isNaN(value);
      const text = job[key.name] ?? "";
      const isCleared = text === "" && (validJob[key.name] ?? "") !== "";
      if (key.kind === "choice") input.value = text || value;
      else if (input !== document.activeElement || input.value.trim() !== text) // not while the user edits it
        input.value = text !== "" || isMissing || isCleared ? text : shortText(value);
      if (key.kind !== "choice") input.placeholder = isMissing ? "not given" : shortText(value);
      const slider = document.getElementById(`${key.name}.slider`);
      const number = parseNumber(text); // not the value where that is of an older job
      if (slider) slider.setPosition(!Number.isNaN(number) ? number : isMissing ? 0 : value);
      const why = unused.get(key.name);
      for (const control of [input, slider]) if (control) control.disabled = why !== undefined;
      input.closest(".key").classList.toggle("unused", why !== undefined);
      document.getElementById(`${key.name}.why`).textContent =
        why ? `L${why.slice(1)}.` : value === "window" ? "The page computes crossing, at phi1 = pi, instead." : "";
    }
  }

  /** Shows the message of a mistake at its key, or none. Returns whether a key has shown it. */
  report(mistake) {
    let isShown = false;
    for (const { name } of keys) {
      const isWrong = mistake !== null && mistake.key === name;
      const input = document.getElementById(name);
      const message = document.getElementById(`${name}.message`);
      if (isWrong) input.setAttribute("aria-invalid", "true");
      else input.removeAttribute("aria-invalid");
      message.textContent = isWrong ? mistake.message : "";
      if (isWrong) {
        input.disabled = false; // also where the last valid job does not use the key
        input.closest("details").open = true;
      }
      isShown ||= isWrong;
    }
    return isShown;
  }
}
