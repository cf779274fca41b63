/** What leads a hand through a motion: where it should be, where it turns, when the next beat is. */

/** @typedef {{t: Float32Array, theta: Float32Array}} Motion */
/** @typedef {{at: number, theta: number, turn: boolean}} Beat s, rad; `turn`: here the hand turns, stops or sets off */
/** @typedef {Pick<import("./types.js").HandStep, "seconds" | "beats">} Step */

/** Seconds that a hand is counted in before a motion begins. */
export const COUNT_IN = 4;
const AT_ONCE = 0.1; // s: beats that are nearer are one
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
 * Where the hand turns, stops or sets off.
 * @param {Motion} motion
 * @returns {Beat[]}
 */
export function turnings({ t, theta }) {
  const [low, high] = range(theta);
  const least = STILL * Math.max(high - low, 1e-9);
  /** @type {Beat[]} */
  const turns = [{ at: t[0], theta: theta[0], turn: true }];
  let way = 0;
  for (let i = 1; i < t.length; i++) {
    const step = theta[i] - theta[i - 1];
    const now = Math.abs(step) < least ? 0 : Math.sign(step);
    if (now === way) continue;
    // Where it is slowest, around a turning, it stands for a moment: that is one turning, not two.
    const last = turns[turns.length - 1];
    if (t[i - 1] - last.at > AT_ONCE) turns.push({ at: t[i - 1], theta: theta[i - 1], turn: true });
    way = now;
  }
  const end = t.length - 1;
  if (t[end] - turns[turns.length - 1].at > AT_ONCE) turns.push({ at: t[end], theta: theta[end], turn: true });
  return turns;
}

/**
 * The beats of a metronome: as many a minute as each step says, from its beginning on, and one at the end.
 * @param {Motion} motion
 * @param {Step[]} steps
 * @returns {Beat[]}
 */
export function beats(motion, steps) {
  const turns = turnings(motion);
  let begun = motion.t[0];
  const times = steps.flatMap(({ seconds, beats: minute }) => {
    const count = minute > 0 ? Math.max(1, Math.round((seconds * minute) / 60)) : 1;
    const first = begun;
    begun += seconds;
    return Array.from({ length: count }, (_, n) => first + (minute > 0 ? (60 * n) / minute : 0));
  });
  times.push(motion.t[motion.t.length - 1]);
  const apart = times.filter((at, n) => n === 0 || at - times[n - 1] > AT_ONCE);
  const turn = (/** @type {number} */ at) => turns.some((one) => Math.abs(one.at - at) < AT_ONCE);
  return apart.map((at) => ({ at, theta: angleAt(motion, at), turn: turn(at) }));
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
