/** The verdict: what it names on an axis leads there. */

import { make } from "./dom.js";
import { titleOf } from "./names.js";
import { number, percent, torqueScale } from "./numbers.js";
import { sentence, wordsOfPart } from "./said.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Stretch} Stretch */
/** @typedef {import("./said.js").Part} Part */
/**
 * @typedef {{place: (place: Stretch) => void, effect: (effect: string) => void, error: () => void, findings: () => void,
 *   add: (effect: string) => void, every: () => void, apart: (effects: string[]) => void, laws: () => void}} To where its words lead
 * @typedef {{words: string, title: string, go: () => void, kind?: string}} Lead words that lead somewhere
 */

/**
 * Show a verdict; it is announced only where its words have changed.
 * @param {HTMLElement} element
 * @param {Pick<State, "added" | "concluded" | "verdict" | "candidates" | "titles" | "sets" | "proposed">} told
 * @param {import("./said.js").About} about
 * @param {To} to
 */
export function showVerdict(element, { added, concluded, verdict, candidates, titles, sets, proposed }, about, to) {
  const key = JSON.stringify([added, concluded, verdict, candidates, about, titles, sets, proposed]);
  if (element.dataset.told === key) return;
  element.dataset.told = key;
  const worst = [...concluded, ...verdict].find((part) => typeof part === "object" && "low" in part);
  const place = /** @type {Stretch | undefined} */ (worst);
  const shown = (/** @type {Part} */ part) => {
    const [words, leads] = [wordsOfPart(part, about), leadOf(part, place, candidates, to)];
    return leads ? link({ words, ...leads }) : words;
  };
  // Where a search has come to its end, that is what is said.
  const open = concluded.length > 0 ? [] : plainly(candidates, about, to);
  const first = open.map((part) => (typeof part === "string" ? part : link(part)));
  const ways = further({ sets, proposed }, about, to).map((part) => (typeof part === "string" ? part : link(part)));
  const head = beside(added, [...first, ...concluded.map(shown)]);
  element.replaceChildren(...(head.length > 0 ? [make("strong", {}, ...head), ...ways, " "] : []), ...verdict.map(shown));
}

/**
 * A headline that says what the model has by now, where it does not name that anyway.
 * @template {string | Node} T
 * @param {string[]} added
 * @param {T[]} head
 */
export function beside(added, [first, ...rest]) {
  if (first === undefined) return [];
  if (added.length === 0) return [first, ...rest];
  const names = added.map(titleOf);
  const all = names.length > 1 ? `${names.slice(0, -1).join(", ")} and ${names.at(-1)}` : names[0];
  const begun = typeof first === "string" ? `${first.slice(0, 1).toLowerCase()}${first.slice(1)}` : first;
  return [`With ${all} added, `, begun, ...rest];
}

/**
 * Where a part of a verdict leads: to samples, to what could be missing, to the error, to what was found in the log.
 * @param {Part} part
 * @param {Stretch | undefined} place where the model fails most
 * @param {State["candidates"]} candidates
 * @param {To} to
 * @returns {Omit<Lead, "words"> | null}
 */
function leadOf(part, place, { rows }, to) {
  if (typeof part === "string") return null;
  if ("low" in part) return { kind: "place", title: "show its samples in every plot", go: () => to.place(part) };
  if ("along" in part && place && part.along === place.axis) return { title: "draw a row over it", go: () => to.place(place) };
  if ("effect" in part && rows.some(({ effect }) => effect === part.effect)) return towards(part.effect, to);
  if (!("topic" in part)) return null;
  return part.topic === "error"
    ? { title: "the ladder of errors", go: to.error }
    : { title: "why: what was found in the log", go: to.findings };
}

/** To what an effect would explain. @param {string} effect @param {To} to */
function towards(effect, to) {
  return { title: `what it would explain (${effect})`, go: () => to.effect(effect) };
}

/** Text that leads, which breaks where a line ends as text does. @param {Lead} lead */
function link({ words, title, go, kind = "" }) {
  const click = (/** @type {Event} */ event) => {
    event.preventDefault();
    go();
  };
  return make("a", { class: `leads ${kind}`.trim(), href: "#plots", title, text: words, on: { click } });
}

/**
 * What a verdict comes to, in words for who knows no name of the catalogue, and what to do next; nothing where
 * nothing could be missing.
 * @param {State["candidates"]} candidates
 * @param {import("./said.js").About} about
 * @param {To} to
 * @returns {(string | Lead)[]}
 */
export function plainly({ ready, rows }, about, to) {
  const first = ready ? rows.find(({ could_be: could }) => could) : undefined;
  if (!first) return [];
  const { effect, name, error_fall: fall, equivalent, unsettled } = first;
  const said = sentence(first.said, about);
  const lead = (/** @type {string} */ one) => ({ words: titleOf(one), ...towards(one, to) });
  return [
    `${said.slice(0, 1).toUpperCase()}${said.slice(1)}: ${name} (`,
    lead(effect),
    `), which takes ${percent(fall)} off the error. `,
    ...(unsettled ? [`But ${unsettled}. `] : []),
    { words: "Add it", title: "take it into the model, and fit it", go: () => to.add(effect) },
    unsettled ? " to see what is left, not for its values; or " : ", and see what is left; or ",
    { words: "find everything", title: "add step by step all that is missing, sets of effects too", go: () => to.every() },
    " at once.",
    ...(equivalent.length > 0 ? tied(first.word === "part", equivalent.map(lead), () => to.apart([effect, ...equivalent])) : []),
  ];
}

/**
 * What can still be done where no effect that was weighed alone explains what is left: sets of them, or a formula.
 * @param {Pick<State, "sets" | "proposed">} state
 * @param {import("./said.js").About} about
 * @param {Pick<To, "every" | "laws">} to
 * @returns {(string | Lead)[]}
 */
export function further({ sets, proposed }, about, to) {
  const law = proposed?.[0];
  const { factor, unit } = torqueScale(about);
  const [left, of] = law ? [law.rmse, law.rmse / (1 - law.fall)].map((one) => number(one * factor)) : [];
  return [
    ...(law ? [" ", { words: "A formula", title: "what is left as a curve, and the laws that draw it", go: () => to.laws() }, ` is proposed: it would leave ${left}\u00a0${unit} of the ${of}\u00a0${unit} that it was looked for in.`] : []),
    ...(sets ? [" Effects were weighed one at a time: ", { words: "find everything", title: "add step by step all that is missing, sets of effects too", go: () => to.every() }, " weighs sets of them too."] : []),
  ];
}

/**
 * That others look the same, and what then is to be done: told apart while something else is missing as well, they may
 * be told wrongly. Of a part of what is missing others may be the rest.
 * @param {boolean} part
 * @param {Lead[]} others
 * @param {() => void} go
 * @returns {(string | Lead)[]}
 */
function tied(part, others, go) {
  const tell = { words: "Tell apart", title: "design the motion that would tell", go };
  const between = (/** @type {number} */ at) => (at === 0 ? [] : [at === others.length - 1 ? " or " : ", "]);
  const named = others.flatMap((one, at) => [...between(at), one]);
  return [part ? " Instead of it, or beside it, it could be " : " This motion looks the same with ", ...named, ": once nothing else is missing, ", tell, " designs what to record next."];
}
