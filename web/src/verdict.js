/** The verdict: what it names on an axis leads there. */

import { make } from "./dom.js";

/** @typedef {import("./types.js").Place} Place */
/** @typedef {import("./types.js").State} State */

/**
 * Show a verdict; it is announced only where its words have changed.
 * @param {HTMLElement} element
 * @param {{verdict_text: string, places: Place[], candidates: State["candidates"]}} told
 * @param {(place: Place) => void} go
 */
export function showVerdict(element, { verdict_text: text, places, candidates }, go) {
  const first = plainly(candidates);
  const key = JSON.stringify([first, text, places]);
  if (element.dataset.told === key) return;
  element.dataset.told = key;
  element.replaceChildren(
    ...(first ? [make("strong", { text: first }), " "] : []),
    ...parted(text, places).map((part) =>
      typeof part === "string" ? part : make("button", { ...LEADS, text: part.words, on: { click: () => go(part) } }),
    ),
  );
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
  const next = first.equivalent.length > 0
    ? "This motion looks the same with other causes: Tell apart designs what to record next."
    : "Add it, and see what is left.";
  return `${said}: ${first.name} (${first.effect}). ${next}`;
}

const LEADS = { type: "button", class: "leads", title: "show its samples in every plot" };

/**
 * A text, taken apart into the places that it names and what stands between them.
 * @param {string} text
 * @param {Place[]} places
 * @returns {(string | Place)[]}
 */
export function parted(text, places) {
  const [first, ...others] = places;
  if (!first) return text === "" ? [] : [text];
  const at = text.lastIndexOf(first.words);
  if (first.words === "" || at < 0) return parted(text, others);
  const [before, after] = [text.slice(0, at), text.slice(at + first.words.length)];
  return [...parted(before, others), first, ...parted(after, others)];
}
