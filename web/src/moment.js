/** What a capture is at one moment: a small knob that stands where it stood, and the torques as arrows. */

import { byId, styleValue } from "./dom.js";
import { motionWords, number, torqueScale, torqueWord } from "./numbers.js";

/** @typedef {import("./contents.js").Data} Data */

const SIZE = 62; // CSS pixels
const TURNED = 2.2; // rad that the arrow of the largest torque goes round

/**
 * Show one moment, or that there is none.
 * @param {Data | null} data
 * @param {number | null} at which sample
 */
export function showMoment(data, at) {
  byId("moment").classList.toggle("empty", at === null);
  const canvas = /** @type {HTMLCanvasElement} */ (byId("moment-knob"));
  const scale = globalThis.devicePixelRatio || 1;
  canvas.width = canvas.height = Math.round(SIZE * scale);
  const brush = canvas.getContext("2d");
  if (!data || at === null || !brush) {
    byId("moment-words").textContent = "Point at a sample: what is measured and modelled then.";
    return;
  }
  const { t, theta, omega, tau, residual } = data.columns;
  const linear = data.coordinate === "linear";
  const { theta: way, omega: rate } = motionWords(data);
  const counts = residual[at] === residual[at];
  const modelled = tau[at] - residual[at];
  let largest = 0;
  for (let i = 0; i < tau.length; i++) if (Math.abs(tau[i]) > largest) largest = Math.abs(tau[i]);
  const { factor, unit } = torqueScale(data);
  const shown = (/** @type {number} */ value) => number(value * factor);
  byId("moment-words").textContent =
    `${number(t[at], 4)} s, ${number(theta[at])} ${way.unit}, ${number(omega[at])} ${rate.unit}; ${torqueWord(data.unit)} ` +
    (counts
      ? `${shown(tau[at])} measured, ${shown(modelled)} modelled, ${shown(residual[at])} ${unit} left`
      : `masked: it does not count`);
  brush.scale(scale, scale);
  brush.lineWidth = 2.5;
  const colours = ["--measured", "--modelled"].map((name) => styleValue(name, canvas));
  const [ink, paper] = ["--ink", "--shade"].map((name) => styleValue(name, canvas));
  const torques = [tau[at], modelled].map((value) => (counts ? value / (largest || 1) : 0));
  if (linear) slide(brush, place(theta, at), torques, { ink, paper, colours });
  else knob(brush, theta[at], torques, { ink, paper, colours });
}

/** Where a value is between the lowest and the highest, 0 to 1. @param {Float32Array} values @param {number} at */
function place(values, at) {
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < values.length; i++) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  return high > low ? (values[at] - low) / (high - low) : 0.5;
}

/**
 * @param {CanvasRenderingContext2D} brush
 * @param {number} theta rad
 * @param {number[]} torques of the largest
 * @param {{ink: string, paper: string, colours: string[]}} look
 */
function knob(brush, theta, torques, { ink, paper, colours }) {
  const middle = SIZE / 2;
  brush.fillStyle = paper;
  brush.strokeStyle = ink;
  brush.beginPath();
  brush.arc(middle, middle, 15, 0, 2 * Math.PI);
  brush.fill();
  brush.stroke();
  brush.beginPath(); // it turns as an angle is counted: against the clock, from the right
  brush.moveTo(middle, middle);
  brush.lineTo(middle + 15 * Math.cos(theta), middle - 15 * Math.sin(theta));
  brush.stroke();
  for (const [n, torque] of torques.entries()) {
    const [radius, from, to] = [21 + 6 * n, Math.PI / 2, Math.PI / 2 + TURNED * torque];
    brush.strokeStyle = brush.fillStyle = colours[n];
    brush.beginPath();
    brush.arc(middle, middle, radius, -from, -to, torque > 0);
    brush.stroke();
    head(brush, [middle + radius * Math.cos(to), middle - radius * Math.sin(to)], -to - (Math.PI / 2) * Math.sign(torque));
  }
}

/**
 * @param {CanvasRenderingContext2D} brush
 * @param {number} share of the way
 * @param {number[]} torques of the largest
 * @param {{ink: string, paper: string, colours: string[]}} look
 */
function slide(brush, share, torques, { ink, paper, colours }) {
  brush.strokeStyle = ink;
  brush.fillStyle = paper;
  brush.strokeRect(4, 44, SIZE - 8, 4);
  brush.fillRect(6 + share * (SIZE - 28), 32, 16, 12);
  brush.strokeRect(6 + share * (SIZE - 28), 32, 16, 12);
  for (const [n, torque] of torques.entries()) {
    const [from, to, up] = [SIZE / 2, SIZE / 2 + 24 * torque, 10 + 11 * n];
    brush.strokeStyle = brush.fillStyle = colours[n];
    brush.beginPath();
    brush.moveTo(from, up);
    brush.lineTo(to, up);
    brush.stroke();
    head(brush, [to, up], torque < 0 ? Math.PI : 0);
  }
}

/** The head of an arrow. @param {CanvasRenderingContext2D} brush @param {number[]} tip @param {number} way */
function head(brush, [x, y], way) {
  brush.beginPath();
  for (const [ahead, aside] of [[5, 0], [-2, 4], [-2, -4]]) {
    brush.lineTo(x + ahead * Math.cos(way) - aside * Math.sin(way), y + ahead * Math.sin(way) + aside * Math.cos(way));
  }
  brush.fill();
}
