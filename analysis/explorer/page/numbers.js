// Numbers and their texts, as the program reads and writes them.

/** The number of a text, NaN if it is not one. */
export function parseNumber(text) {
  const [, digits] = String(text).match(/^ *([+-]?(?:\d+\.?\d*|\.\d+))(?:[eE][+-]?\d+)? *$/) ?? [];
  if (digits === undefined) return NaN;
  const number = Number(text);
  const isUnderflow = number === 0 && /[1-9]/.test(digits);
  return isUnderflow ? NaN : number;
}

/** The shortest text of a number, or that of the number rounded to some digits. */
export function numberText(x, digits = null) {
  const rounded = digits === null ? x : Number(x.toPrecision(digits));
  const [mantissa, exponent] = rounded.toExponential().split("e");
  if (exponent >= -4 && exponent < (digits ?? 16)) return String(rounded);
  return `${mantissa}e${exponent[0]}${exponent.slice(1).padStart(2, "0")}`;
}

/** Whether a number of metres can be a length. */
export const isLength = (x) => x >= 1e-12 && x <= 1e12;
export const lengthText = "a number above 0, from 1e-12 to 1e+12";
