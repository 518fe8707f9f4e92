// Mistakes of the user.

/** A mistake in the value of a key. */
export class InputError extends Error {
  constructor(key, message) {
    super(message);
    this.key = key;
  }
}

/** A user's text for a message, truncated to 200 characters. */
export function shortened(text) {
  return text.length <= 200 ? text : `${text.slice(0, 200)}...`;
}

/** Rejects the value of a key: "key = value: must be allowed". */
export function refuse(key, value, allowed) {
  throw new InputError(key, `${key} = ${shortened(value)}: must be ${allowed}`);
}
