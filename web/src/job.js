/** What is being done, and how much of it is. */

import { byId } from "./dom.js";
import { sentence } from "./said.js";

/** What a sentence is about where no capture is there yet. @type {import("./said.js").About} */
const NOTHING = { unit: "N m", peak: 0, coordinate: "rotary" };

/** @param {import("./types.js").Job | null} job @param {import("./said.js").About | null} about */
export function showJob(job, about) {
  byId("job").hidden = job === null;
  if (!job) return;
  byId("job-what").textContent = sentence(job.what, about ?? NOTHING);
  const bar = /** @type {HTMLProgressElement} */ (byId("job-done"));
  if (job.done === null) bar.removeAttribute("value");
  else bar.value = job.done;
}
