// Studies: job files that give several values to keys of the scene, as in src/job/outer_axis.cpp and
// src/job/study.cpp. The page shows the first of their scenes, that of the smallest values.

import { InputError, refuse } from "./input_error.js";
import { keyByName } from "./keys.js";
import { numberText, parseNumber } from "./numbers.js";
import { checkedValues, defaultOf, unusedKeys } from "./rules.js";
import { checkSteps, valueOf } from "./values.js";

/** How many values a key may have, and how many scenes a study. */
const most = 1e6;

/** Whether a text gives several values to a key of the scene: trebsweep then computes each of them. */
function isStudied(key, text) {
  return key.kind === "number" && key.name.startsWith("scene.") && /[,:]/.test(text);
}

/** The ascending values of a key with several, as first:last:step or a list. Throws InputError. */
function studiedValues(key, text) {
  const values = text.includes(":") ? rangeValues(key, text) : listValues(key, text);
  const repeated = values.find((x, i) => x === values[i - 1]);
  if (repeated !== undefined)
    refuse(key.name, text, `numbers that differ; ${numberText(repeated)} is repeated`);
  return values;
}

function refuseRange(key, text) {
  refuse(key.name, text, "first:last:step with a step above 0 and first <= last, or numbers separated by commas");
}

function rangeValues(key, text) {
  const parts = text.split(":").map((part) => part.trim());
  const step = parseNumber(parts[2]);
  if (parts.length !== 3 || parts.includes("") || text.includes(",") || !(step > 0) || !Number.isFinite(step))
    refuseRange(key, text);
  const [first, last] = parts.slice(0, 2).map((part) => valueOf(key, part));
  if (first > last) refuseRange(key, text);
  checkSteps(key.name, text, first, last, step);
  const count = Math.round((last - first) / step) + 1;
  if (count > most) refuse(key.name, text, `a range of at most ${most} values`);
  return Array.from({ length: count }, (_, i) => i ? Number((first + i * step).toPrecision(15)) : first);
}

function listValues(key, text) {
  const parts = text.split(",").map((part) => part.trim());
  if (parts.includes("")) refuse(key.name, text, "numbers separated by commas, or first:last:step");
  return parts.map((part) => valueOf(key, part)).sort((a, b) => a - b);
}

/** The keys with several values, in the program's order, as {key, text, values}. */
function studiedKeys(given, core) {
  let scenes = 1;
  return Object.keys(core.defaults).filter((name) => isStudied(keyByName.get(name), given[name] ?? "")).map((name) => {
    const key = keyByName.get(name), text = given[name], values = studiedValues(key, text);
    scenes *= values.length;
    if (scenes > most)
      refuse(name, text, `fewer values: with those of the keys before it they make ${scenes} scenes; at most ` +
                         `${most} are allowed`);
    return { key, text, values };
  });
}

/** The values of a study's keys in one of its scenes. Those of the last key change fastest. */
function sceneAt(studied, n) {
  const scene = {};
  for (const { key, values } of [...studied].reverse()) {
    scene[key.name] = values[n % values.length];
    n = Math.floor(n / values.length);
  }
  return scene;
}

/** A scene of a study in words: "projectile-mass = 50 kg". */
function sceneText(studied, scene) {
  return studied.map(({ key: { name, unit } }) =>
    `${name.slice("scene.".length)} = ${numberText(scene[name])}${unit && ` ${unit}`}`).join(", ");
}

/** Checks what a job with several scenes may ask for. */
function checkStudy(studied, get) {
  const targetError = get("solver.target-error");
  if (studied.length && targetError !== null)
    refuse("solver.target-error", numberText(targetError), `left out if ${studied.at(-1).key.name} has several ` +
           "values: each scene would need its own tolerance; give solver.tolerance");
  const stored = get("output.maps") === "none" ? [] : get("output.fields");
  for (const { key: { name } } of studied) {
    const field = name.slice("scene.".length);
    if (stored.includes(field))
      refuse("output.fields", field,
             `left out if ${name} has several values: the archive has that axis under the same name`);
  }
}

/** Checks the rules for each scene; a mistake names the scene. */
function checkScenes(studied, count, values, core) {
  for (let n = 0; n < count; ++n) {
    const scene = sceneAt(studied, n);
    try {
      checkedValues({ ...values, ...scene }, core);
    } catch (error) {
      if (!(error instanceof InputError) || studied.length === 0) throw error;
      throw new InputError(error.key, `${error.message} (in the scene with ${sceneText(studied, scene)})`);
    }
  }
}

/**
 * The first scene of a job file's keys, {key: text}, as {job, scene}: its keys, and in words the
 * values of those that have several, "" without such keys. Throws InputError where trebsweep refuses the file.
 */
export function firstScene(given, core) {
  const studied = studiedKeys(given, core), values = {};
  for (const [name, text] of Object.entries(given))
    if (!isStudied(keyByName.get(name), text)) values[name] = valueOf(keyByName.get(name), text, core);
  const count = studied.reduce((product, key) => product * key.values.length, 1);
  const largest = { ...values, ...sceneAt(studied, count - 1) }; // uses a key if any scene does
  const get = (name) => largest[name] ?? defaultOf(name, core);
  checkStudy(studied, get);
  for (const [name, why] of [...unusedKeys(get)].sort())
    if (name in given) refuse(name, given[name], why);
  checkScenes(studied, count, values, core);
  const first = sceneAt(studied, 0);
  const texts = Object.fromEntries(Object.entries(first).map(([name, x]) => [name, numberText(x)]));
  return { job: { ...given, ...texts }, scene: sceneText(studied, first) };
}
