// The quantities that planes and readouts show, in the units in which people read them.

/** Fields in the order of the readouts, with the unit shown and its factor. */
export const quantities = [
  { field: "speed", label: "speed", unit: "m/s", digits: 10, searched: true },
  { field: "range", label: "range", unit: "m", searched: true },
  { field: "efficiency", label: "efficiency", unit: "%", factor: 100, searched: true },
  { field: "kinetic-energy", label: "kinetic energy", unit: "kJ", factor: 1e-3, searched: true },
  { field: "release-time", label: "release time", unit: "s" },
  { field: "lift-off-time", label: "lift-off time", unit: "s", if: (scene) => scene["scene.trough"] > 0 },
  { field: "arm-rate", label: "arm's rate w1", unit: "rad/s" },
  { field: "sling-angle", label: "sling angle phi2", unit: "rad" },
  { field: "sling-rate", label: "sling's rate w2", unit: "rad/s" },
  { field: "arm-angle", label: "arm angle phi1", unit: "rad" },
  { field: "pin-angle", label: "pin angle phi1 - phi2", unit: "rad" },
  { field: "flight-time", label: "flight time", unit: "s", searched: true },
  { field: "impact-speed", label: "impact speed", unit: "m/s", searched: true },
  { field: "apex", label: "apex", unit: "m", searched: true },
  { field: "peak-axle-load", label: "peak axle load", unit: "kN", factor: 1e-3 },
  { field: "peak-sling-tension", label: "peak sling tension", unit: "kN", factor: 1e-3 },
  { field: "least-sling-tension", label: "least sling tension", unit: "kN", factor: 1e-3 },
  { field: "peak-hanger-tension", label: "peak hanger tension", unit: "kN", factor: 1e-3,
    if: (scene) => scene["scene.counterweight-hanger"] > 0 },
  { field: "peak-beam-stress", label: "peak beam stress", unit: "MPa", factor: 1e-6,
    if: (scene) => (scene["scene.beam-mass"] === undefined
      ? scene["scene.beam-side"] !== 0 || scene["scene.beam-width"] !== undefined
      : scene["scene.beam-section-modulus"] !== undefined) },
  { field: "energy-drift", label: "energy drift", unit: "", digits: 2 },
  { field: "status", label: "status", unit: "", categories: true },
];

export const quantityOf = new Map(quantities.map((quantity) => [quantity.field, quantity]));

/** The name of a quantity with its unit. */
export function titleOf({ label, unit }) {
  return unit ? `${label} (${unit})` : label;
}

/** Whether a scene has a quantity, as in src/job/rules.cpp; `numbers` are those of the core. */
export function has(quantity, numbers) {
  return quantity.if?.(numbers) ?? true;
}

/** A value in the unit shown, as text. */
export function valueText(quantity, value, digits = quantity.digits ?? 6) {
  if (value === undefined || Number.isNaN(value)) return "–";
  return Number((value * (quantity.factor ?? 1)).toPrecision(digits)).toString();
}
