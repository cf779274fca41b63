/** What was hidden in a knob, told to who asks. */

import { ask } from "./api.js";
import { byId } from "./dom.js";

/** @typedef {import("./types.js").State} State */

/** @type {string[]} captures that hide something */
let hiding = [];

/** @param {(reason: unknown) => void} failed */
export function unhiding(failed) {
  byId("unhide").addEventListener("click", async () => {
    try {
      const told = await Promise.all(hiding.map((capture) => ask("hidden", { capture })));
      byId("unhidden").textContent = [...new Set(told.map(({ hidden }) => hidden.join(" and ")))].join("; ");
    } catch (reason) {
      failed(reason);
    }
  });
}

/** @param {State} state */
export function showHidden({ captures, active }) {
  const now = captures.filter(({ id, hides }) => hides && active.includes(id)).map(({ id }) => id);
  byId("hides").hidden = now.length === 0;
  if (now.join() !== hiding.join()) byId("unhidden").textContent = "";
  hiding = now;
}
