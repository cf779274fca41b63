/** Sentences of the program: words, and what stands in them as this page writes it, in its units and by its names. */

import { axisWord } from "./contents.js";
import { named, paramOf, titleOf } from "./names.js";
import { motionWords, number, scaleOf, torqueWord, unitWords } from "./numbers.js";

/** @typedef {import("./types.js").Stretch} Stretch */
/** @typedef {import("./types.js").Finding["said"][number]} Part */
/** @typedef {{unit: string, peak: number, coordinate: "rotary" | "linear"}} About the captures that a sentence is of */

/**
 * What the sentences of a session are about: the captures that are shown, and no others that are open.
 * @param {Pick<import("./types.js").State, "unit" | "peak" | "captures" | "active">} state
 * @returns {About}
 */
export function aboutOf({ unit, peak, captures, active }) {
  return { unit, peak, coordinate: captures.find(({ id }) => active.includes(id))?.coordinate ?? "rotary" };
}

const DIRECTIONS = new Map([[1, " forward"], [-1, " backward"]]);
const AGAIN = "open the file once more and";
/** What advice comes to here, where there are buttons. @type {Record<string, string>} */
const WAYS = {
  columns: `if a column is something else, ${AGAIN} say which is which`,
  unit: `if it is in another unit, ${AGAIN} choose that`,
  minus: `${AGAIN} write a minus before that column`,
  unwrap: `if the angle wraps around, ${AGAIN} write unwrap(…) around that column`,
  parts: "if the log was joined, open its parts as files of their own",
  drive: "if that is the drive's limit, switch it off",
  command: "",
};

/**
 * A part of a sentence as text.
 * @param {Part} part
 * @param {About} about
 */
export function wordsOfPart(part, about) {
  if (typeof part === "string") return part.replaceAll(/(?<=^|[\s(])-(?=\d)/g, "−").replaceAll("<=", "≤");
  if ("text" in part) return measured(part, about);
  if ("low" in part) return stretch(part, about);
  if ("along" in part) return axisWord(part.along, about.unit);
  if ("effect" in part) return titleOf(part.effect);
  if ("param" in part) return paramOf(part.param);
  if ("column" in part) return columnWord(part.column, about);
  if ("topic" in part) return part.words;
  return adviceOf(part);
}

/**
 * A sentence as text.
 * @param {Part[]} parts
 * @param {About} about
 */
export function sentence(parts, about) {
  return parts.map((part) => wordsOfPart(part, about)).join("");
}

/**
 * A sentence as nodes; effects and parameters have their ids as tooltips.
 * @param {Part[]} parts
 * @param {About} about
 */
export function nodes(parts, about) {
  return parts.map((part) => {
    const words = wordsOfPart(part, about);
    if (typeof part === "object" && "effect" in part) return named(words, part.effect);
    return typeof part === "object" && "param" in part ? named(words, part.param) : words;
  });
}

/** What can be done here about what was found; nothing where no button does it. @param {import("./types.js").Advice} advice */
export function adviceOf({ advice, way }) {
  return WAYS[way] ?? advice;
}

/** @param {import("./types.js").Quantity} part @param {About} about */
function measured({ value, unit, text }, about) {
  const scale = scaleOf(unit, about);
  const shown = scale.factor === 1 ? text.replaceAll("-", "−") : number(value * scale.factor);
  return `${shown}\u00a0${unbroken(scale.unit)}`;
}

/** @param {Stretch} part @param {About} about */
function stretch({ ends, unit, direction, words }, about) {
  if (words) return words;
  const scale = scaleOf(unit, about);
  const [from, to] = ends.map((end) => number(end * scale.factor, 4));
  return `${from} to ${to}\u00a0${unbroken(scale.unit)}${DIRECTIONS.get(direction) ?? ""}`;
}

/** A unit that no end of a line parts: N m. @param {string} unit */
function unbroken(unit) {
  return unitWords(unit).replaceAll(" ", "\u00a0");
}

/** What a column of a capture is called. @param {string} column @param {About} about */
function columnWord(column, about) {
  const { theta, omega, alpha } = motionWords(about);
  /** @type {Record<string, string>} */
  const words = { t: "time", theta: theta.name, omega: omega.name, alpha: alpha.name, tau: torqueWord(about.unit) };
  return words[column] ?? column;
}
