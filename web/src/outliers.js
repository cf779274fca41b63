/** Samples that no axis is made for: a few that would flatten all the others. They are drawn at its edge, and counted. */

import { thousands } from "./numbers.js";
import { remembered } from "./remembered.js";

const TIMES = 2; // as far as all the others, beyond which a sample may be an outlier
const SHARE = 0.0002; // of all samples that may be, and of a short capture
const FEW = 3; // of them

/** How far values reach from zero where the few that reach more than twice as far as all the others are left out. */
export const mostReach = remembered((/** @type {Float32Array} */ values) => {
  const few = Math.max(FEW, SHARE * values.length);
  for (let reach = Infinity; ; ) {
    let [most, beyond] = [0, 0];
    for (let i = 0; i < values.length; i++) {
      const size = Math.abs(values[i]);
      if (size <= reach && size > most) most = size;
    }
    for (let i = 0; i < values.length; i++) if (Math.abs(values[i]) > most / TIMES) beyond++;
    if (most === 0 || beyond > few) return most;
    reach = most / TIMES;
  }
});

/** From where to where values of two columns go; without the few at either end that would take more than half of the axis from
 * all others. */
export const mostLimits = remembered((/** @type {Float32Array} */ one, /** @type {Float32Array} */ other) => {
  const columns = [one, other];
  const few = Math.max(FEW, SHARE * columns[0].length);
  let [low, high] = within(columns, -Infinity, Infinity);
  const whole = /** @type {[number, number]} */ ([low, high]);
  while (low < high) {
    const quarter = 0.25 * (high - low);
    let [above, below] = [0, 0];
    for (const y of columns) {
      for (let i = 0; i < y.length; i++) {
        if (y[i] > high - quarter) above++;
        else if (y[i] < low + quarter) below++;
      }
    }
    if (above > few && below > few) break;
    [low, high] = within(columns, below > few ? low : low + quarter, above > few ? high : high - quarter);
  }
  return whole[1] - whole[0] > TIMES * (high - low) ? [low, high] : whole;
});

/** The least and the largest of the values between two limits; NaN where there are none.
 * @param {Float32Array[]} columns @param {number} low @param {number} high @returns {[number, number]} */
function within(columns, low, high) {
  let [least, most] = [Infinity, -Infinity];
  for (const y of columns) {
    for (let i = 0; i < y.length; i++) {
      if (y[i] < low || y[i] > high) continue;
      if (y[i] < least) least = y[i];
      if (y[i] > most) most = y[i];
    }
  }
  return least <= most ? [least, most] : [NaN, NaN];
}

/** What stands at an axis that some values are beyond; they are drawn at its edge. @param {Float32Array} y @param {number} low @param {number} high */
export function beyondWords(y, low, high) {
  let count = 0;
  for (let i = 0; i < y.length; i++) if (y[i] < low || y[i] > high) count++;
  return count === 0 ? "" : ` (${thousands(count)} ${count === 1 ? "sample" : "samples"} beyond, at the edge)`;
}
