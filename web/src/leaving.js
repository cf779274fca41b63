/** Samples that a person leaves out: the stretch of time that is brushed, or those that are chosen otherwise. */

import { byId } from "./dom.js";
import { number, thousands } from "./numbers.js";

/** @typedef {Record<string, [number, number][]>} Runs of samples, first and last of each, by the ids of captures */

const MOST = 1000; // runs at once of a capture
const REST_MS = 150; // for which nothing else was chosen: what a brush moves over is not counted on its way

/**
 * Keep the button that leaves out what is chosen.
 * @param {import("./linked.js").Linked} linked
 * @param {() => Pick<import("./types.js").State, "captures" | "active"> | null} state
 * @param {(runs: Runs) => unknown} leave
 * @returns {() => void} to be called where something else is chosen
 */
export function leaving(linked, state, leave) {
  const button = /** @type {HTMLButtonElement} */ (byId("leave-out"));
  const now = () => {
    const known = state();
    return known && linked.data && linked.chosen ? runsOf(linked.chosen, linked.data.columns.t, stretchOf(linked), known) : {};
  };
  button.addEventListener("click", () => {
    const runs = now();
    if (Object.keys(runs).length > 0) leave(runs);
  });
  const offer = () => {
    const runs = now();
    const every = Object.values(runs);
    button.hidden = every.length === 0;
    button.disabled = every.some((one) => one.length > MOST);
    button.textContent = linked.data ? words(every.flat(), linked.data) : "";
    button.title = button.disabled
      ? "too many single samples: brush a stretch of time"
      : "nothing is fitted to them any more, and the model is fitted anew; Undo takes them in again";
  };
  let rest = 0;
  return () => {
    clearTimeout(rest);
    if (!linked.chosen?.length) return offer(); // at once: there is nothing to count, and nothing to press any more
    rest = setTimeout(offer, REST_MS);
  };
}

/** From where to where time is brushed; null where the brush is over something else. @param {import("./linked.js").Linked} linked */
function stretchOf(linked) {
  const { brushed } = linked;
  return brushed && linked.axes[Math.floor(brushed.plot / 3)] === "time" ? brushed.x : null;
}

/**
 * What is to be left out of each capture: of a stretch of time all samples, whatever their torque is.
 * @param {Uint32Array} chosen
 * @param {Float32Array} t of all captures, one after the other
 * @param {[number, number] | null} stretch
 * @param {Pick<import("./types.js").State, "captures" | "active">} state
 * @returns {Runs}
 */
export function runsOf(chosen, t, stretch, { captures, active }) {
  /** @type {Runs} */
  const runs = {};
  const out = new Uint8Array(t.length);
  if (stretch) for (let i = 0; i < t.length; i++) out[i] = Number(t[i] >= stretch[0] && t[i] <= stretch[1]);
  else for (const at of chosen) out[at] = 1;
  let start = 0;
  for (const id of active) {
    const end = start + (captures.find((one) => one.id === id)?.samples ?? 0);
    for (let i = start; i < end; i++) {
      if (!out[i]) continue;
      const first = i;
      while (i + 1 < end && out[i + 1]) i++;
      (runs[id] ??= []).push([first - start, i - start]);
    }
    start = end;
  }
  return runs;
}

/** @param {[number, number][]} runs @param {import("./contents.js").Data} data */
function words(runs, { several, columns: { t } }) {
  if (runs.length > 1) return `Leave out ${thousands(runs.length)} stretches`;
  if (several || runs.length === 0) return "Leave these out"; // of several captures each has a time of its own
  const [from, to] = runs[0].map((at) => number(t[at], 4));
  return `Leave out ${from} to ${to} s`;
}
