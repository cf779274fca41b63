/** The linked plots in a report's file: everything they show is in the file. */

import { byId, make } from "./dom.js";
import { Linked } from "./linked.js";
import { number, torqueScale } from "./numbers.js";
import { times } from "./timing.js";

/** @typedef {import("./types.js").Columns} Columns */

/**
 * What the file holds: columns of `n` 32-bit floats one after the other, then the residual of each rung.
 * @typedef {{unit: string, axis: string, noise: number | null, n: number, columns: string[],
 *   rungs: {label: string, rmse: number}[], floats: string}} Kept
 */

/** @type {Kept} */
const kept = JSON.parse(byId("look-samples").textContent ?? "");
const bytes = Uint8Array.from(atob(kept.floats), (letter) => letter.charCodeAt(0));
const floats = new Float32Array(bytes.buffer);
const column = (/** @type {number} */ at) => floats.subarray(at * kept.n, (at + 1) * kept.n);
/** @type {Columns} */
const measured = Object.fromEntries(kept.columns.map((name, at) => [name, column(at)]));

const words = make("p", { class: "soft", "aria-live": "polite" });
const hint = "Drag a rectangle in any plot: its samples light up in all of them. Escape clears.";
const linked = new Linked((said) => (words.textContent = said ?? hint));
const buttons = kept.rungs.map(({ label, rmse }, at) => {
  const scale = torqueScale(kept.unit, rmse);
  const text = `${label}: ${number(rmse * scale.factor)} ${scale.unit}`;
  return make("button", { type: "button", text, on: { click: () => show(at) } });
});

/** @param {number} rung */
function show(rung) {
  const columns = { ...measured, residual: column(kept.columns.length + rung) };
  linked.show({ ...kept, columns, fitted: true }, { isolated: false, band: false, held: true });
  for (const [at, button] of buttons.entries()) button.setAttribute("aria-pressed", String(at === rung));
}

byId("look").append(make("div", { class: "rungs" }, ...buttons), linked.element, words);
document.addEventListener("keydown", (event) => event.key === "Escape" && linked.clear());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => linked.redraw());
Object.assign(globalThis, { knobcam: { times, linked } });
show(0);
