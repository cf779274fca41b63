/** How a rectangle is dragged, moved and sized on a plot, by mouse, finger or keys. */

import { MARGIN } from "./axes.js";

/** @typedef {import("./plot.js").Plot} Plot */
/** @typedef {import("./plot.js").Region} Region */

const SMALLEST = 4; // pixels; what is smaller was a click

/**
 * Make a plot answer to the pointer and to the arrow keys.
 * @param {Plot} plot
 */
export function brushable(plot) {
  byPointer(plot);
  plot.element.addEventListener("keydown", (event) => byKeys(plot, event));
}

/** @param {Plot} plot */
function byPointer(plot) {
  const { element } = plot;
  /** @type {{x: number, y: number, moved: Region | null} | null} */
  let start = null;
  const spot = (/** @type {PointerEvent} */ event) => {
    const edge = element.getBoundingClientRect();
    const wide = edge.width - MARGIN.left - MARGIN.right;
    const high = edge.height - MARGIN.top - MARGIN.bottom;
    const [x, y] = [event.clientX - edge.left - MARGIN.left, event.clientY - edge.top - MARGIN.top];
    return { x: clamped(x / wide), y: clamped(y / high), wide, high };
  };
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !plot.contents) return;
    element.setPointerCapture(event.pointerId);
    plot.sorted();
    const { x, y } = spot(event);
    const box = plot.region && plot.boxInside(plot.region);
    const inside =
      box && x > box.left && x < box.left + box.width && y > box.top && y < box.top + box.height;
    start = { x, y, moved: inside ? plot.region : null };
  });
  element.addEventListener("pointermove", (event) => {
    if (!start) return;
    const { x, y, wide, high } = spot(event);
    if (start.moved) {
      plot.brushed(plot, shifted(plot, start.moved, x - start.x, y - start.y));
    } else if (Math.abs(x - start.x) * wide >= SMALLEST && Math.abs(y - start.y) * high >= SMALLEST) {
      plot.brushed(plot, between(plot, start, { x, y }));
    }
  });
  element.addEventListener("pointerup", (event) => {
    const { x, y, wide, high } = spot(event);
    if (start && Math.hypot((x - start.x) * wide, (y - start.y) * high) < SMALLEST) plot.brushed(plot, null);
    start = null;
  });
  element.addEventListener("pointercancel", () => (start = null));
}

/** @param {Plot} plot @param {KeyboardEvent} event */
function byKeys(plot, event) {
  const step = 0.02;
  const ways = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  if (!(event.key in ways) || !plot.contents || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  const [x, y] = ways[/** @type {keyof typeof ways} */ (event.key)];
  if (!plot.region) {
    plot.brushed(plot, between(plot, { x: 0.4, y: 0.02 }, { x: 0.6, y: 0.98 }));
  } else if (event.shiftKey) {
    const box = plot.boxInside(plot.region);
    const [right, bottom] = [box.left + box.width + x, box.top + box.height + y];
    plot.brushed(plot, between(plot, { x: box.left, y: box.top }, { x: clamped(right), y: clamped(bottom) }));
  } else {
    plot.brushed(plot, shifted(plot, plot.region, x, y));
  }
}

/** @param {number} share */
function clamped(share) {
  return Math.min(1, Math.max(0, share));
}

/**
 * The region between two corners, in shares of the drawn area.
 * @param {Plot} plot
 * @param {{x: number, y: number}} one
 * @param {{x: number, y: number}} other
 * @returns {Region}
 */
function between(plot, one, other) {
  const { x, y } = plot.frame;
  const [left, right] = [Math.min(one.x, other.x), Math.max(one.x, other.x)];
  const [top, bottom] = [Math.min(one.y, other.y), Math.max(one.y, other.y)];
  return {
    x: [x[0] + left * (x[1] - x[0]), x[0] + right * (x[1] - x[0])],
    y: [y[1] - bottom * (y[1] - y[0]), y[1] - top * (y[1] - y[0])],
  };
}

/**
 * @param {Plot} plot @param {Region} region
 * @param {number} right @param {number} down in shares of the drawn area
 * @returns {Region}
 */
function shifted(plot, region, right, down) {
  const { x, y } = plot.frame;
  const [across, up] = [right * (x[1] - x[0]), -down * (y[1] - y[0])];
  return { x: [region.x[0] + across, region.x[1] + across], y: [region.y[0] + up, region.y[1] + up] };
}
