// Job files and the address of the page: texts of a job's keys.

import { InputError } from "./input_error.js";
import { keyByName } from "./keys.js";
import { isLength } from "./rules.js";
import { axes } from "./space.js";

/** The keys of a job file's text, as {"section.key": "value"}. Throws InputError for other lines. */
function parsed(text, name) {
  const values = {};
  let section = "";
  text.replace(/^\ufeff/, "").split(/\r?\n/).forEach((line, number) => {
    const content = line.replace(/#.*/, "").trim();
    const equals = content.indexOf("=");
    if (content === "") return;
    if (/^\[.+\]$/.test(content)) section = `${content.slice(1, -1)}.`;
    else if (equals > 0)
      values[section + content.slice(0, equals).trim()] = content.slice(equals + 1).trim();
    else
      throw new InputError(null, `job file ${name}: line ${number + 1}, '${content}', is neither ` +
                                 "[section] nor key = value");
  });
  return values;
}

/** Keys that the page does not have, with the values for which it shows what the program computes. */
const assumed = {
  "solver.stepper": "vern8", "output.optimum": "all", "optimum.objective": "speed", "optimum.subject-to": "",
  "optimum.robust": "no",
};

/** Whether a key that the page does not have changes nothing that the page shows. */
function isHarmless(key, value) {
  if (key in assumed) return value === assumed[key];
  return !/^(scene|lattice)\.|^solver\.release/.test(key);
}

/**
 * The job of a file's text: {job, ignored}, the texts of the keys that the page has, and the names
 * of the others. A scene's own file is read if it is one of the presets, texts by name.
 */
export function readJob(text, name, presets) {
  let values = parsed(text, name);
  const ignored = [];
  const path = values["scene.file"];
  if (path !== undefined) {
    delete values["scene.file"];
    const [, preset] = path.match(/^(?:.*\/)?scenes\/(\w+)\.cfg$/) ?? [];
    const scene = Object.hasOwn(presets, preset) ? presets[preset] : undefined;
    if (scene === undefined) ignored.push(`scene.file = ${path}`);
    else values = { ...parsed(scene, path), ...values };
  }
  const job = {};
  for (const [key, value] of Object.entries(values)) {
    const isStudied = key.startsWith("scene.") && /[:,]/.test(value);
    if (!keyByName.has(key) || (key === "solver.release" && value === "window")) {
      if (!isHarmless(key, value)) ignored.push(`${key} = ${value}`);
    } else if (isStudied) {
      job[key] = value.split(/[:,]/)[0].trim();
      ignored.push(`all but the first value of ${key}`);
    } else
      job[key] = value;
  }
  return { job, ignored };
}

/** The design in a line of comment, "--r1 0.5 ..." or "r1 = 0.5 m, ...", with all three lengths; null without one. */
export function suggestedDesign(text) {
  for (const line of text.match(/^#.*$/gm) ?? []) {
    const lengths = [...line.matchAll(/\b(r[123]) (?:= )?(\d+(?:\.\d+)?(?:e[+-]?\d+)?)(?![\d.:e])/g)];
    const design = Object.fromEntries(lengths.map(([, axis, value]) => [axis, Number(value)]));
    if (axes.every((axis) => isLength(design[axis]))) return design;
  }
  return null;
}

/** A job file for trebsweep; `proposed` are lattice axes, {key: text}, that the job does not give. */
export function jobText(job, unused, proposed, design) {
  const values = { ...proposed };
  for (const [key, value] of Object.entries(job))
    if (value !== "" && !unused.has(key)) values[key] = value;
  const lines = [
    "# A scene from the explorer. The design on the page:",
    `#   --r1 ${design.r1} --r2 ${design.r2} --r3 ${design.r3}`,
  ];
  for (const section of ["scene", "lattice", "solver"]) {
    const own = Object.keys(values).filter((key) => key.startsWith(`${section}.`));
    if (own.length === 0) continue;
    lines.push("", `[${section}]`);
    for (const key of own) lines.push(`${key.slice(section.length + 1)} = ${values[key]}`);
  }
  return `${lines.join("\n")}\n`;
}

/** The state of the page as the fragment of its address. */
export function toFragment({ job, design, field, locked, pinned, origin }) {
  const parameters = new URLSearchParams();
  const put = (prefix, given, point) => {
    for (const [key, value] of Object.entries(given))
      if (value !== "") parameters.set(prefix + key, value);
    for (const axis of axes) parameters.set(prefix + axis, String(point[axis]));
  };
  put("", job, design);
  parameters.set("field", field);
  parameters.set("from", origin);
  if (locked) parameters.set("scale", locked.map((x) => x.toPrecision(6)).join(":"));
  if (pinned) put("pinned.", pinned.job, pinned.design);
  return parameters.toString();
}

/** The design that the page starts with: the optimum of the paper's lattice. */
export const firstDesign = { r1: 0.51, r3: 0.58, r2: 0.91 };

/** The state of a fragment, with defaults where it lacks something; `isGiven`: whether it has a job or a design. */
export function fromFragment(fragment) {
  const parameters = new URLSearchParams(fragment);
  const get = (prefix) => {
    const job = {}, design = {};
    for (const [name, value] of parameters) {
      if (!name.startsWith(prefix)) continue;
      const key = name.slice(prefix.length);
      if (keyByName.has(key)) job[key] = value;
      if (axes.includes(key) && isLength(Number(value))) design[key] = Number(value);
    }
    const isGiven = Object.keys({ ...job, ...design }).length > 0;
    return isGiven ? { job, design: { ...firstDesign, ...design } } : null;
  };
  const given = get("");
  const scale = (parameters.get("scale") ?? "").split(":").map(Number);
  const isScale = scale.length === 2 && scale.every(Number.isFinite) && scale[0] < scale[1];
  return {
    ...(given ?? { job: {}, design: firstDesign }), isGiven: given !== null, field: parameters.get("field"),
    locked: isScale ? scale : null, pinned: get("pinned."), origin: parameters.get("from") ?? "paper",
  };
}
