/** Residuals that move from where they were to where another model leaves them: structure that becomes noise. */

const LASTS_MS = 700;
const MOST = 60_000; // samples, beyond which a frame would take too long

/**
 * What the residuals move from; null where they are simply drawn anew, as for who wants nothing to move.
 * @param {import("./contents.js").Data | null} before
 * @param {import("./contents.js").Data} now
 * @returns {Float32Array | null}
 */
export function movesFrom(before, now) {
  const from = before?.columns.residual;
  const same = before?.columns.t === now.columns.t && from !== now.columns.residual && before?.fitted && now.fitted;
  const still = globalThis.matchMedia?.("(prefers-reduced-motion: reduce)").matches ?? true;
  return from && same && !still && from.length <= MOST ? from : null;
}

/**
 * Between two residuals; a sample that only one of them has is where that has it.
 * @param {Float32Array} from
 * @param {Float32Array} to
 * @param {number} share of the way, 0 to 1
 */
export function between(from, to, share) {
  return to.map((value, i) => (from[i] === from[i] ? from[i] + share * (value - from[i]) : value));
}

/**
 * Show residuals on their way, a frame at a time, until they are there.
 * @param {Float32Array} from
 * @param {Float32Array} to
 * @param {(residual: Float32Array) => boolean} show returns whether it is still wanted
 */
export function settle(from, to, show) {
  let start = NaN;
  const frame = (/** @type {number} */ now) => {
    if (Number.isNaN(start)) start = now;
    const left = 1 - Math.min(1, (now - start) / LASTS_MS);
    const wanted = show(left > 0 ? between(from, to, 1 - left ** 3) : to);
    if (wanted && left > 0) requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}
