// The page: its state, and what follows from it. A change of the state checks the job, asks the
// workers for what depends on it, and draws in the next frame.

import { Animation } from "./animation.js";
import { BestDesigns } from "./best_designs.js";
import { limitsOf, statusColours } from "./colours.js";
import { Controls } from "./controls.js";
import { DesignFields } from "./design_fields.js";
import { copy, listenForFiles } from "./files.js";
import { inflated } from "./inflated.js";
import { InputError } from "./input_error.js";
import { firstDesign, fromFragment, ignoredKeys, jobText, readJob, suggestedDesign, toFragment } from "./jobfile.js";
import { keys } from "./keys.js";
import { machineOf } from "./machine.js";
import { drawScale, PlaneView } from "./plane.js";
import { Pool } from "./pool.js";
import { has, quantities, quantityOf } from "./quantities.js";
import { showHeadline, showReadouts } from "./readouts.js";
import { Presets } from "./presets.js";
import { checkedJob, mended } from "./rules.js";
import { axes, clamped, edgeText, isInside, moved, outsideText, planes } from "./space.js";
import { StoredPlanes } from "./stored.js";

const data = JSON.parse(document.getElementById("data").textContent);
const at = (id) => document.getElementById(id);

const planeTolerance = 1e-7;

/**
 * `field`: the quantity chosen, and `aim`, the last one of which the best designs are searched for: of loads and
 * rates, the largest is no aim. `origin`: the preset or file from which the job comes.
 */
const state = {
  job: {}, design: firstDesign, field: "speed", aim: "speed", locked: null, pinned: null, origin: "paper",
};
/** Known from the core, once it has started. */
let core = null;
/** The last job without mistakes: its texts, values, box and unused keys. */
let valid = null;
let live = null, pinned = null;
let pool, presets, views, controls, designFields, animation, stored, best;

/** Asks for what depends on the state; called after each change. */
function update(change) {
  Object.assign(state, change);
  if (change.job) showOrigin();
  if (change.design) best.isAwaited = false;
  let mistake = null, left = [];
  try {
    // An output of a hanger, for example, without a hanger: the page has no field in which to mend it.
    const { job, checked, mistakes } = mended(state.job, core, (key) => !keys.some(({ name }) => name === key));
    valid = { ...checked, job };
    left = mistakes;
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    mistake = error;
  }
  at("planes").dataset.lattice = JSON.stringify(axes.map((axis) => valid.box[axis]));
  controls.show(state.job, valid);
  controls.report(mistake);
  at("left").textContent = left.length ? `Left out of the job: ${left.join("; ")}` : "";
  at("mistake").hidden = mistake === null;
  at("mistake.text").textContent = mistake?.message ?? "";
  at("mistake.show").onclick = () => at(mistake.key).focus();
  if (quantityOf.get(shownField()).searched) state.aim = shownField();
  ask();
  remember();
  redraw();
}

/** The quantity that the planes show: the one chosen, if the scene has it. */
function shownField() {
  return has(quantityOf.get(state.field), valid.numbers) ? state.field : "speed";
}

/** A change by the user, who has read the last notice. */
function edit(change) {
  notice("");
  update(change);
}

/** Names the preset or file from which the job comes, and whether it has changed since. */
function showOrigin() {
  at("own").textContent = presets.has(state.origin) ? `${state.origin}, changed` : state.origin;
  at("preset").value = presets.nameOf(state.job);
}

/**
 * Takes an edit of a key. A pin starts with the angle at which the design now releases, so that the
 * swing stays the same until that angle is moved.
 */
function editKey(name, text) {
  const job = { ...state.job, [name]: text };
  const angle = live?.trace.fields["pin-angle"];
  if (name === "solver.release" && text === "pin" && !job["solver.pin-angle"] && Number.isFinite(angle))
    job["solver.pin-angle"] = angle.toFixed(4);
  edit({ job });
}

/** Sends requests; those that have not changed since are left out. */
function ask() {
  const { numbers, box } = valid;
  const { design, aim } = state, field = shownField();
  pool.sendOther("trace", { numbers, design, planeTolerance });
  planes.forEach((plane, index) =>
    pool.sendPlane(index, { numbers, box, plane, field, tolerance: planeTolerance, at: design[plane.across] }));
  if (pool.sendOther("search", { numbers, box, field: aim })) best.take(null, quantityOf.get(aim));
  if (state.pinned) {
    const { numbers: others } = checkedJob(state.pinned.job, core);
    if (pool.sendOther("pinned", { numbers: others, design: state.pinned.design, planeTolerance })) pinned = null;
  }
}

/**
 * Takes an answer of a worker. While the mouse moves, planes and traces may be those of a position
 * that it has left; other answers are shown only if they are to the last request.
 */
function receive(answer) {
  if (answer.type === "ready") {
    if (!core) start(answer.core);
    return;
  }
  if (!answer.isCurrent && !["plane", "trace"].includes(answer.type)) return;
  if (answer.type === "plane") {
    views[answer.index].take(answer.picture);
    if (answer.isLast)
      at("cost").textContent = `${answer.designs} designs in ${answer.milliseconds.toFixed(0)} ms of computing.`;
  } else if (answer.type === "trace") live = answer;
  else if (answer.type === "pinned") pinned = answer.trace;
  else if (answer.type === "values") stored.takeLive(answer.values);
  else if (answer.type === "search") best.take(answer.maxima, quantityOf.get(state.aim), answer.progress);
  else if (answer.type === "offer") best.offer({ ...offered, value: answer.values[0] });
  else if (answer.type === "failed") fail(answer);
  if (valid && !pool.isBusy) offerShown();
  redraw();
}

let offered = null;
/** Checks the best design on the page, if it is better than those that the search has found. */
function offerShown() {
  const { box, numbers } = valid, { aim, design } = state;
  const shown = views.map((view) => view.highest(aim, design)).filter((trial) => trial);
  if (live && isInside(box, live.trace.design))
    shown.push({ design: live.trace.design, value: live.trace.fields[aim] });
  const [trial] = shown.filter(({ value }) => best.isMissed(value)).sort((a, b) => b.value - a.value);
  if (!trial) return;
  offered = trial;
  pool.sendOther("offer", { numbers, field: aim, designs: axes.map((axis) => trial.design[axis]) });
}

/** Shows that a computation failed, and no longer what it would have replaced. */
function fail({ failed, index, message }) {
  notice(`The computation failed: ${failed ?? "a worker"}: ${message}`, true);
  if (failed === "plane") views[index].take(null);
  if (failed === "trace") live = null;
  if (failed === "values") at("stored.values").replaceChildren();
  if (failed === "search") best.take([], quantityOf.get(state.aim));
}

let isWaiting = false;
function redraw() {
  document.querySelector("main").ariaBusy = "true";
  if (isWaiting) return;
  isWaiting = true;
  requestAnimationFrame(() => {
    isWaiting = false;
    draw();
    document.querySelector("main").ariaBusy = String(pool.isBusy);
  });
}

function draw() {
  if (!valid) return;
  const { box, numbers } = valid;
  const { design } = state, field = shownField();
  const quantity = quantityOf.get(field);
  const shown = views.filter(({ data: picture }) => picture && picture.field === field);
  const limits = (field === state.field && state.locked) ||
    limitsOf([...shown.map(({ data: picture }) => picture.values), ...stored.values(field)]);
  views.forEach((view) => view.draw({ box, design, field, limits, optimum: best.design,
                                      pinned: state.pinned?.design }));
  stored.draw({ design, field, limits, pool });
  at("scale").hidden = field === "status";
  at("legend").hidden = field !== "status";
  if (field !== "status") {
    drawScale(at("scale"), limits, quantity);
    at("scale").dataset.limits = limits.join(" ");
  }
  const edge = best.design && !best.isSearching ? edgeText(box, best.design) : "";
  at("edge").textContent = edge && `The best design found is on the edge of the lattice: ${edge}.`;
  designFields.show(design, box);
  const outside = outsideText(box, design);
  at("outside").textContent = outside && `Outside the lattice: ${outside}.`;
  at("lock").checked = state.locked !== null;
  at("lock").disabled = field === "status";
  at("field").value = field;
  for (const option of at("field").options) option.disabled = !has(quantityOf.get(option.value), numbers);
  at("pin").textContent = state.pinned ? "Unpin" : "Pin this design";
  planes.forEach(({ across }, i) => { at(`caption.${i}`).textContent = `${across} = ${design[across]} m`; });
  drawSwing(numbers);
}

/** Shows the swing of the design, and that of the pinned one. */
function drawSwing(numbers) {
  for (const name of ["headline", "reason", "readouts", "errors"]) at(name).hidden = !live;
  const others = state.pinned && pinned && checkedJob(state.pinned.job, core);
  animation.show([live && { ...live.trace, scene: machineOf(valid) },
                  others && { ...pinned, scene: machineOf(others) }]);
  if (!live) return;
  showHeadline(live.trace, core);
  showReadouts(at("readouts"), live, numbers, others && { trace: pinned, numbers: others.numbers }, core);
}

function notice(text, isWrong = false) {
  at("notice").textContent = text;
  at("notice").classList.toggle("wrong", isWrong);
}

/** What a job asks for and the page does not show, "" if nothing. */
function ignoredText(job, before = "") {
  const ignored = ignoredKeys(job);
  return ignored.length ? `${before}not used by the explorer: ${ignored.join("; ")}` : "";
}

/** Takes a job from a preset or a file. */
function load(text, name) {
  const { job, scene } = readJob(text, data.presets, core);
  const { box } = checkedJob(job, core); // before anything changes
  presets.add(name, text);
  const design = suggestedDesign(text) ?? state.design;
  const notes = [scene && `the first scene of a study, with ${scene}`, ignoredText(job)].filter((note) => note);
  notice(notes.length ? `${name}: ${notes.join("; ")}` : "");
  update({ job, design: clamped(box, design), locked: null, origin: name });
  if (!isInside(box, design)) best.await();
}

function tryToLoad(text, name) {
  try {
    load(text, name);
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    notice(`${name}: ${error.message}`, true);
  }
}

function copyJob() {
  copy(jobText(valid.job, valid.unused, state.design));
}

let memory = 0, lastMemory = -Infinity;
/** Writes the state to the address: at once, but at most a few times a second, since browsers limit the number. */
function remember() {
  clearTimeout(memory);
  memory = setTimeout(() => {
    lastMemory = performance.now();
    history.replaceState(null, "", `#${toFragment({ ...state, job: valid.job })}`);
  }, Math.max(0, lastMemory + 300 - performance.now()));
}

/** Takes the state of the address, without what is wrong in it. The address stays as it is until the next edit. */
function restore({ isGiven, mistakes: lengths, ...saved }) {
  const live = mended(saved.job, core), other = saved.pinned && mended(saved.pinned.job, core);
  update({ ...saved, job: live.job, field: quantityOf.has(saved.field) ? saved.field : "speed",
           pinned: other && { ...saved.pinned, job: other.job } });
  clearTimeout(memory);
  if (saved.field !== null && !quantityOf.has(saved.field)) lengths.push(`field = ${saved.field}: unknown quantity`);
  const mistakes = [...lengths, ...live.mistakes, ...(other?.mistakes.map((text) => `pinned: ${text}`) ?? [])];
  if (mistakes.length) notice(`The address of the page: ${mistakes.join("; ")}`, true);
  else notice(ignoredText(live.job, "In the address, "));
}

function listen() {
  at("preset").onchange = () => {
    const name = at("preset").value;
    tryToLoad(presets.texts[name], name);
  };
  at("copy").onclick = copyJob;
  at("pin").onclick = () => edit({
    pinned: state.pinned ? null : { job: { ...valid.job }, design: { ...state.design } } });
  at("field").onchange = () => edit({ field: at("field").value, locked: null });
  at("lock").onchange = () => update({
    locked: at("lock").checked ? at("scale").dataset.limits.split(" ").map(Number) : null });
  at("controls").onsubmit = (event) => event.preventDefault();
  window.addEventListener("resize", redraw);
  new ResizeObserver(redraw).observe(at("machine")); // its height depends on the rest of the page
  window.addEventListener("hashchange", () => restore(fromFragment(location.hash.slice(1))));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  matchMedia("print").addEventListener("change", draw); // at once: a printer does not wait for the next frame
  listenForFiles(tryToLoad, (message) => notice(message, true));
}

/** Shows the colours of the statuses. */
function showLegend() {
  at("legend").append(...core.statuses.map((name, status) => {
    const item = document.createElement("span"), colour = document.createElement("i");
    colour.style.background = statusColours[status];
    item.title = core.statusMeanings[status];
    item.append(colour, name.replaceAll("_", " "));
    return item;
  }).slice(1));
}

/** Builds the page, once the core has started. */
function start(ready) {
  core = ready;
  presets = new Presets(data.presets, core, at("preset"));
  const move = (part) => edit({ design: moved(valid.box, state.design, part(state.design)) });
  views = planes.map((plane, i) => new PlaneView(at(`plane.${i}`), plane, move));
  controls = new Controls(at("controls"), core, editKey);
  designFields = new DesignFields(at("design"), (design) => edit({ design: { ...state.design, ...design } }));
  animation = new Animation();
  best = new BestDesigns((design, isOwn) => (isOwn ? update : edit)({ design }));
  stored = new StoredPlanes(data.stored, core, move);
  at("field").append(...quantities.map(({ field, label }) => new Option(label, field)));
  showLegend();
  listen();
  const saved = fromFragment(location.hash.slice(1));
  if (stored.job) presets.add(stored.name, jobText(stored.job, new Map(), stored.design));
  if (stored.job && !saved.isGiven) {
    const { job, design, field, name } = stored;
    update({ job, design, field, origin: name });
    notice(ignoredText(job, `${name}: `));
  } else
    restore(saved);
}

async function begin() {
  for (const [i, plane] of planes.entries()) {
    const figure = document.createElement("figure");
    figure.innerHTML = `<canvas id="plane.${i}" tabindex="0" role="application" ` +
      `aria-roledescription="heat map"></canvas><figcaption id="caption.${i}">${plane.across}</figcaption>`;
    at("planes").append(figure);
  }
  const script = new Blob([at("worker").textContent], { type: "text/javascript" });
  for (const [axis, packed] of Object.entries(data.stored?.planes ?? {}))
    data.stored.planes[axis] = Float64Array.from(new Float32Array(await inflated(packed)));
  const module = await WebAssembly.compile(await inflated(data.module));
  pool = new Pool(URL.createObjectURL(script), module, receive);
}

begin().catch((error) => notice(`The explorer cannot start: ${error.message}`, true));
