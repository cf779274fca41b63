/** Looking closer: by the wheel around the pointer, by keys around the middle, or at the brushed region. */

import { MARGIN } from "./axes.js";

/** @typedef {import("./plot.js").Plot} Plot */
/** @typedef {[number, number]} Range low and high, SI */
/**
 * What can be done with a plot: see `factor` times as much of its x axis around a share of it, move along by a
 * share of what is seen, see everything.
 * @typedef {{zoom: (plot: Plot, at: number, factor: number) => void, pan: (plot: Plot, share: number) => void,
 *   whole: (plot: Plot) => void}} Deeds
 */

const CLOSEST = 1e-4; // of the whole
const WHEEL = 0.0015; // of the logarithm for a unit of the wheel's turn
const LINE = 16; // units that a line of the wheel is, where it counts in lines
const KEY = 1.5; // times for a key

/** Whether the wheel is for the plots below: they stand in a column that scrolls, and this one was not clicked. @param {HTMLElement} plot */
function toScroll(plot) {
  const column = plot.parentElement?.parentElement;
  return column != null && column.scrollHeight > column.clientHeight + 1 && document.activeElement !== plot;
}

/**
 * Make a plot answer to the wheel and to + and −.
 * @param {Plot} plot
 * @param {Deeds} deeds
 */
export function zoomable(plot, deeds) {
  const { element } = plot;
  element.addEventListener(
    "wheel",
    (event) => {
      if (!plot.contents || event.ctrlKey || toScroll(element)) return; // with ctrl the browser zooms the page
      event.preventDefault();
      const edge = element.getBoundingClientRect();
      const wide = edge.width - MARGIN.left - MARGIN.right;
      const at = Math.min(1, Math.max(0, (event.clientX - edge.left - MARGIN.left) / wide));
      const unit = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE;
      const across = event.shiftKey ? event.deltaX || event.deltaY : event.deltaX;
      if (Math.abs(across) > Math.abs(event.deltaY) || event.shiftKey) deeds.pan(plot, (unit * across) / wide);
      else deeds.zoom(plot, at, Math.exp(WHEEL * unit * event.deltaY));
    },
    { passive: false },
  );
  element.addEventListener("dblclick", () => deeds.whole(plot));
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "+" || event.key === "=") deeds.zoom(plot, 0.5, 1 / KEY);
    else if (event.key === "-") deeds.zoom(plot, 0.5, KEY);
    else if (event.key === "0") deeds.whole(plot);
    else return;
    event.preventDefault();
  });
}

/**
 * See `factor` times as much of an axis; a share of what is seen stays where it is.
 * @param {Range} seen
 * @param {Range} whole
 * @param {number} at share of what is seen
 * @param {number} factor
 * @returns {Range | null} null: everything
 */
export function zoomed([low, high], whole, at, factor) {
  const all = whole[1] - whole[0];
  const span = Math.max(CLOSEST * all, factor * (high - low));
  if (!(span < all)) return null;
  const fixed = low + at * (high - low);
  return within([fixed - at * span, fixed + (1 - at) * span], whole);
}

/**
 * Move along an axis, to its ends at most.
 * @param {Range} seen
 * @param {Range} whole
 * @param {number} share of what is seen
 * @returns {Range}
 */
export function panned([low, high], whole, share) {
  const step = share * (high - low);
  return within([low + step, high + step], whole);
}

/** @param {Range} seen @param {Range} whole @returns {Range} as wide, inside */
function within([low, high], [lowest, highest]) {
  const back = Math.max(0, lowest - low) - Math.max(0, high - highest);
  return [low + back, high + back];
}
