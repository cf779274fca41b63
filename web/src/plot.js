/**
 * One plot: a layer of all points that is drawn once per change of the data, a layer of the chosen ones,
 * axes above, and a rectangle that is dragged.
 */

import { MARGIN, drawAxes } from "./axes.js";
import { make, styleValue } from "./dom.js";
import { Pick } from "./pick.js";
import { cloudOf, drawCloud, drawFew, drawPoints, pixelColour, place } from "./raster.js";
import { idle } from "./timing.js";

/**
 * @typedef {{colour: string, chosen: string | null, y: Float32Array, strength: number}} Series
 * `colour`, `chosen`: names in the style sheet of the cloud and of its chosen points (null: these are not drawn)
 * @typedef {{title: string, x: Float32Array, xAxis: import("./axes.js").Axis, yAxis: import("./axes.js").Axis,
 *   series: Series[], picked: number, noise: number | null, bins?: import("./types.js").Split | null,
 *   spectrum?: import("./spectrum.js").Spectrum | null}} Contents
 * `picked`: the series whose points the brush takes; `bins`: means of it, and what chance gives them
 * @typedef {{x: [number, number], y: [number, number]}} Region in data units
 */

const FEW = 8000; // points of which each is worth a larger dot
const FEW_CHOSEN = 20; // which are drawn larger
const CLOUDS = 8; // that are kept: undo and redo, or a zoom and back, draw what was drawn before
const AT_ONCE = 50_000; // points of a cloud that are drawn in the frame that shows new ones...
const LIT_AT_ONCE = 200_000; // of chosen ones, while a brush moves: more than a plot has pixels
const REST_MS = 150; // ...and all of them when nothing else has come for so long

export class Plot {
  /**
   * @param {string} name in words, for those who hear the page
   * @param {(plot: Plot, region: Region | null) => void} brushed
   */
  constructor(name, brushed) {
    this.brushed = brushed;
    this.base = make("canvas", { class: "points" });
    this.light = make("canvas", { class: "points light" });
    this.axes = make("canvas", { class: "axes" });
    this.box = make("div", { class: "brush", hidden: true });
    this.dot = make("div", { class: "moment", hidden: true });
    /** @type {number | null} the sample that is pointed at */
    this.marked = null;
    this.element = make(
      "div",
      { class: "plot", tabindex: 0, role: "img", "aria-label": name },
      ...[this.base, this.light, this.axes, this.box, this.dot],
    );
    /** @type {Contents | null} */
    this.contents = null;
    /** @type {import("./raster.js").Frame} */
    this.frame = { width: 0, height: 0, x: [0, 1], y: [0, 1], dot: 2 };
    /** @type {{x: Float32Array, y: Float32Array, frame: string, pixels: Int32Array}[]} of each series, once it was asked for */
    this.placed = [];
    /** @type {{x: Float32Array, y: Float32Array, frame: string, cloud: import("./raster.js").Cloud}[]} the oldest first */
    this.clouds = [];
    this.rest = 0; // the timer of what is still to be drawn
    this.unlit = 0; // and of what is chosen
    /** @type {Pick | null} */
    this.pick = null;
    /** @type {Region | null} */
    this.region = null;
    this.scale = 1;
  }

  /** @param {string} name of a colour in the style sheet */
  colour(name) {
    return styleValue(name, this.element);
  }

  /** @param {Contents} contents */
  show(contents) {
    this.drawAll(contents);
  }

  /**
   * Draw everything anew: the data, the size or the colours have changed.
   * @param {Contents | null} [contents]
   */
  drawAll(contents = this.contents) {
    const { clientWidth: width, clientHeight: height } = this.element;
    this.contents = contents;
    if (!contents || width < 100 || height < 80) return;
    const { x, xAxis, yAxis } = contents;
    this.scale = globalThis.devicePixelRatio || 1;
    const inner = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    const [columns, rows] = inner.map((length) => Math.max(8, Math.round(length * this.scale)));
    const part = { x: xAxis.part ?? false, y: yAxis.part ?? false };
    const many = x.length > FEW && !(part.x && fewBetween(x, xAxis));
    const dot = Math.max(1, Math.round((many ? 2 : 3) * this.scale));
    this.frame = { width: columns, height: rows, x: [xAxis.low, xAxis.high], y: [yAxis.low, yAxis.high], dot, part };
    this.pick = null;

    for (const canvas of [this.base, this.light]) {
      if (canvas.width !== columns || canvas.height !== rows) [canvas.width, canvas.height] = [columns, rows];
      canvas.style.width = `${inner[0]}px`;
      canvas.style.height = `${inner[1]}px`;
    }
    this.drawBase(contents);
    this.drawFrame(width, height);
    this.drawBox();
    this.mark(this.marked);
  }

  /** @param {Contents} contents @param {number} [every] of how many points one is drawn, until all of them are */
  drawBase(contents, every = Math.ceil(contents.x.length / AT_ONCE)) {
    const { x, series } = contents;
    const image = new ImageData(this.frame.width, this.frame.height);
    const pixels = new Uint32Array(image.data.buffer);
    pixels.fill(pixelColour(this.colour("--paper")));
    const clouds = series.map(({ y }) => this.cloud(x, y, every));
    for (const [at, { colour, strength }] of series.entries()) {
      drawCloud(pixels, clouds[at], pixelColour(this.colour(colour)), strength);
    }
    this.base.getContext("2d")?.putImageData(image, 0, 0);
    clearTimeout(this.rest);
    const whole = () => this.contents === contents && this.drawBase(contents, 1);
    if (clouds.some((cloud) => cloud.every > 1)) this.rest = setTimeout(() => idle(whole), REST_MS);
  }

  /**
   * How many dots each pixel has, of all points where that is known.
   * @param {Float32Array} x
   * @param {Float32Array} y
   * @param {number} every
   */
  cloud(x, y, every) {
    const frame = JSON.stringify(this.frame);
    const at = this.clouds.findIndex((one) => one.x === x && one.y === y && one.frame === frame);
    if (at < 0 && every > 1) return cloudOf(x, y, this.frame, every);
    const [known] = at < 0 ? [{ x, y, frame, cloud: cloudOf(x, y, this.frame) }] : this.clouds.splice(at, 1);
    this.clouds = [...this.clouds.slice(1 - CLOUDS), known];
    return known.cloud;
  }

  /** The pixel of each point of a series, by its number; none where it is not there. @param {number} at */
  pixels(at) {
    const { x, series } = this.contents ?? { x: null, series: [] };
    const y = series[at]?.y;
    if (!x || !y || this.frame.width === 0) return new Int32Array(0);
    const frame = JSON.stringify(this.frame);
    const known = this.placed[at];
    if (known?.x === x && known.y === y && known.frame === frame) return known.pixels;
    const pixels = place(x, y, this.frame);
    this.placed[at] = { x, y, frame, pixels };
    return pixels;
  }

  /** @param {number} width @param {number} height */
  drawFrame(width, height) {
    this.axes.width = Math.round(width * this.scale);
    this.axes.height = Math.round(height * this.scale);
    const brush = this.axes.getContext("2d");
    if (!brush || !this.contents) return;
    const { title, xAxis, yAxis, noise, bins, spectrum } = this.contents;
    const names = ["--ink", "--soft", "--grid", "--band", "--wrong"];
    const [ink, soft, line, band, wrong] = names.map((name) => this.colour(name));
    const colours = { ink, soft, line, band, wrong };
    brush.scale(this.scale, this.scale);
    drawAxes(brush, { width, height }, { x: xAxis, y: yAxis, title, colours, noise, bins, spectrum });
  }

  /**
   * Draw the second layer.
   * @param {Uint32Array | null} chosen indices of samples
   * @param {{y: Float32Array, colour: string} | null} above a cloud over the others: what an effect would explain
   * @param {number} [every] of how many chosen points one is drawn, until all of them are
   */
  drawLight(chosen, above, every = Math.max(1, Math.ceil((chosen?.length ?? 0) / LIT_AT_ONCE))) {
    clearTimeout(this.unlit);
    if (!this.contents || this.frame.width === 0) return;
    if (every > 1) this.unlit = setTimeout(() => this.drawLight(chosen, above, 1), REST_MS);
    this.element.classList.toggle("dimmed", chosen !== null);
    const image = new ImageData(this.frame.width, this.frame.height);
    const pixels = new Uint32Array(image.data.buffer);
    if (chosen) {
      for (const [at, { chosen: name }] of this.contents.series.entries()) {
        if (!name) continue;
        const colour = pixelColour(this.colour(name));
        if (chosen.length <= FEW_CHOSEN) drawFew(pixels, this.pixels(at), chosen, this.frame, colour);
        else drawPoints(pixels, this.pixels(at), chosen, this.frame, colour, every);
      }
    }
    if (above) {
      const spots = place(this.contents.x, above.y, this.frame);
      drawPoints(pixels, spots, null, this.frame, pixelColour(this.colour(above.colour)));
    }
    this.light.getContext("2d")?.putImageData(image, 0, 0);
  }

  /** Sort the points for the brush, once per change of the data: when it is put on, before it moves. */
  sorted() {
    const picked = this.pixels(this.contents?.picked ?? 0);
    this.pick ??= new Pick(picked, this.frame.width, this.frame.height);
    return this.pick;
  }

  /**
   * The samples in the brushed region; valid until the next call.
   * @returns {Uint32Array | null}
   */
  chosen() {
    if (!this.region || !this.contents || this.frame.width === 0) return null;
    const { left, top, width, height } = this.boxInside(this.region);
    const [wide, high] = [this.frame.width, this.frame.height];
    const half = this.frame.dot / 2; // a point is taken by its middle
    return this.sorted().inside({
      left: Math.max(0, Math.ceil(left * wide - half)),
      right: Math.min(wide - 1, Math.floor((left + width) * wide - half)),
      top: Math.max(0, Math.ceil(top * high - half)),
      bottom: Math.min(high - 1, Math.floor((top + height) * high - half)),
    });
  }

  /**
   * Where a region lies, in shares of the drawn area from the upper left.
   * @param {Region} region
   */
  boxInside(region) {
    const { x, y } = this.frame;
    const [left, right] = region.x.map((value) => (value - x[0]) / (x[1] - x[0]));
    const [bottom, top] = region.y.map((value) => (y[1] - value) / (y[1] - y[0]));
    return { left, top, width: right - left, height: bottom - top };
  }

  /** Mark where a sample is; nowhere, if it is not drawn. @param {number | null} at */
  mark(at) {
    this.marked = at;
    const pixel = at === null ? -1 : (this.pixels(this.contents?.picked ?? 0)[at] ?? -1);
    this.dot.hidden = pixel < 0;
    if (pixel < 0) return;
    const { width, dot } = this.frame;
    const row = (pixel / width) | 0;
    const [x, y] = [pixel - row * width, row].map((one) => (one + dot / 2) / this.scale);
    this.dot.style.transform = `translate(${MARGIN.left + x}px, ${MARGIN.top + y}px)`;
  }

  /** @param {Region | null} region */
  setRegion(region) {
    this.region = region;
    this.drawBox();
  }

  /** Put the rectangle where the region is. */
  drawBox() {
    this.box.hidden = this.region === null;
    if (!this.region) return;
    const wide = this.element.clientWidth - MARGIN.left - MARGIN.right;
    const high = this.element.clientHeight - MARGIN.top - MARGIN.bottom;
    const box = this.boxInside(this.region);
    const [left, right] = [box.left, box.left + box.width].map((share) => Math.min(1, Math.max(0, share)));
    const [top, bottom] = [box.top, box.top + box.height].map((share) => Math.min(1, Math.max(0, share)));
    this.box.style.transform = `translate(${MARGIN.left + left * wide}px, ${MARGIN.top + top * high}px)`;
    this.box.style.width = `${(right - left) * wide}px`;
    this.box.style.height = `${(bottom - top) * high}px`;
  }
}

/** @param {Float32Array} x @param {import("./axes.js").Axis} axis */
function fewBetween(x, { low, high }) {
  let count = 0;
  for (let i = 0; i < x.length && count <= FEW; i++) if (x[i] >= low && x[i] <= high) count++;
  return count <= FEW;
}
