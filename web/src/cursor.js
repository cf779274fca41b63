/** One moment, pointed at in any plot and shown in all of them: by the pointer, or by the keys , and . */

import { MARGIN } from "./axes.js";

/** @typedef {import("./plot.js").Plot} Plot */

const NEAR = 14; // CSS pixels from a point
const PARTS = 200; // of a capture that one key passes

/**
 * Let the nearest sample be pointed at.
 * @param {Plot[]} plots
 * @param {() => Float32Array | null} times of the samples, which a key goes along
 * @param {(at: number | null) => void} told which sample it is; null for none
 */
export function pointing(plots, times, told) {
  /** @type {number | null} */
  let now = null;
  const go = (/** @type {number | null} */ at) => {
    if (at === now) return;
    now = at;
    for (const plot of plots) plot.mark(at);
    told(at);
  };
  for (const plot of plots) {
    plot.element.addEventListener("pointermove", (event) => {
      if (event.buttons !== 0) return; // a rectangle is being drawn
      const edge = plot.element.getBoundingClientRect();
      const at = nearest(plot, event.clientX - edge.left - MARGIN.left, event.clientY - edge.top - MARGIN.top);
      if (at !== null) go(at);
    });
    plot.element.addEventListener("keydown", (event) => {
      const t = times();
      if (!t || (event.key !== "," && event.key !== ".")) return;
      const step = Math.max(1, Math.round(t.length / PARTS)) * (event.key === "." ? 1 : -1);
      go(Math.min(t.length - 1, Math.max(0, (now ?? 0) + step)));
    });
  }
  return { none: () => go(null) };
}

/**
 * The sample whose point is nearest, among those that are near at all.
 * @param {Plot} plot
 * @param {number} x CSS pixels in the drawn area
 * @param {number} y
 * @returns {number | null}
 */
function nearest(plot, x, y) {
  const pixels = plot.pixels(plot.contents?.picked ?? 0);
  if (!pixels || pixels.length === 0) return null;
  const { width, height } = plot.frame;
  const [column, row, reach] = [x, y, NEAR].map((length) => Math.round(length * plot.scale));
  const rect = {
    ...{ left: Math.max(0, column - reach), right: Math.min(width - 1, column + reach) },
    ...{ top: Math.max(0, row - reach), bottom: Math.min(height - 1, row + reach) },
  };
  if (rect.left > rect.right || rect.top > rect.bottom) return null;
  /** @type {number | null} */
  let best = null;
  let least = Infinity;
  for (const at of plot.sorted().inside(rect)) {
    const above = (pixels[at] / width) | 0;
    const away = (above - row) ** 2 + (pixels[at] - above * width - column) ** 2;
    if (away < least) [best, least] = [at, away];
  }
  return best;
}
