// The values of keys from their texts, as in src/job/key_kinds.cpp.

import { refuse } from "./input_error.js";
import { allowedText } from "./keys.js";
import { isLength, numberText, parseNumber } from "./numbers.js";

/** The words of a list, separated by commas, spaces or both. */
const wordsOf = (text) => text.trim().split(/[, ]+/);

/** Whether a path survives being written to a job file, where a # starts a comment. */
const isReadableBack = (path) => path !== "" && !/[#"]/.test(path);

/** Refuses a range unless stepping from its first value reaches its last one. */
export function checkSteps(name, text, first, last, step) {
  const steps = (last - first) / step;
  if (Math.abs(steps - Math.round(steps)) <= 1e-9 + 1e-15 * Math.abs(last) / step) return;
  const [below, above] = [Math.floor(steps), Math.ceil(steps)].map((n) => numberText(first + n * step, 15));
  refuse(name, text, "a range whose last value is an integer number of steps from the first; the " +
                     `nearest are ${below} and ${above}`);
}

/** An axis, {first, last, step}; the step of a single value is 0. */
function parseAxis({ name }, text) {
  const numbers = text.split(":").map(parseNumber);
  const [first, last = first, step = 0] = numbers;
  if (![1, 3].includes(numbers.length) || !numbers.every(isLength) || first > last)
    refuse(name, text, "first:last:step with a step above 0 and first <= last, or a single value, in metres, each " +
                       "from 1e-12 to 1e+12");
  if (step) checkSteps(name, text, first, last, step);
  return { first, last, step };
}

/** What the program allows as a quantity; the page knows the fields only. */
const allowedQuantities = (names) => `one of ${names.join(", ")}, or a formula with + - * / ( ) abs() of these, ` +
  "r1, r2, r3, numeric keys of [scene] and numbers with or without a unit";

/** A constraint, {field, sign, limit}. */
function parseConstraint({ name, names }, text, core) {
  const check = (valid, why) => valid || refuse(name, text, `FIELD <= NUMBER or FIELD >= NUMBER, ${why}`);
  const [, field, sign, limit] = text.match(/^(.*?)\s*([<>]=)(.*)$/) ?? [];
  check(sign, "with the sign <= or >=, which includes the limit");
  check(names(core).includes(field), `where FIELD is ${allowedQuantities(names(core))}`);
  const x = parseNumber(limit);
  check(Number.isFinite(x), "where NUMBER is finite");
  return { field, sign, limit: x };
}

const parsers = {
  number(key, text) {
    const x = parseNumber(text);
    return key.allowed.allows(x) ? x : refuse(key.name, text, key.allowed.text);
  },
  integer(key, text) {
    const x = /^\+?\d+$/.test(text) ? Number(text) : NaN;
    return key.allowed.allows(x) ? x : refuse(key.name, text, key.allowed.text);
  },
  choice: (key, text, core) =>
    key.names(core).includes(text) ? text : refuse(key.name, text, allowedText(key, core)),
  quantity: ({ name, names }, text, core) =>
    names(core).includes(text) ? text : refuse(name, text, allowedQuantities(names(core))),
  text: (key, text) => text,
  range: parseAxis,
  list({ name, item, isSet }, text, core) {
    const values = wordsOf(text).map((word) => valueOf({ name, ...item }, word, core));
    const repeated = values.find((value, i) => values.indexOf(value) !== i);
    if (isSet && repeated !== undefined) refuse(name, repeated, "listed only once");
    return values;
  },
  constraints: (key, text, core) =>
    text === "" ? [] : text.split(",").map((part) => parseConstraint(key, part.trim(), core)),
  path: ({ name }, text) => isReadableBack(text) ? text
    : refuse(name, text, "a path without #, quotes or line breaks, and without spaces at its ends"),
  paths: ({ name }, text) => wordsOf(text).filter((word) => word !== "").map((word) =>
    isReadableBack(word) ? word : refuse(name, word, "a path without # or quotes")),
};

/** The value of a key. Throws InputError. */
export function valueOf(key, text, core) {
  return parsers[key.kind](key, text, core);
}
