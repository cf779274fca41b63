/** What is being done, and how much of it is. */

import { byId } from "./dom.js";
import { number } from "./numbers.js";
import { sentence } from "./said.js";

/** What a sentence is about where no capture is there yet. @type {import("./said.js").About} */
const NOTHING = { unit: "N m", peak: 0, coordinate: "rotary" };

/**
 * The buttons beside what is being done: the one gives it up, the other ends a search with what it has.
 * @param {(verb: string) => Promise<import("./types.js").Answer | null>} ask
 * @param {(words: string) => void} say
 */
export function jobButtons(ask, say) {
  byId("cancel").addEventListener("click", async () => {
    const answer = await ask("cancel");
    if (answer?.cancelled === false) say("too late to cancel: it is done");
  });
  byId("enough").addEventListener("click", () => ask("enough"));
}

const LONG_S = 2; // from which on it is said for how long something has been done
let since = 0;
/** @type {ReturnType<typeof setInterval> | undefined} */
let clock;

/** @param {import("./types.js").Job | null} job @param {import("./said.js").About | null} about */
export function showJob(job, about) {
  byId("job").hidden = job === null;
  clearInterval(clock);
  if (!job) return;
  byId("job-what").textContent = sentence(job.what, about ?? NOTHING);
  byId("enough").hidden = !job.stops;
  const bar = /** @type {HTMLProgressElement} */ (byId("job-done"));
  if (job.done === null) bar.removeAttribute("value");
  else bar.value = job.done;
  since = performance.now() - 1000 * job.seconds;
  const tick = () => void (byId("job-time").textContent = timeWords((performance.now() - since) / 1000, job.takes_s));
  tick();
  clock = setInterval(tick, 1000);
}

/**
 * For how long something has been done, and how long that usually takes.
 * @param {number} seconds
 * @param {[number, number] | null} takes
 */
export function timeWords(seconds, takes) {
  const usual = takes ? `, usually ${number(takes[0], 1)} to ${number(takes[1], 1)}\u00a0s` : "";
  return seconds < LONG_S && !usual ? "" : `${Math.floor(seconds)}\u00a0s${usual}`;
}
