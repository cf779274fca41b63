/** The linked plots in a notebook: a module as anywidget loads it. */

import { bitsOf, indicesOf } from "./bits.js";
import { make } from "./dom.js";
import { Look } from "./look.js";
import lookStyle from "./look.css";
import { notebookTheme, themeWatched } from "./notebook-theme.js";
import partsStyle from "./parts.css";
import plotsStyle from "./plots.css";
import { times } from "./timing.js";

/**
 * What is shared with Python, which several views may show. `chosen`: see bits.js; `looked`: the candidate that
 * is looked at, "" for none; `overlay`: what it would explain, which Python answers to `looked`.
 * @typedef {{head: string, floats: DataView, step: number, chosen: DataView, looked: string,
 *   overlay: {effect: string, step: number, floats: DataView} | {}}} Shared
 * @typedef {{get: <K extends keyof Shared>(name: K) => Shared[K],
 *   set: <K extends keyof Shared>(name: K, value: Shared[K]) => void, save_changes: () => void,
 *   on: (event: string, heard: () => void) => void, off: (event: string, heard: () => void) => void}} Model
 */

const BRUSH_MS = 100; // between two messages about what is chosen
const LOOK_MS = 60; // a pointer that only passes over a candidate asks for nothing
const MEASURED = ["t", "theta", "omega", "tau"];

/** @param {{model: Model, el: HTMLElement}} notebook */
function render({ model, el }) {
  /** @type {import("./types.js").Head} */
  const head = JSON.parse(model.get("head"));
  const floats = floatsOf(model.get("floats"));
  const column = (/** @type {number} */ at) => floats.subarray(at * head.n, (at + 1) * head.n);
  const measured = Object.fromEntries(MEASURED.map((name, at) => [name, column(at)]));
  const residuals = head.steps.map((_, at) => column(MEASURED.length + at));
  const share = (/** @type {Partial<Shared>} */ state) => {
    for (const [name, value] of Object.entries(state)) model.set(/** @type {keyof Shared} */ (name), value);
    model.save_changes();
  };

  const telling = spaced(BRUSH_MS);
  const looking = spaced(LOOK_MS);
  let chosen = bytesOf(model.get("chosen")); // what this view shows
  const look = new Look(head, measured, residuals, {
    step: (step) => share({ step, looked: "" }),
    look: (effect) => looking(() => share({ looked: effect ?? "" })),
    chosen: () => telling(tell),
  });
  function tell() {
    const bits = bitsOf(look.linked.chosen, head.n);
    if (same(bits, chosen)) return;
    chosen = bits;
    share({ chosen: new DataView(bits.buffer) });
  }
  const heard = {
    "change:step": () => {
      look.show(model.get("step"));
      lay();
    },
    "change:chosen": () => {
      const bits = bytesOf(model.get("chosen"));
      if (same(bits, chosen)) return;
      chosen = bits;
      look.linked.choose(indicesOf(bits));
    },
    "change:looked": lay,
    "change:overlay": lay,
  };
  function lay() {
    const overlay = model.get("overlay");
    const fits = "effect" in overlay && overlay.effect === model.get("looked") && overlay.step === model.get("step");
    look.overlay(fits ? overlay.effect : null, fits ? floatsOf(overlay.floats) : null);
  }

  for (const [event, hear] of Object.entries(heard)) model.on(event, hear);
  const leave = framed(el, look);
  look.linked.choose(indicesOf(chosen));
  heard["change:step"]();

  return () => {
    for (const [event, hear] of Object.entries(heard)) model.off(event, hear);
    for (const waiting of [telling, looking]) waiting(null);
    leave();
  };
}

/**
 * Put the plots into a root of their own, so that no style of the notebook comes in and none of these goes out.
 * @param {HTMLElement} el
 * @param {Look} look
 * @returns {() => void} what takes them away
 */
function framed(el, look) {
  const host = make("div", { "data-lm-suppress-shortcuts": "true" }); // the keys are the plots', not JupyterLab's
  const root = host.attachShadow({ mode: "open" });
  root.append(make("style", { text: plotsStyle + partsStyle + lookStyle }), look.element);
  Object.assign(host, { knobcam: { times, look } }); // for those who measure
  el.append(host);
  const paint = () => {
    const theme = notebookTheme();
    if (theme) host.dataset.theme = theme;
    else delete host.dataset.theme;
    requestAnimationFrame(() => look.linked.redraw()); // JupyterLab hides everything while it changes the theme
  };
  paint();
  const unwatch = themeWatched(paint);
  return () => {
    unwatch();
    look.linked.sized.disconnect();
    host.remove();
  };
}

/**
 * Make a function that does the newest of what it is given, `ms` later; null for nothing.
 * @param {number} ms
 * @returns {(work: (() => void) | null) => void}
 */
function spaced(ms) {
  /** @type {number | undefined} */
  let timer;
  /** @type {(() => void) | null} */
  let next = null;
  return (work) => {
    next = work;
    timer ??= window.setTimeout(() => {
      timer = undefined;
      next?.();
    }, ms);
  };
}

/** @param {DataView} view */
function bytesOf({ buffer, byteOffset, byteLength }) {
  return new Uint8Array(buffer, byteOffset, byteLength);
}

/** @param {DataView} view */
function floatsOf({ buffer, byteOffset, byteLength }) {
  const aligned = byteOffset % 4 === 0;
  return aligned
    ? new Float32Array(buffer, byteOffset, byteLength / 4)
    : new Float32Array(buffer.slice(byteOffset, byteOffset + byteLength));
}

/** @param {Uint8Array} one @param {Uint8Array} other */
function same(one, other) {
  return one.length === other.length && one.every((byte, at) => byte === other[at]);
}

export default { render };
