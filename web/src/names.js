/** What effects and parameters are called: in words, with the id that the command line has as a tooltip. */

import { make } from "./dom.js";

/** @typedef {import("./types.js").Param} Param */

/** @type {Record<string, string>} of all effects of the catalogue, by their ids */
let titles = {};
/** @type {Record<string, string>} what the model's parameters are, by their names */
let meanings = {};

/**
 * Know what all is called; what came with one answer holds until the next.
 * @param {{titles: Record<string, string>, params?: Param[]}} told
 */
export function known({ titles: called, params = [] }) {
  titles = called;
  meanings = Object.fromEntries(params.map(({ name, meaning }) => [name, meaning]));
}

/** An effect in two or three words; one that is nowhere catalogued by its id. @param {string} effect */
export function titleOf(effect) {
  return titles[effect] ?? effect;
}

/** A parameter in words: what it is, and of which effect. @param {string} name `effect.parameter` */
export function paramOf(name) {
  const [effect, ...own] = name.split(".");
  const [words] = (meanings[name] || own.join(".")).split(", "); // what is more about it stands in the table
  const title = titleOf(effect);
  return words.includes(title) ? words : `${words} (${title})`;
}

/** Words, with the id that they stand for. @param {string} words @param {string} id */
export function named(words, id) {
  return make("span", { text: words, title: words === id ? null : id });
}

/** Several effects in words, between these. @param {string[]} effects @param {string} between */
export function listed(effects, between) {
  return effects.flatMap((effect, at) => [at > 0 ? between : "", named(titleOf(effect), effect)]);
}

/** What came in on a step, what with it by itself, and what went. @param {Pick<import("./types.js").Step, "added" | "along" | "dropped">} step */
export function changeOf({ added, along, dropped }) {
  const came = added ? [`+ ${[titleOf(added), ...along.map(titleOf)].join(" with ")}`] : [];
  return [...came, ...dropped.map((one) => `− ${titleOf(one)}`)].join(" ");
}
