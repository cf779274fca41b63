/** What captures could not tell, and what is to be done before a motion is designed for it. */

import { make } from "./dom.js";
import { listed } from "./names.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {{apart: (effects: string[]) => void, bounds: (effects: string[]) => void}} Apart */

/**
 * What is to be done before a motion is designed, or recorded in its place: for a model that lacks something it would
 * only make known better what is wrong. Nothing where captures could not tell effects apart.
 * @param {State} state
 */
export function insteadOf({ candidates, record, untold }) {
  if (untold.length > 0) return "";
  if (candidates.rows.some(({ could_be: could }) => could)) return "What to record next: that is known once what is missing is in the model.";
  return record ? `What to record next, to see what it is: ${record}.` : "";
}

/**
 * The effects that a motion is to tell apart while something is missing: what is weighed first, and those that look the
 * same; none where nothing looks like it.
 * @param {Pick<State, "candidates" | "untold">} state
 * @returns {string[]}
 */
export function alikeOf({ candidates, untold }) {
  const first = untold.length > 0 ? undefined : candidates.rows.find(({ could_be: could }) => could);
  return first && first.equivalent.length > 0 ? [first.effect, ...first.equivalent] : [];
}

/**
 * The buttons beside effects that captures cannot tell apart: the motion that would, and its limits.
 * @param {string[]} effects
 * @param {Apart} deeds
 * @param {string} [whose] of several beside each other
 */
export function apartButtons(effects, { apart, bounds }, whose = "") {
  const button = (/** @type {string} */ text, /** @type {string} */ title, /** @type {(effects: string[]) => void} */ go) =>
    make("button", { type: "button", text, title, "aria-label": `${text} ${whose}`.trim(), on: { click: () => go(effects) } });
  return [
    button("Tell apart…", "design the motion that would tell", apart),
    " ",
    button("Limits…", "the limits of your rig, within which it is designed", bounds),
  ];
}

/**
 * Say what captures could not tell of what came in, with a button for each.
 * @param {HTMLElement} place
 * @param {State} state
 * @param {Apart} deeds
 */
export function showUntold(place, { untold }, deeds) {
  const rows = untold.map((effects) =>
    make(
      "li",
      {},
      ...listed([effects[0]], ""),
      " came in; these captures cannot tell it from ",
      ...listed(effects.slice(1), ", "),
      ". ",
      ...apartButtons(effects, deeds),
    ),
  );
  place.replaceChildren(...rows);
}
