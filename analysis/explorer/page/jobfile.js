// Job files and the address of the page: texts of a job's keys.

import { InputError, shortened } from "./input_error.js";
import { keyByName, sections } from "./keys.js";
import { isLength, lengthText } from "./numbers.js";
import { axes } from "./space.js";
import { firstScene } from "./study.js";

function refuseFile(why) {
  throw new InputError(null, why);
}

/** Without the white space of a job file. */
const trimmed = (text) => text.replace(/^[ \t\r]+|[ \t\r]+$/g, "");

/** The keys of a job file's text, as {"section.key": "value"}; as in src/job/config_file.cpp. */
export function parsed(text) {
  const values = new Map(), lines = new Map();
  let section = "";
  text.replace(/^\ufeff/, "").split("\n").forEach((line, index) => {
    const number = index + 1, hash = line.indexOf("#");
    const content = trimmed(hash < 0 ? line : line.slice(0, hash));
    const equals = content.indexOf("=");
    const refuseLine = (shown, why) => refuseFile(`line ${number}, '${shortened(shown)}', ${why}`);
    if (content === "") return;
    if (/^\[.+\]$/.test(content)) {
      section = content.slice(1, -1).replace(/\.?$/, ".");
      return;
    }
    if (equals < 0) refuseLine(content, "is neither [section] nor key = value");
    if (hash > 0 && !/[ \t]/.test(line[hash - 1]))
      refuseLine(trimmed(line), "has a # inside a value; put a space before a comment");
    const key = section + trimmed(content.slice(0, equals));
    if (lines.has(key)) refuseFile(`${shortened(key)} is given twice, on lines ${lines.get(key)} and ${number}`);
    lines.set(key, number);
    values.set(key, trimmed(content.slice(equals + 1)));
  });
  return Object.fromEntries(values);
}

/** Refuses a key that no job has. */
function refuseUnknown(name) {
  const section = name.split(".")[0];
  const known = [...keyByName.keys(), "scene.file"].filter((key) => key.startsWith(`${section}.`));
  const given = shortened(name);
  if (section === name || !known.length)
    refuseFile(`${given}: ${section === name ? "key before any [section]" : "unknown key"}; the sections are ` +
               sections.join(", "));
  refuseFile(`${given}: unknown key; the keys of [${section}] are ` +
             known.map((key) => key.slice(section.length + 1)).join(", "));
}

/** The keys of a file and of the scene that it names, one of the presets. */
function withScene({ "scene.file": path, ...given }, presets) {
  if (path === undefined) return given;
  const [, preset] = path.match(/^(?:.*\/)?scenes\/(\w+)\.cfg$/) ?? [];
  const scene = Object.hasOwn(presets, preset) ? parsed(presets[preset]) : null;
  if (!scene || !Object.keys(scene).every((key) => key.startsWith("scene.")))
    refuseFile(`scene.file = ${shortened(path)}: cannot be read by the page, which has the scenes of jobs/scenes ` +
               "alone; open that file itself, or copy its keys to [scene] of this one");
  return { ...scene, ...given };
}

/**
 * The job of a file's text, as {job, scene}: the texts of its keys and, of a study, in words the scene
 * that the page shows, otherwise "". A scene's own file is read if it is one of the presets, texts by name.
 * Throws InputError where trebsweep refuses the file.
 */
export function readJob(text, presets, core) {
  if (/[\0-\x08\x0b\x0c\x0e-\x1f]/.test(text)) refuseFile("is not a text file");
  if (text.length > 2 ** 20) refuseFile("is longer than 1 MiB");
  const given = parsed(text);
  for (const name of Object.keys(given))
    if (name !== "scene.file" && !keyByName.has(name)) refuseUnknown(name);
  return firstScene(withScene(given, presets), core);
}

/** Keys that the page does not use, with the values for which it still shows what the program computes. */
const assumed = {
  "solver.stepper": "vern8", "output.optimum": "all", "optimum.objective": "speed", "optimum.subject-to": "",
  "optimum.minimize": "", "optimum.variables": "", "optimum.robust": "no",
};
const fewSteps = 50000; // which the page allows, whatever a job says

/** The keys of a job, as "key = value", for which the page does not show what the program computes. */
export function ignoredKeys(job) {
  const isIgnored = ([key, value]) => (key in assumed && value !== assumed[key]) ||
    (key === "solver.release" && value === "window") || (key === "solver.max-steps" && value < fewSteps);
  return Object.entries(job).filter(isIgnored).map(([key, value]) => `${key} = ${value}`);
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

/** A job file for trebsweep. */
export function jobText(job, unused, design) {
  const values = {};
  for (const [key, value] of Object.entries(job))
    if (value !== "" && !unused.has(key)) values[key] = value;
  const lines = [
    "# A scene from the explorer. The design on the page:",
    `#   --r1 ${design.r1} --r2 ${design.r2} --r3 ${design.r3}`,
  ];
  for (const section of sections) {
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
  if (locked) parameters.set("scale", locked.join(":"));
  if (pinned) put("pinned.", pinned.job, pinned.design);
  return parameters.toString();
}

/** The design that the page starts with: the optimum of the paper's lattice. */
export const firstDesign = { r1: 0.51, r3: 0.58, r2: 0.91 };

/**
 * The state of a fragment, with defaults where it lacks something; `isGiven`: whether it has a job or a design;
 * `mistakes`: what is wrong with its lengths.
 */
export function fromFragment(fragment) {
  const parameters = new URLSearchParams(fragment), mistakes = [];
  const get = (prefix) => {
    const job = {}, design = {};
    for (const [name, value] of parameters) {
      if (!name.startsWith(prefix)) continue;
      const key = name.slice(prefix.length);
      if (keyByName.has(key)) job[key] = value;
      if (!axes.includes(key)) continue;
      if (isLength(Number(value))) design[key] = Number(value);
      else mistakes.push(`${shortened(name)} = ${shortened(value)}: must be ${lengthText}`);
    }
    const isGiven = Object.keys({ ...job, ...design }).length > 0;
    return isGiven ? { job, design: { ...firstDesign, ...design } } : null;
  };
  const given = get("");
  const scale = (parameters.get("scale") ?? "").split(":").map(Number);
  const isScale = scale.length === 2 && scale.every(Number.isFinite) && scale[0] < scale[1];
  return {
    ...(given ?? { job: {}, design: firstDesign }), isGiven: given !== null, field: parameters.get("field"),
    locked: isScale ? scale : null, pinned: get("pinned."), mistakes, origin: parameters.get("from") ?? "paper",
  };
}
