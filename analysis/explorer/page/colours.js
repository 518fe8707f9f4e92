// Colour scales that people with a colour deficiency can read: viridis for numbers, and the palette
// of Okabe and Ito for statuses.

/** Viridis (S. van der Walt and N. Smith, CC0) at 33 values. */
const stops =
  "440154470d6048186a482374472d7b4537814240863e49893b528b375b8d33638d" +
  "2f6b8e2c728e297a8e26828e23898e21918c1f988b1fa08822a78528ae8032b67a" +
  "3fbc734ec36b5ec96270cf5784d44b98d83eaddc30c2df23d8e219ece51bfde725";

const table = Uint8Array.from({ length: 256 * 3 }, (_, n) => {
  const at = (Math.floor(n / 3) / 255) * 32, low = Math.min(Math.floor(at), 31);
  const part = (stop) => parseInt(stops.substr(6 * stop + 2 * (n % 3), 2), 16);
  return Math.round(part(low) + (at - low) * (part(low + 1) - part(low)));
});

/** Colours of the statuses by value; 0, outside the lattice, is not drawn. */
export const statusColours = ["#000000", "#0072b2", "#e69f00", "#999999", "#cc79a7", "#d55e00",
                              "#f0e442", "#56b4e9", "#009e73", "#5e4c2f"];

const grey = [136, 136, 136];

/** The red, green and blue of a value within the limits of a scale; grey for NaN. */
export function colourOf(value, [low, high]) {
  if (Number.isNaN(value)) return grey;
  const part = high > low ? (value - low) / (high - low) : 0.5;
  const index = 3 * Math.round(255 * Math.min(Math.max(part, 0), 1));
  return table.subarray(index, index + 3);
}

export function statusColour(status) {
  const colour = statusColours[status] ?? "#000000";
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
}

/** Limits of the values, [low, high]; of values without a number, [0, 1]. */
export function limitsOf(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists)
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  return low <= high && Number.isFinite(high) ? [low, high] : [0, 1];
}

/** Round numbers within [low, high], about `count` of them. */
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  if (!(rough > 0) || !Number.isFinite(rough)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough);
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}
