/** What no effect explains over two variables, as a map beside that of the law that is looked at. */

import { MARGIN, drawAxes } from "./axes.js";
import { overWords } from "./curve.js";
import { styleValue } from "./dom.js";
import { number, torqueScale } from "./numbers.js";

/** @typedef {import("./types.js").Surface} Surface */
/** @typedef {import("./curve.js").About} About */

/**
 * Draw what is left, or what a law makes of it, in colours of one scale for both.
 * @param {HTMLCanvasElement} canvas
 * @param {Surface} surface
 * @param {About} about
 * @param {number | null} law from 1; null: what is left
 */
export function drawSurface(canvas, surface, about, law) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const brush = canvas.getContext("2d");
  if (!brush || width === 0) return;
  const scale = globalThis.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
  brush.scale(scale, scale);
  const names = { ink: "--ink", soft: "--soft", line: "--grid", band: "--band", wrong: "--wrong", low: "--modelled" };
  const colours = Object.fromEntries(Object.entries(names).map(([name, style]) => [name, styleValue(style, canvas)]));
  const [x, y] = [surface.x, surface.y].map((places, at) => ({
    ...ends(places),
    ...{ factor: 1, label: overWords(surface.over[at], about) },
  }));
  const title = law === null ? "what is left" : `law ${law}`;
  drawAxes(brush, { width, height }, { x, y, title, colours: /** @type {any} */ (colours), noise: null });
  const shown = law === null ? surface.value : surface.laws[law - 1];
  if (!shown) return;
  const most = largest(surface);
  const [left, right, top, bottom] = [MARGIN.left, width - MARGIN.right, MARGIN.top, height - MARGIN.bottom];
  const [wide, high] = [(right - left) / surface.x.length, (bottom - top) / surface.y.length];
  for (const [row, values] of shown.entries()) {
    for (const [column, value] of values.entries()) {
      if (value === null) continue;
      brush.globalAlpha = Math.min(1, Math.abs(value) / most);
      brush.fillStyle = value < 0 ? colours.low : colours.wrong;
      brush.fillRect(left + column * wide, bottom - (row + 1) * high, wide + 0.5, high + 0.5);
    }
  }
  brush.globalAlpha = 1;
}

/** Where an axis ends whose places are in the middle of cells. @param {number[]} places */
function ends(places) {
  const half = places.length > 1 ? 0.5 * (places[1] - places[0]) : 0.5;
  return { low: places[0] - half, high: places[places.length - 1] + half };
}

/** The largest magnitude of what is left; a law that goes beyond is drawn as that. @param {Surface} surface */
function largest({ value }) {
  return Math.max(...value.flat().map((one) => Math.abs(one ?? 0))) || 1;
}

/**
 * What the maps show, in words.
 * @param {Surface} surface
 * @param {About} about
 */
export function surfaceWords(surface, about) {
  const scale = surface.times ? { factor: 1, unit: `${about.unit} / (${surface.times})` } : torqueScale(about);
  const most = `${number(largest(surface) * scale.factor)} ${scale.unit}`;
  return `Over two variables: orange up to ${most}, blue as far below zero; blank where the motion did not go.`;
}
