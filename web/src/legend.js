/** What the colours of the plots are. */

import { byId } from "./dom.js";
import { number, torqueWord } from "./numbers.js";

/**
 * @param {Pick<import("./types.js").State, "below_hz" | "unit">} state
 * @param {import("./store.js").Columns} columns
 * @param {string | null} beside name of the branch beside, null for none
 */
export function showLegend({ below_hz: edge, unit }, { masked, residual }, beside) {
  byId("beside").hidden = beside === null;
  byId("beside-name").textContent = beside ?? "";
  byId("masked").hidden = !(masked && residual.some((value) => value !== value));
  byId("measured").title = edge === null ? "as it was recorded" : `the recorded ${torqueWord(unit)} below ${number(edge)} Hz: a filter takes off what is faster, of the modelled one too`;
}
