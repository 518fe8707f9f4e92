// The scenes that the page offers: the presets, and the files that it has opened.

import { readJob } from "./jobfile.js";

/** The keys of a job in one text, the same for the same job. */
function textOf(job) {
  return JSON.stringify(Object.entries(job).filter(([, value]) => value !== "").sort());
}

export class Presets {
  /** @param scenes texts of job files by name, to which other files may refer; `list`: their HTML element */
  constructor(scenes, core, list) {
    Object.assign(this, { scenes, core, list, texts: {} });
    this.names = new Map([[textOf({}), "paper"]]); // all keys have their defaults
    for (const name of Object.keys(scenes).sort()) this.add(name, scenes[name]);
  }

  /** Adds a job file to the list. */
  add(name, text) {
    const job = textOf(readJob(text, this.scenes, this.core).job);
    if (!this.names.has(job)) this.names.set(job, name);
    if (!this.has(name)) this.list.append(new Option(name, name));
    this.texts[name] = text;
  }

  has(name) {
    return Object.hasOwn(this.texts, name);
  }

  /** The name of the first scene of the list that a job is, or "". */
  nameOf(job) {
    return this.names.get(textOf(job)) ?? "";
  }
}
