/** What no effect explains, as a curve over the variable that it needs, with its band and the laws on it. */

import { MARGIN, drawAxes, limits } from "./axes.js";
import { AXES, labelOf } from "./contents.js";
import { styleValue } from "./dom.js";
import { torqueScale } from "./numbers.js";

/** @typedef {import("./types.js").Curve} Curve */
/** @typedef {{unit: string, peak: number, coordinate: "rotary" | "linear"}} About */

/** @type {Record<string, import("./contents.js").Along>} what formulas call the axes */
const ALONG = { t: "time", theta: "position", omega: "velocity", alpha: "acceleration", s: "history", load: "load" };

/**
 * @param {HTMLCanvasElement} canvas
 * @param {Curve} curve
 * @param {About} about
 * @param {number} looked the law that is looked at, from 1
 */
export function drawCurve(canvas, curve, about, looked) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const brush = canvas.getContext("2d");
  if (!brush || width === 0) return;
  const scale = globalThis.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
  brush.scale(scale, scale);
  const { x, value, band, laws } = curve;
  const edges = [-1, 1].map((side) => value.map((one, at) => (one === null ? NaN : one + side * (band[at] ?? NaN))));
  const drawn = laws.map((law) => law?.map((one) => one ?? NaN) ?? null);
  const [low, high] = limits([...edges, ...drawn.filter((law) => law !== null)].map((one) => Float32Array.from(one)), { around: 0 });
  const shown = curve.times ? { factor: 1, unit: "" } : torqueScale(about);
  const y = { low, high, factor: shown.factor, label: `left over${curve.times ? ` / ${factorOf(curve.times)}` : `, ${shown.unit}`}` };
  const names = { ink: "--ink", soft: "--soft", line: "--grid", band: "--band", wrong: "--wrong", law: "--signature", rest: "--measured" };
  const colours = Object.fromEntries(Object.entries(names).map(([name, style]) => [name, styleValue(style, canvas)]));
  const first = { low: x[0], high: x[x.length - 1], factor: 1, label: overWords(curve.over, about) };
  drawAxes(brush, { width, height }, { x: first, y, title: "", colours: /** @type {any} */ (colours), noise: null });

  const [left, right, top, bottom] = [MARGIN.left, width - MARGIN.right, MARGIN.top, height - MARGIN.bottom];
  const across = (/** @type {number} */ one) => left + ((one - first.low) / (first.high - first.low)) * (right - left);
  const up = (/** @type {number} */ one) => bottom - ((one - low) / (high - low)) * (bottom - top);
  brush.globalAlpha = 0.45;
  brush.fillStyle = colours.band;
  for (let at = 1; at < x.length; at++) {
    const corners = [edges[0][at - 1], edges[0][at], edges[1][at], edges[1][at - 1]];
    if (corners.some(Number.isNaN)) continue;
    brush.beginPath();
    for (const [n, one] of corners.entries()) brush.lineTo(across(x[n === 0 || n === 3 ? at - 1 : at]), up(one));
    brush.fill();
  }
  brush.globalAlpha = 1;
  const line = (/** @type {(number | null)[]} */ values, /** @type {string} */ colour, /** @type {number} */ thick, /** @type {number[]} */ dashes) => {
    [brush.strokeStyle, brush.lineWidth] = [colour, thick];
    brush.setLineDash(dashes);
    brush.beginPath();
    let down = false;
    for (const [at, one] of values.entries()) {
      if (one === null || Number.isNaN(one)) down = false;
      else if (down) brush.lineTo(across(x[at]), up(one));
      else brush.moveTo(across(x[at]), up(one));
      down = one !== null && !Number.isNaN(one);
    }
    brush.stroke();
  };
  line(value, colours.ink, 1.5, []);
  for (const [at, law] of drawn.entries()) if (law && at + 1 !== looked) line(law, colours.rest, 1, [2, 3]);
  const mine = drawn[looked - 1];
  if (mine) line(mine, colours.law, 2.5, [7, 4]);
}

/**
 * What a curve shows, in words.
 * @param {Curve} curve
 * @param {number} looked
 */
export function curveWords({ over, laws }, looked) {
  const law = laws[looked - 1] ? `; green: law ${looked}` : "";
  return `Black: what is left over ${wordOf(over)}, with its 95 % band${law}. What the model's parameters can take is off all of them.`;
}

/** @param {string} over */
function wordOf(over) {
  const inside = over.replace(/^abs\((.*)\)$/, "$1");
  const word = ALONG[inside] ? AXES[ALONG[inside]].words : over;
  return inside === over ? word : `the magnitude of ${word}`;
}

/** A variable of a formula as an axis has it. @param {string} over @param {About} about */
export function overWords(over, about) {
  const inside = over.replace(/^abs\((.*)\)$/, "$1");
  const along = ALONG[inside];
  if (!along) return over;
  const label = labelOf(along, about);
  return inside === over ? label : `|${label.replace(", ", "|, ")}`;
}

/** What a curve is divided by, in words where it is a variable alone. @param {string} times */
export function factorOf(times) {
  return times in ALONG ? variableOf(times) : `(${times})`;
}

/** @type {Record<string, string>} */
const TURNS = { t: "t", theta: "θ", omega: "ω", alpha: "α", s: "s" };
/** @type {Record<string, string>} */
const SLIDES = { ...TURNS, theta: "x", omega: "v", alpha: "dv/dt" };

/**
 * What a law is of, each with its letter.
 * @param {string[]} variables
 * @param {Pick<About, "coordinate">} about
 */
export function lettered(variables, { coordinate }) {
  const letters = coordinate === "linear" ? SLIDES : TURNS;
  return variables.map((one) => (one in letters ? `${variableOf(one)} ${letters[one]}` : variableOf(one))).join(", ");
}

/** A variable of a law in words. @param {string} variable */
export function variableOf(variable) {
  const along = /** @type {Record<string, import("./contents.js").Along>} */ (ALONG)[variable];
  return along ? AXES[along].words : variable;
}
