/** The linked plots: torque over three axes that a person chooses, the residual of each beside it. */

import { brushable } from "./brush.js";
import { AXES, USUAL, alongFrequency, axisWord, labelOf, reachOf, rowsOf, samplesIn } from "./contents.js";
import { pointing } from "./cursor.js";
import { make } from "./dom.js";
import { number, percent, thousands, torqueScale } from "./numbers.js";
import { Plot } from "./plot.js";
import { movesFrom, settle } from "./settling.js";
import { chosenSquares, squaresOf } from "./squares.js";
import { idle, timed } from "./timing.js";
import { panned, zoomable, zoomed } from "./zoom.js";

/** @typedef {import("./plot.js").Region} Region */
/** @typedef {import("./contents.js").Data} Data */
/** @typedef {import("./contents.js").Along} Along */
/** @typedef {import("./contents.js").Row} Row */
/** @typedef {import("./contents.js").View} View */
/** @typedef {import("./zoom.js").Range} Range */

export class Linked {
  /**
   * @param {(words: string | null) => void} told about the chosen samples; null when none are
   * @param {(axes: Along[]) => void} picked what the rows shall be drawn over; they are once they are shown
   * @param {{fetched?: boolean, pointed?: (data: Data | null, at: number | null) => void}} [more] `fetched`: there is a
   * column for every axis, as soon as it is asked for; `pointed`: told which sample is pointed at
   */
  constructor(told, picked, { fetched = false, pointed = () => {} } = {}) {
    this.told = told;
    this.fetched = fetched;
    const brushed = (/** @type {Plot} */ plot, /** @type {Region | null} */ region) => this.brush(plot, region);
    const column = () => USUAL.map(() => new Plot("", brushed));
    this.torques = column();
    this.residuals = column();
    this.besides = column();
    this.rows = USUAL.map((_, at) => [this.torques[at], this.residuals[at], this.besides[at]]);
    this.plots = this.rows.flat();
    this.pickers = USUAL.map((_, at) => picker(at, (along) => picked(this.axes.with(at, along))));
    this.element = make("div", { class: "linked" }, ...this.plots.map(({ element }) => element), ...this.pickers);
    for (const [at, { element }] of this.plots.entries()) {
      element.classList.toggle("beside", at % 3 === 2);
      put(element, Math.floor(at / 3) + 1, (at % 3) + 1);
    }
    const deeds = {
      zoom: (/** @type {Plot} */ plot, /** @type {number} */ at, /** @type {number} */ factor) =>
        this.look(plot, (seen, whole) => zoomed(seen, whole, at, factor)),
      pan: (/** @type {Plot} */ plot, /** @type {number} */ share) =>
        this.look(plot, (seen, whole) => panned(seen, whole, share)),
      whole: (/** @type {Plot} */ plot) => this.look(plot, () => null),
    };
    for (const plot of this.plots) {
      brushable(plot);
      zoomable(plot, deeds);
    }
    this.moment = pointing(this.plots, () => this.data?.columns.t ?? null, (at) => pointed(this.data, at));
    /** @type {Data | null} */
    this.data = null;
    /** @type {Row[]} */
    this.shown = [];
    /** @type {Along[]} */
    this.axes = USUAL;
    /** @type {(Range | null)[]} what is seen of each row's x axis; null: everything */
    this.seen = USUAL.map(() => null);
    /** @type {Map<Plot, Range>} what is seen of a plot's y axis, where not everything is */
    this.heights = new Map();
    /** @type {Uint32Array | null} */
    this.chosen = null;
    /** @type {Float32Array | null} */
    this.signature = null;
    /** @type {Set<string>} */
    this.waiting = new Set();
    this.widest = 0;
    this.squares = 0; // of the residual, all together
    this.sized = new ResizeObserver(() => this.redraw());
    this.sized.observe(this.element);
  }

  /**
   * Show data; the same samples stay chosen where there are as many as before.
   * @param {Data} data
   * @param {View} view
   */
  show(data, view) {
    const { columns } = data;
    if (this.data && (this.data.columns.t.length !== columns.t.length || this.data.of !== data.of)) {
      this.clear();
      this.moment.none();
      this.seen.fill(null);
      this.heights.clear();
      this.widest = 0;
    }
    this.drawOver(view.axes, data);
    const from = movesFrom(this.data, data);
    this.data = data;
    this.signature = null;
    this.squares = squaresOf(columns.residual);
    const reach = reachOf(data);
    if (data.fitted) this.widest = Math.max(this.widest, reach);
    this.element.classList.toggle("both", Boolean(data.beside));
    if (!data.beside) for (const plot of this.besides) plot.setRegion(null);
    this.shown = rowsOf(data, view, view.held ? Math.max(this.widest, reach) : reach);
    if (from) this.put(from);
    for (const at of this.rows.keys()) this.drawRow(at);
    this.tell();
    this.drawLight();
    this.prepare(data);
    if (from) settle(from, columns.residual, (residual) => this.shows(data) && this.moved(residual));
  }

  /** Whether these samples are still shown; their bins may have come in meanwhile. @param {Data} data */
  shows = ({ columns }) => this.data?.columns === columns;

  /** Work out, while nothing else is to be done, where each point of what a brush lights up is. @param {Data} data */
  prepare(data) {
    const left = this.plots.flatMap((plot) => (plot.contents?.series ?? []).map(({ chosen }, at) => (chosen ? { plot, at } : null)));
    const go = () => {
      const one = left.shift();
      if (one === undefined || !this.shows(data)) return;
      if (one && !one.plot.element.hidden) one.plot.pixels(one.at);
      idle(go);
    };
    idle(go);
  }

  /** Let the residuals be these, though others come. @param {Float32Array} residual */
  put(residual) {
    for (const row of this.shown) if (row.torque) row.residual = { ...row.residual, series: [{ ...row.residual.series[0], y: residual }] };
  }

  /** Draw residuals that are on their way. @param {Float32Array} residual */
  moved(residual) {
    this.put(residual);
    for (const at of this.rows.keys()) this.drawRow(at);
    this.drawLight();
    return true;
  }

  /**
   * Let the rows be drawn over these axes: of another one everything is seen, and no rectangle is on it.
   * @param {Along[]} axes
   * @param {Data} data
   */
  drawOver(axes, data) {
    const kinds = ["torque over %, measured and modelled", "residual over %", "residual over % of the branch beside"];
    const all = /** @type {Along[]} */ (Object.keys(AXES));
    const there = (/** @type {Along} */ one) => one !== "frequency" && (AXES[one].column ?? "tau") in data.columns;
    const offered = all.filter((one) => this.fetched || there(one));
    for (const [at, along] of axes.entries()) {
      showPicked(this.pickers[at], offered, { along, data });
      for (const element of [this.residuals[at].element, this.pickers[at]]) element.classList.toggle("wide", along === "frequency");
      for (const kind of [0, 2]) this.rows[at][kind].element.toggleAttribute("hidden", along === "frequency");
      for (const [kind, plot] of this.rows[at].entries()) {
        plot.element.setAttribute("aria-label", kinds[kind].replace("%", axisWord(along, data.unit)));
        if (along === this.axes[at]) continue;
        plot.setRegion(null);
        this.heights.delete(plot);
      }
      if (along !== this.axes[at]) this.seen[at] = null;
    }
    this.axes = axes;
  }

  /**
   * Choose what lies where a verdict says that the model fails, and mark it on the residuals over that axis.
   * @param {import("./types.js").Stretch} place
   */
  mark(place) {
    const at = this.axes.indexOf(place.axis);
    if (!this.data || at < 0) return;
    this.choose(samplesIn(this.data, place));
    const { xAxis, yAxis } = this.shown[at].residual;
    const x = [place.low, place.high].map((value) => (xAxis.log ? Math.max(xAxis.low, Math.log10(value)) : value));
    this.residuals[at].setRegion({ x: [x[0], x[1]], y: [yAxis.low, yAxis.high] });
  }

  /** Choose samples, and see their time from near. @param {Uint32Array} chosen */
  find(chosen) {
    this.choose(chosen);
    const at = this.axes.indexOf("time");
    if (!this.data || at < 0 || chosen.length === 0) return;
    const { t } = this.data.columns;
    const { low, high } = this.shown[at].residual.xAxis;
    const [first, last] = [t[chosen[0]], t[chosen[chosen.length - 1]]];
    const half = Math.max(0.7 * (last - first), 0.01 * (high - low));
    const middle = Math.min(high - half, Math.max(low + half, 0.5 * (first + last)));
    this.seen[at] = 2 * half < 0.5 * (high - low) ? [middle - half, middle + half] : null;
    this.later("zoom", () => {
      this.drawRow(at);
      this.drawLight();
    });
  }

  /** @param {number} at which row */
  drawRow(at) {
    const row = this.shown[at];
    const along = this.data?.splits?.find(({ axis }) => axis === this.axes[at]) ?? null;
    const own = this.axes[at] === "time" && this.data?.several; // the bins are those of one time for all
    const bins = row.residual.spectrum === undefined && !own ? along : null;
    for (const [column, contents] of [row.torque, { ...row.residual, bins }, row.beside].entries()) {
      const plot = this.rows[at][column];
      const [xAxis, yAxis] = [within(contents?.xAxis, this.seen[at]), within(contents?.yAxis, this.heights.get(plot))];
      if (contents && xAxis && yAxis) plot.show({ ...contents, xAxis, yAxis });
    }
  }

  /**
   * Draw where the error lies, in bins beside what chance gives them, over the residuals.
   * @param {import("./types.js").Split[]} splits
   */
  lay(splits) {
    if (!this.data) return;
    this.data = { ...this.data, splits };
    for (const row of this.shown) if (!row.torque) row.residual = alongFrequency(this.data);
    for (const at of this.rows.keys()) this.drawRow(at);
    this.drawLight();
  }

  /** Draw everything anew, for another size or other colours. */
  redraw() {
    for (const plot of this.plots) plot.drawAll();
    this.drawLight();
  }

  /**
   * Look at another part of the x axis that a plot shares with its row.
   * @param {Plot} plot
   * @param {(seen: Range, whole: Range) => Range | null} change
   */
  look(plot, change) {
    const at = this.rows.findIndex((row) => row.includes(plot));
    if (!this.shown[at]) return;
    const { low, high } = this.shown[at].residual.xAxis;
    this.seen[at] = change(this.seen[at] ?? [low, high], [low, high]);
    if (!this.seen[at]) for (const other of this.rows[at]) this.heights.delete(other);
    this.later("zoom", () => {
      this.drawRow(at);
      this.drawLight();
    });
  }

  /** Look at the brushed region as near as it fits; at everything, where none is brushed. */
  lookCloser() {
    const plot = this.plots.find(({ region }) => region);
    const at = this.rows.findIndex((row) => plot && row.includes(plot));
    if (plot?.region) {
      this.seen[at] = plot.region.x;
      this.heights.set(plot, plot.region.y);
      for (const one of this.plots) one.setRegion(null); // its samples stay chosen
    } else {
      this.seen.fill(null);
      this.heights.clear();
    }
    this.later("zoom", () => {
      if (this.data) for (const row of this.rows.keys()) this.drawRow(row);
      this.drawLight();
    });
  }

  /**
   * Choose what lies in a region of one plot; the next frame shows it.
   * @param {Plot} plot
   * @param {Region | null} region
   */
  brush(plot, region) {
    for (const other of this.plots) other.setRegion(other === plot ? region : null);
    this.later("brush", () => {
      const brushed = this.plots.find((one) => one.region);
      this.chosen = brushed?.chosen() ?? null;
      this.drawLight();
      this.tell();
    });
  }

  /** The rectangle that is brushed, by the number of its plot. @returns {import("./types.js").Brush | null} */
  get brushed() {
    const plot = this.plots.findIndex(({ region }) => region);
    const region = this.plots[plot]?.region;
    return region ? { plot, ...region } : null;
  }

  /** @param {import("./types.js").Brush} brush */
  brushAgain({ plot, x, y }) {
    if (this.plots[plot]) this.brush(this.plots[plot], { x, y });
  }

  /**
   * Draw in the next frame; what comes meanwhile is drawn with it.
   * @param {string} what
   * @param {() => void} draw
   */
  later(what, draw) {
    if (this.waiting.has(what)) return;
    this.waiting.add(what);
    timed(what, () => {
      this.waiting.delete(what);
      draw();
    });
  }

  /** Choose nothing. */
  clear() {
    this.choose(null);
  }

  /**
   * Choose samples that no rectangle on this page has chosen.
   * @param {Uint32Array | null} chosen indices
   */
  choose(chosen) {
    for (const plot of this.plots) plot.setRegion(null);
    this.chosen = chosen;
    this.drawLight();
    this.tell();
  }

  /**
   * Lay what an effect would explain over the residuals.
   * @param {Float32Array | null} signature
   */
  overlay(signature) {
    this.signature = signature;
    this.drawLight();
  }

  drawLight() {
    const besides = this.data?.beside ? this.besides : [];
    for (const plot of [...this.torques, ...besides]) plot.drawLight(this.chosen, null);
    const above = this.signature && { y: this.signature, colour: "--signature" };
    for (const plot of this.residuals) plot.drawLight(this.chosen, above);
  }

  /** The part of the squared error that the chosen samples have, and their RMS; null where none are chosen. */
  get share() {
    if (!this.chosen || !this.data) return null;
    const { residual } = this.data.columns;
    const { sum, count } = chosenSquares(residual, this.chosen);
    return { ofError: this.squares > 0 ? sum / this.squares : 0, rms: Math.sqrt(sum / Math.max(1, count)), counted: count };
  }

  tell() {
    const { chosen, data, share } = this;
    if (!chosen || !data || !share) return this.told(null);
    const part = percent(chosen.length / data.columns.t.length);
    const scale = torqueScale(data);
    const rms = (/** @type {number} */ value) => `RMS\u00a0${number(value * scale.factor)}\u00a0${scale.unit}`;
    const count = `${thousands(chosen.length)} ${chosen.length === 1 ? "sample" : "samples"} chosen, ${part} of all`;
    if (share.counted === 0 && chosen.length > 0) return this.told(`${count}: nothing is fitted to them`);
    const own = chosen.length > 0 ? ` (${rms(share.rms)})` : "";
    let words = `${count}: they have ${percent(share.ofError)} of the squared error${own}`;
    if (data.beside && chosen.length > 0) {
      const { sum, count: counted } = chosenSquares(data.beside.residual, chosen);
      words += `; in ${data.beside.name}: ${rms(Math.sqrt(sum / Math.max(1, counted)))}`;
    }
    return this.told(words);
  }
}

/**
 * What a row is drawn over, to be chosen where the name of its axis stands.
 * @param {number} at which row
 * @param {(along: Along) => void} picked
 */
function picker(at, picked) {
  const choice = make("select", {
    ...{ class: "along", "aria-label": `axis of row ${at + 1}`, title: "what this row is drawn over" },
    on: { change: () => picked(/** @type {Along} */ (choice.value)) },
  });
  put(choice, at + 1, 1);
  return choice;
}

/** Where the style sheet has a grid. @param {HTMLElement} element @param {number} row @param {number} column */
function put(element, row, column) {
  element.style.setProperty("--row", String(row));
  element.style.setProperty("--column", String(column));
}

/**
 * @param {HTMLSelectElement} choice
 * @param {Along[]} offered
 * @param {{along: Along, data: Data}} shown
 */
function showPicked(choice, offered, { along, data }) {
  const texts = offered.map((one) => labelOf(one, data));
  if ([...choice.options].map(({ text }) => text).join() !== texts.join()) {
    choice.replaceChildren(...offered.map((value, at) => make("option", { value, text: texts[at] })));
  }
  choice.value = along;
}

/**
 * An axis of which only a part is seen.
 * @template {{low: number, high: number}} A
 * @param {A | undefined} axis
 * @param {Range | null | undefined} seen
 */
function within(axis, seen) {
  return axis && seen ? { ...axis, low: seen[0], high: seen[1], part: true } : axis;
}
