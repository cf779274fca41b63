/** Squared errors: of all samples, and of those that are chosen. */

/** @param {Float32Array} residual */
export function squaresOf(residual) {
  return residual.reduce((sum, value) => (value === value ? sum + value * value : sum), 0);
}

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
