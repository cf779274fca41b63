/** What is being done, and how much of it is. */

import { byId } from "./dom.js";

/** @param {import("./types.js").Job | null} job */
export function showJob(job) {
  byId("job").hidden = job === null;
  if (!job) return;
  byId("job-what").textContent = job.what;
  const bar = /** @type {HTMLProgressElement} */ (byId("job-done"));
  if (job.done === null) bar.removeAttribute("value");
  else bar.value = job.done;
}
