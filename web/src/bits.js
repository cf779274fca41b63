/** Chosen samples as bits, the first in the lowest bit of the first byte; no byte at all where none were chosen. */

/**
 * @param {Uint32Array | null} indices
 * @param {number} n how many samples there are
 * @returns {Uint8Array}
 */
export function bitsOf(indices, n) {
  if (!indices) return new Uint8Array(0);
  const bits = new Uint8Array(Math.ceil(n / 8));
  for (let at = 0; at < indices.length; at++) bits[indices[at] >> 3] |= 1 << (indices[at] & 7);
  return bits;
}

/**
 * @param {Uint8Array} bits
 * @returns {Uint32Array | null}
 */
export function indicesOf(bits) {
  if (bits.length === 0) return null;
  const indices = [];
  for (let at = 0; at < 8 * bits.length; at++) if (bits[at >> 3] & (1 << (at & 7))) indices.push(at);
  return Uint32Array.from(indices);
}
