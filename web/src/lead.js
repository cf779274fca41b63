/** What leads a hand through a motion: where it should be, where it turns, when the next beat is. */

/** @typedef {{t: Float32Array, theta: Float32Array}} Motion */
/** @typedef {{at: number, theta: number, turn: boolean}} Beat s, rad; `turn`: here the hand turns, stops or sets off */

/** Seconds that a hand is counted in before a motion begins. */
export const COUNT_IN = 4;
const SLOW = 1.5; // a pass that takes longer has beats on its way, about one a second
const STILL = 1e-4; // of the range: what moves less in a sample stands

/**
 * The angle at a moment: that of the beginning before it, that of the end after it.
 * @param {Motion} motion
 * @param {number} seconds
 */
export function angleAt({ t, theta }, seconds) {
  if (!(seconds > t[0])) return theta[0];
  if (seconds >= t[t.length - 1]) return theta[theta.length - 1];
  let [low, high] = [0, t.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= seconds) low = middle;
    else high = middle;
  }
  return theta[low] + ((theta[high] - theta[low]) * (seconds - t[low])) / (t[high] - t[low]);
}

/**
 * The beats of a motion: one wherever the hand turns, stops or sets off, and about one a second between.
 * @param {Motion} motion
 * @returns {Beat[]}
 */
export function beats({ t, theta }) {
  const [low, high] = range(theta);
  const least = STILL * Math.max(high - low, 1e-9);
  /** @type {Beat[]} */
  const turns = [{ at: t[0], theta: theta[0], turn: true }];
  let way = 0;
  for (let i = 1; i < t.length; i++) {
    const step = theta[i] - theta[i - 1];
    const now = Math.abs(step) < least ? 0 : Math.sign(step);
    if (now === way) continue;
    // Where it is slowest, around a turning, it stands for a moment: that is one beat, not two.
    const last = turns[turns.length - 1];
    if (t[i - 1] - last.at > 0.1) turns.push({ at: t[i - 1], theta: theta[i - 1], turn: true });
    way = now;
  }
  const end = t.length - 1;
  if (t[end] - turns[turns.length - 1].at > 0.1) turns.push({ at: t[end], theta: theta[end], turn: true });
  return turns.flatMap((beat, n) => [beat, ...between(beat, turns[n + 1], { t, theta })]);
}

/**
 * @param {Beat} beat
 * @param {Beat | undefined} next
 * @param {Motion} motion
 * @returns {Beat[]}
 */
function between(beat, next, motion) {
  const passes = next ? next.at - beat.at : 0;
  if (!next || passes <= SLOW) return [];
  const count = Math.round(passes);
  return Array.from({ length: count - 1 }, (_, n) => {
    const at = beat.at + (passes * (n + 1)) / count;
    return { at, theta: angleAt(motion, at), turn: false };
  });
}

/**
 * The lowest and the highest of some values.
 * @param {Float32Array} values
 * @returns {[number, number]}
 */
export function range(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
  return [low, high];
}

/**
 * Which step of the words a moment is in.
 * @param {{seconds: number}[]} steps
 * @param {number} seconds
 */
export function stepAt(steps, seconds) {
  let passed = 0;
  for (const [at, step] of steps.entries()) {
    passed += step.seconds;
    if (seconds < passed) return at;
  }
  return steps.length - 1;
}
