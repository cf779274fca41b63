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
  if (candidates.rows.some(({ could_be: could }) => could)) return "What to record next: that is known once what is missing is in the model.";
  return record ? `What to record next, to see what it is: ${record}.` : "";
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
      make("button", { type: "button", text: "Tell apart…", on: { click: () => apart(effects) } }),
    ),
  );
  place.replaceChildren(...rows);
}
