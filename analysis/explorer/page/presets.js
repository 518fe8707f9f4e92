// The scenes that the page offers.

import { readJob } from "./jobfile.js";

/** The keys of a job in one text, the same for the same job. */
function textOf(job) {
  return JSON.stringify(Object.entries(job).filter(([, value]) => value !== "").sort());
}

export class Presets {
  /** @param texts texts of job files by name */
  constructor(texts, core) {
    this.names = new Map([[textOf({}), "paper"]]); // all keys have their defaults
    for (const [name, text] of Object.entries(texts)) this.names.set(textOf(readJob(text, texts, core).job), name);
  }

  /** The name of the preset that a job is, or "". */
  nameOf(job) {
    return this.names.get(textOf(job)) ?? "";
  }
}
