/** Columns of samples as a file holds them: whole steps, their differences, deflated. */

/** @typedef {import("./types.js").Packed} Packed */

/**
 * @param {Packed} packed
 * @param {number} n how many values there are
 * @returns {Promise<Float32Array>}
 */
export async function unpacked({ low, step, deflated }, n) {
  const bytes = Uint8Array.from(atob(deflated), (letter) => letter.charCodeAt(0));
  const inflating = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(inflating).arrayBuffer());
  const column = new Float32Array(n);
  for (let i = 0, steps = 0; i < n; i++) {
    const folded = planes[i] | (planes[n + i] << 8) | (planes[2 * n + i] << 16) | (planes[3 * n + i] << 24);
    steps += (folded >>> 1) ^ -(folded & 1);
    column[i] = steps === 0 ? NaN : low + step * (steps - 1);
  }
  return column;
}
