/** What captures could not tell, and what is to be done before a motion is designed for it. */

import { make } from "./dom.js";
import { listed, titleOf } from "./names.js";

/** @typedef {import("./types.js").State} State */

/**
 * Whether it is known what to record next: what could be missing is weighed, or a search has come to its end, after
 * which the rest is weighed for minutes.
 * @param {Pick<State, "candidates" | "concluded" | "node">} state
 */
export function tellsNext({ candidates, concluded, node }) {
  return node !== null && (candidates.ready || concluded.length > 0);
}

/**
 * What is to be done before a motion is designed, or recorded in its place: for a model that lacks something it would
 * only make known better what is wrong. Nothing where captures could not tell effects apart.
 * @param {Pick<State, "candidates" | "record" | "shown_along" | "untold">} state
 */
export function insteadOf({ candidates, record, shown_along: along, untold }) {
  if (untold.length > 0 && along === null) return "";
  if (candidates.rows.some(({ could_be: could }) => could)) return "What to record next is known once what is missing is in the model.";
  return record ? `What to record next, to see what it is: ${record}.` : "";
}

/**
 * What a motion would be for that nobody has asked for yet, within limits that are looked at.
 * @param {Pick<State, "candidates" | "record" | "shown_along" | "untold">} state
 */
export function purposeOf(state) {
  const known = "For the motion after which that is known better which is known least.";
  return insteadOf(state) || (state.untold.length > 0 ? "For the motion that tells apart what these captures cannot." : known);
}

/**
 * Whether no motion is for what is to be done first: while something is missing, or where it takes something else than a
 * motion within limits, as a finer sensor.
 * @param {Pick<State, "candidates" | "record" | "untold" | "shown_along">} state
 */
export function waitsFor(state) {
  return insteadOf(state) !== "" && state.shown_along === null;
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
 * Say what captures could not tell of what came in, and what of it is needless by now, with a button for each.
 * @param {HTMLElement} place
 * @param {State} state
 * @param {(effects: string[]) => void} apart
 * @param {(effect: string) => void} drop
 */
export function showUntold(place, { untold, needless, active }, apart, drop) {
  const these = active.length === 1 ? "this capture" : "these captures";
  const rows = untold.map((effects) =>
    make(
      "li",
      {},
      ...listed([effects[0]], ""),
      ` came in; ${these} cannot tell it from `,
      ...listed(effects.slice(1), ", "),
      ". ",
      apartButton(effects, apart),
    ),
  );
  const out = needless.map((effect) => {
    const click = () => drop(effect);
    const button = make("button", { type: "button", text: "Take it out", "aria-label": `Take out ${titleOf(effect)}`, on: { click } });
    return make("li", {}, ...listed([effect], ""), " is needless by now: what came in since does the same. ", button);
  });
  place.replaceChildren(...rows, ...out);
}
