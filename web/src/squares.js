/** Squared errors: of all samples, and of those that are chosen. */

import { remembered } from "./remembered.js";

/** Of all samples. */
export const squaresOf = remembered((/** @type {Float32Array} */ residual) => {
  let sum = 0;
  for (let i = 0; i < residual.length; i++) if (residual[i] === residual[i]) sum += residual[i] * residual[i];
  return sum;
});

/** @param {Float32Array} residual @param {Uint32Array} chosen */
export function chosenSquares(residual, chosen) {
  let [sum, count] = [0, 0];
  for (let at = 0; at < chosen.length; at++) {
    const value = residual[chosen[at]];
    if (value !== value) continue;
    sum += value * value;
    count++;
  }
  return { sum, count };
}
