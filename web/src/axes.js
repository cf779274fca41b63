/** Axes around a cloud of points: ticks, grid, labels. */

import { number, ticks } from "./numbers.js";
import { drawSpectrum } from "./spectrum.js";

/** @typedef {import("./types.js").Split} Split */

/** Room around the points, in CSS pixels. */
export const MARGIN = { left: 52, right: 10, top: 22, bottom: 34 };

/**
 * @typedef {{low: number, high: number, factor: number, label: string, part?: boolean, log?: boolean}} Axis
 * low and high in SI; shown = factor * SI. `part`: points beyond are not meant to be seen. `log`: low and high are
 * logarithms to base 10
 */

/**
 * Draw ticks, grid lines and labels above the points.
 * @param {CanvasRenderingContext2D} brush with one unit per CSS pixel
 * @param {{width: number, height: number}} size of the whole plot, CSS pixels
 * @param {{x: Axis, y: Axis, title: string, colours: {ink: string, soft: string, line: string, band: string, wrong: string},
 *   noise: number | null, bins?: Split | null, spectrum?: import("./spectrum.js").Spectrum | null}} plot `noise`: a torque that chance reaches, drawn as a pair of lines
 */
export function drawAxes(brush, size, { x, y, title, colours, noise, bins, spectrum }) {
  const { left, top } = MARGIN;
  const [right, bottom] = [size.width - MARGIN.right, size.height - MARGIN.bottom];
  brush.clearRect(0, 0, size.width, size.height);
  brush.font = "11px system-ui, 'DejaVu Sans', sans-serif";
  brush.lineWidth = 1;

  const across = (/** @type {number} */ value) => left + ((value - x.low) / (x.high - x.low)) * (right - left);
  const up = (/** @type {number} */ value) => bottom - ((value - y.low) / (y.high - y.low)) * (bottom - top);
  brush.strokeStyle = colours.line;
  brush.fillStyle = colours.soft;
  brush.textAlign = "center";
  brush.textBaseline = "top";
  for (const [value, text] of ticksOf(x, (right - left) / 70)) {
    const at = Math.round(across(value)) + 0.5;
    stroke(brush, at, top, at, bottom);
    brush.fillText(text, at, bottom + 4);
  }
  brush.textAlign = "right";
  brush.textBaseline = "middle";
  for (const [value, text] of ticksOf(y, (bottom - top) / 32)) {
    const at = Math.round(up(value)) + 0.5;
    stroke(brush, left, at, right, at);
    brush.fillText(text, left - 5, at);
  }
  if (noise) {
    brush.save();
    brush.strokeStyle = colours.ink;
    brush.setLineDash([5, 4]);
    for (const value of [-noise, noise]) {
      const at = Math.round(up(value)) + 0.5;
      if (at > top && at < bottom) stroke(brush, left, at, right, at);
    }
    brush.restore();
  }
  if (bins || spectrum) {
    brush.save();
    brush.beginPath();
    brush.rect(left, top, right - left, bottom - top);
    brush.clip();
    if (bins) drawBins(brush, bins, across, up, colours);
    if (spectrum) drawSpectrum(brush, spectrum, { across, up, bottom }, colours);
    brush.restore();
  }
  brush.strokeStyle = colours.soft;
  stroke(brush, left + 0.5, top, left + 0.5, bottom);
  stroke(brush, left, bottom + 0.5, right, bottom + 0.5);

  brush.textAlign = "right";
  brush.textBaseline = "bottom";
  brush.fillText(x.label, right, size.height - 2);
  const font = brush.font;
  brush.fillStyle = colours.ink;
  brush.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
  brush.fillText(title, right, top - 4);
  const room = right - brush.measureText(title).width - 16;
  brush.fillStyle = colours.soft;
  brush.font = font;
  brush.textAlign = "left";
  brush.fillText(labelWithin(y.label, room, (text) => brush.measureText(text).width), 4, top - 5, Math.max(room, 24));
}

/**
 * The label of an axis, or where the title leaves no room for it what comes last in it, which is its unit.
 * @param {string} label
 * @param {number} room
 * @param {(text: string) => number} widthOf
 */
export function labelWithin(label, room, widthOf) {
  return widthOf(label) <= room ? label : label.slice(label.indexOf(", ") + 1).trim();
}

/** A tick in no more digits than it has: there is little room beside an axis. @param {number} value */
export function tickWords(value) {
  return number(value, 6).replace(/\.?0+e/, "e");
}

/**
 * Where an axis has ticks, and what is written there.
 * @param {Axis} axis
 * @param {number} count how many there may be, about
 * @returns {[number, string][]}
 */
function ticksOf({ low, high, factor, log }, count) {
  if (!log) return ticks(low * factor, high * factor, count).map((value) => [value / factor, tickWords(value)]);
  const few = count / (high - low) >= 3 ? [1, 2, 5] : [1]; // of each decade
  const decades = Array.from({ length: Math.ceil(high) - Math.floor(low) + 1 }, (_, at) => 10 ** (Math.floor(low) + at));
  const shift = Math.log10(factor);
  return decades
    .flatMap((decade) => few.map((digit) => digit * decade))
    .map((value) => /** @type {[number, string]} */ ([Math.log10(value) - shift, number(value, 1)]))
    .filter(([at]) => at >= low && at <= high);
}

/**
 * Draw the mean of each bin over the band that chance gives it: a line where the knob moves forward or either way,
 * dashes where it moves backward.
 * @param {CanvasRenderingContext2D} brush
 * @param {Split} bins
 * @param {(value: number) => number} across
 * @param {(value: number) => number} up
 * @param {{ink: string, band: string}} colours
 */
function drawBins(brush, bins, across, up, { ink, band }) {
  const edges = bins.low.map((low, at) => [across(low), across(bins.high[at])]);
  brush.globalAlpha = 0.35;
  brush.fillStyle = band;
  for (const [at, [from, to]] of edges.entries()) {
    const half = bins.band[at];
    if (half) brush.fillRect(from, up(half), to - from, up(-half) - up(half));
  }
  brush.globalAlpha = 1;
  brush.strokeStyle = ink;
  brush.lineWidth = 2;
  for (const [at, [from, to]] of edges.entries()) {
    brush.setLineDash(bins.direction[at] < 0 ? [3, 2] : []);
    stroke(brush, from, up(bins.mean[at]), to, up(bins.mean[at]));
  }
}

/**
 * @param {CanvasRenderingContext2D} brush
 * @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1
 */
function stroke(brush, x0, y0, x1, y1) {
  brush.beginPath();
  brush.moveTo(x0, y0);
  brush.lineTo(x1, y1);
  brush.stroke();
}

/**
 * The limits that hold all finite values, with some air.
 * @param {Float32Array[]} columns
 * @param {{air?: number, around?: number}} [options] air: share of the span; around: a value that has to be inside
 * @returns {[number, number]}
 */
export function limits(columns, { air = 0.03, around = NaN } = {}) {
  let [low, high] = [Infinity, -Infinity];
  for (const column of columns) {
    for (let i = 0; i < column.length; i++) {
      if (column[i] < low) low = column[i];
      if (column[i] > high) high = column[i];
    }
  }
  if (around < low) low = around;
  if (around > high) high = around;
  if (!(low <= high)) return [-1, 1];
  const room = high > low ? air * (high - low) : Math.abs(low) || 1;
  return [low - room, high + room];
}
