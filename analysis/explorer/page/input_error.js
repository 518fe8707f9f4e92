// Mistakes of the user.

/** A mistake in the value of a key. */
export class InputError extends Error {
  constructor(key, message) {
    super(message);
    this.key = key;
  }
}

/** Rejects the value of a key: "key = value: must be allowed". */
export function refuse(key, value, allowed) {
  throw new InputError(key, `${key} = ${value}: must be ${allowed}`);
}
