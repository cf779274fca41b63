/** The verdict: what it names on an axis leads there. */

import { make } from "./dom.js";
import { number, percent, torqueScale, unitWords } from "./numbers.js";

/** @typedef {import("./types.js").Place} Place */
/** @typedef {import("./types.js").State} State */

/** @typedef {{words: string, class: string, title: string, go: () => void}} Lead words of a verdict that lead somewhere */

/**
 * Show a verdict; it is announced only where its words have changed.
 * @param {HTMLElement} element
 * @param {Pick<State, "verdict_text" | "places" | "candidates" | "unit" | "peak">} told
 * @param {{place: (place: Place) => void, effect: (effect: string) => void, error: () => void, findings: () => void,
 *   add: (effect: string) => void, apart: (effects: string[]) => void}} to
 */
export function showVerdict(element, { verdict_text, places: named, candidates, unit, peak }, to) {
  const eyed = (/** @type {string} */ words) => forTheEye(words, { unit, peak });
  const first = eyed(plainly(candidates));
  const [text, places] = [eyed(verdict_text), named.map((place) => ({ ...place, words: eyed(place.words) }))];
  const key = JSON.stringify([first, text, places, candidates.rows.map(({ effect }) => effect)]);
  if (element.dataset.told === key) return;
  element.dataset.told = key;
  const leads = leadsOf(places, candidates, to);
  const shown = (/** @type {string} */ said) => parted(said, leads).map((part) => (typeof part === "string" ? part : link(part)));
  element.replaceChildren(...(first ? [make("strong", {}, ...shown(first)), " "] : []), ...shown(text));
}

/**
 * Where the words of a verdict lead: to samples, to what could be missing, to the error, to what was found in the log.
 * @param {Place[]} places
 * @param {State["candidates"]} candidates
 * @param {Parameters<typeof showVerdict>[2]} to
 * @returns {Lead[]}
 */
function leadsOf(places, { rows }, to) {
  const lead = (/** @type {string} */ words, /** @type {string} */ title, /** @type {() => void} */ go, kind = "") =>
    ({ words, title, go, class: `leads ${kind}`.trim() });
  const first = rows.find(({ could_be: could }) => could);
  return [
    ...places.map((place) => lead(place.words, "show its samples in every plot", () => to.place(place), "place")),
    ...places.map((place) => lead(`along ${place.axis}`, "draw a row over it", () => to.place(place))),
    ...rows.map(({ effect }) => lead(effect, "what it would explain", () => to.effect(effect))),
    ...(first
      ? [
          lead("Add it", "take it into the model, and fit it", () => to.add(first.effect)),
          lead("Tell apart", "design the motion that would tell", () => to.apart([first.effect, ...first.equivalent])),
        ]
      : []),
    lead("RMS error", "the ladder of errors", to.error),
    lead("Not weighed", "why: what was found in the log", to.findings),
  ];
}

/** Text that leads, which breaks where a line ends as text does. @param {Lead} lead */
function link({ words, title, go, ...rest }) {
  const click = (/** @type {Event} */ event) => {
    event.preventDefault();
    go();
  };
  return make("a", { ...rest, href: "#plots", title, text: words, on: { click } });
}

/**
 * What a verdict comes to, in words for who knows no name of the catalogue, and what to do next; nothing where
 * nothing could be missing.
 * @param {State["candidates"]} candidates
 */
export function plainly({ ready, rows }) {
  const first = ready ? rows.find(({ could_be: could }) => could) : undefined;
  if (!first) return "";
  const said = `${first.said.slice(0, 1).toUpperCase()}${first.said.slice(1)}`;
  // What is told apart while something else is missing as well may be told wrongly.
  const tied = `This motion looks the same with ${first.equivalent.join(" or ")}: once nothing else is missing, Tell apart designs what to record next.`;
  const next = `Add it, and see what is left.${first.equivalent.length > 0 ? ` ${tied}` : ""}`;
  return `${said}: ${first.name} (${first.effect}), which takes ${percent(first.error_fall)} off the error. ${next}`;
}

/**
 * Words of the program as the page has its numbers: torques in the unit of the plots, a true minus, no line that ends before %.
 * @param {string} words
 * @param {Pick<State, "unit" | "peak">} about
 */
export function forTheEye(words, about) {
  const scale = torqueScale(about);
  const own = scale.factor === 1
    ? words
    : words.replace(/(-?\d[\d.]*(?:e[-+]?\d+)?) N m(?![ /]?(?:s|rad)\b)/g, (_, value) => `${number(Number(value) * scale.factor)} ${scale.unit}`);
  return unitWords(own.replace(/(^|[\s(])-(?=\d)/g, "$1−").replace(/ (?=%)/g, "\u00a0"));
}

/**
 * A text, taken apart into the words that lead somewhere and what stands between them: of each the last that stands alone.
 * @template {{words: string}} L
 * @param {string} text
 * @param {L[]} leads
 * @returns {(string | L)[]}
 */
export function parted(text, leads) {
  const [first, ...others] = leads;
  if (!first) return text === "" ? [] : [text];
  const at = lastOf(text, first.words);
  if (at < 0) return parted(text, others);
  const [before, after] = [text.slice(0, at), text.slice(at + first.words.length)];
  return [...parted(before, others), first, ...parted(after, others)];
}

/** Where words stand last in a text that are no part of others; -1 where they do not. @param {string} text @param {string} words */
function lastOf(text, words) {
  const part = /\w/;
  for (let at = words === "" ? -1 : text.lastIndexOf(words); at >= 0; at = at === 0 ? -1 : text.lastIndexOf(words, at - 1)) {
    if (!part.test(text[at - 1] ?? " ") && !part.test(text[at + words.length] ?? " ")) return at;
  }
  return -1;
}
