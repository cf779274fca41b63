/** The linked plots in a report's file: everything they show is in the file. */

import { byId } from "./dom.js";
import { Look } from "./look.js";
import { lawOf } from "./math.js";
import { unpacked } from "./packed.js";
import { times } from "./timing.js";

/** @typedef {import("./types.js").Packed} Packed */
/** @typedef {import("./types.js").Kept} Kept */

async function main() {
  for (const law of document.querySelectorAll("[data-latex]")) {
    law.replaceChildren(lawOf({ latex: law.getAttribute("data-latex") ?? "", law: law.textContent ?? "" }));
  }
  /** @type {Kept} */
  const kept = JSON.parse(byId("look-samples").textContent ?? "");
  const unpack = (/** @type {Packed} */ packed) => unpacked(packed, kept.n);
  const names = Object.keys(kept.columns);
  const columns = await Promise.all(Object.values(kept.columns).map(unpack));
  const measured = Object.fromEntries(names.map((name, at) => [name, columns[at]]));
  const residuals = await Promise.all(kept.residuals.map(unpack));

  let shown = 0;
  /** @type {string | null} */
  let looked = null;
  const look = new Look(kept, measured, residuals, {
    step: (at) => {
      [shown, looked] = [at, null];
      look.show(at);
      look.overlay(null, null);
    },
    look: async (effect) => {
      looked = effect;
      const signature = effect ? await unpack(kept.signatures[shown][effect]) : null;
      if (looked === effect) look.overlay(effect, signature);
    },
  });
  byId("look").append(look.element);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => look.linked.redraw());
  // For those who measure.
  Object.assign(globalThis, { knobcam: { times, look } });
  look.show(shown);
}

main();
