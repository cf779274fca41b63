/** What captures could not tell, and what is to be done before a motion is designed for it. */

import { make } from "./dom.js";
import { listed } from "./names.js";

/** @typedef {import("./types.js").State} State */

/**
 * What is to be done before a motion is designed, or recorded in its place: for a model that lacks something it would
 * only make known better what is wrong. Nothing where captures could not tell effects apart.
 * @param {State} state
 */
export function insteadOf({ candidates, record, untold }) {
  if (untold.length > 0) return "";
  if (candidates.rows.some(({ could_be: could }) => could)) return "What to record next is known once what is missing is in the model.";
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
 * The button that designs the motion which tells effects apart.
 * @param {string[]} effects
 * @param {(effects: string[]) => void} apart
 * @param {string} [whose] of several beside each other
 */
export function apartButton(effects, apart, whose = "") {
  const [text, label] = ["Tell apart…", `Tell apart… ${whose}`.trim()];
  return make("button", { type: "button", text, title: "design the motion that would tell", "aria-label": label, on: { click: () => apart(effects) } });
}

/**
 * The button that shows the limits of such a motion.
 * @param {string[]} effects
 * @param {(effects: string[]) => void} bounds
 * @param {string} whose
 */
export function boundsButton(effects, bounds, whose) {
  const title = "the limits of your rig, within which it is designed";
  return make("button", { type: "button", text: "Limits…", title, "aria-label": `Limits… ${whose}`, on: { click: () => bounds(effects) } });
}

/**
 * Say what captures could not tell of what came in, with a button for each.
 * @param {HTMLElement} place
 * @param {State} state
 * @param {(effects: string[]) => void} apart
 */
export function showUntold(place, { untold }, apart) {
  const rows = untold.map((effects) =>
    make(
      "li",
      {},
      ...listed([effects[0]], ""),
      " came in; these captures cannot tell it from ",
      ...listed(effects.slice(1), ", "),
      ". ",
      apartButton(effects, apart),
    ),
  );
  place.replaceChildren(...rows);
}
