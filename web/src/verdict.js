/** The verdict: what it names on an axis leads there. */

import { make } from "./dom.js";

/** @typedef {import("./types.js").Place} Place */

/**
 * Show a verdict; it is announced only where its words have changed.
 * @param {HTMLElement} element
 * @param {{verdict_text: string, places: Place[]}} told
 * @param {(place: Place) => void} go
 */
export function showVerdict(element, { verdict_text: text, places }, go) {
  const key = JSON.stringify([text, places]);
  if (element.dataset.told === key) return;
  element.dataset.told = key;
  element.replaceChildren(
    ...parted(text, places).map((part) =>
      typeof part === "string" ? part : make("button", { ...LEADS, text: part.words, on: { click: () => go(part) } }),
    ),
  );
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
