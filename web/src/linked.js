/** The linked plots: torque over position, velocity and time, the residual of each beside it. */

import { limits } from "./axes.js";
import { brushable } from "./brush.js";
import { make } from "./dom.js";
import { number, percent, torqueScale } from "./numbers.js";
import { Plot } from "./plot.js";
import { timed } from "./timing.js";

/** @typedef {import("./types.js").Columns} Columns */
/** @typedef {import("./plot.js").Region} Region */

/**
 * What the plots are made of.
 * @typedef {{columns: Columns, unit: string, axis: string, noise: number | null, fitted: boolean}} Data
 * `columns`: t, theta, omega, tau, residual; for isolated components also position_part and velocity_part; for
 * the band also band. `fitted`: no parameter is dragged away from the fit
 * @typedef {{isolated: boolean, band: boolean, held: boolean}} View
 * `held`: the residuals keep the scale of the worst fit, so that they are seen to fall
 */

const ROWS = /** @type {const} */ ([
  { over: "position", column: "theta", part: "position_part", units: { linear: "m", rotary: "rad" } },
  { over: "velocity", column: "omega", part: "velocity_part", units: { linear: "m/s", rotary: "rad/s" } },
  { over: "time", column: "t", part: null, units: { linear: "s", rotary: "s" } },
]);

/**
 * The columns that a view needs.
 * @param {View} view
 * @returns {string[]}
 */
export function columnsOf(view) {
  const needed = ["t", "theta", "omega", "tau", "residual"];
  if (view.isolated) needed.push("position_part", "velocity_part");
  if (view.band) needed.push("band");
  return needed;
}

export class Linked {
  /** @param {(words: string | null) => void} told about the chosen samples; null when none are */
  constructor(told) {
    this.told = told;
    const brushed = (/** @type {Plot} */ plot, /** @type {Region | null} */ region) => this.brush(plot, region);
    this.torques = ROWS.map(({ over }) => new Plot(`torque over ${over}, measured and modelled`, brushed));
    this.residuals = ROWS.map(({ over }) => new Plot(`residual over ${over}`, brushed));
    this.plots = ROWS.flatMap((_, at) => [this.torques[at], this.residuals[at]]);
    this.element = make("div", { class: "linked" }, ...this.plots.map(({ element }) => element));
    for (const plot of this.plots) brushable(plot);
    /** @type {Data | null} */
    this.data = null;
    /** @type {Uint32Array | null} */
    this.chosen = null;
    /** @type {Float32Array | null} */
    this.signature = null;
    this.waiting = false;
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
    const model = columns.tau.map((tau, i) => tau - columns.residual[i]);
    if (this.data && this.data.columns.t.length !== columns.t.length) {
      this.clear();
      this.widest = 0;
    }
    this.data = data;
    this.signature = null;
    this.squares = columns.residual.reduce((sum, value) => (value === value ? sum + value * value : sum), 0);
    const word = data.axis === "linear" ? "force" : "torque";
    const rest = limits([columns.residual], { around: 0 });
    const reach = Math.max(-rest[0], rest[1], 2 * (data.noise ?? 0));
    if (data.fitted) this.widest = Math.max(this.widest, reach);
    const widest = view.held ? Math.max(this.widest, reach) : reach;
    for (const [at, row] of ROWS.entries()) {
      const axis = data.axis === "linear" ? "linear" : "rotary";
      const [low, high] = limits([columns[row.column]], { air: 0.01 });
      const xAxis = { low, high, factor: 1, label: `${row.over}, ${row.units[axis]}` };
      const common = { x: columns[row.column], xAxis };
      const part = view.isolated && row.part ? columns[row.part] : null;
      const { measured, modelled } = part ? isolated(columns, part) : { measured: columns.tau, modelled: model };
      const [lowest, highest] = limits([measured, modelled]);
      const scale = torqueScale(data.unit, Math.max(-lowest, highest));
      const series = [
        { colour: "--measured", chosen: "--chosen", y: measured, strength: 0.4 },
        ...(view.band && columns.band ? band(modelled, columns.band) : []),
        { colour: "--modelled", chosen: "--modelled", y: modelled, strength: 0.35 },
      ];
      this.torques[at].show({
        ...common,
        yAxis: { low: lowest, high: highest, factor: scale.factor, label: `${word}, ${scale.unit}` },
        title: part ? `what depends on ${row.over} alone` : `${word} over ${row.over}`,
        series,
        picked: 0,
        noise: null,
      });
      const fine = torqueScale(data.unit, widest);
      this.residuals[at].show({
        ...common,
        yAxis: { low: -1.04 * widest, high: 1.04 * widest, factor: fine.factor, label: `residual, ${fine.unit}` },
        title: "measured − modelled",
        series: [{ colour: "--wrong", chosen: "--chosen", y: columns.residual, strength: 0.3 }],
        picked: 0,
        noise: data.noise && 2 * data.noise,
      });
    }
    this.tell();
    this.drawLight();
  }

  /** Draw everything anew, for another size or other colours. */
  redraw() {
    for (const plot of this.plots) plot.drawAll();
    this.drawLight();
  }

  /**
   * Choose what lies in a region of one plot; the next frame shows it.
   * @param {Plot} plot
   * @param {Region | null} region
   */
  brush(plot, region) {
    for (const other of this.plots) other.setRegion(other === plot ? region : null);
    if (this.waiting) return;
    this.waiting = true;
    timed("brush", () => {
      this.waiting = false;
      const brushed = this.plots.find((one) => one.region);
      this.chosen = brushed?.chosen() ?? null;
      this.drawLight();
      this.tell();
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
    for (const plot of this.torques) plot.drawLight(this.chosen, null);
    const above = this.signature && { y: this.signature, colour: "--signature" };
    for (const plot of this.residuals) plot.drawLight(this.chosen, above);
  }

  /** The part of the squared error that the chosen samples have, and their RMS; null where none are chosen. */
  get share() {
    if (!this.chosen || !this.data) return null;
    const { residual } = this.data.columns;
    let [sum, count] = [0, 0];
    for (let at = 0; at < this.chosen.length; at++) {
      const value = residual[this.chosen[at]];
      if (value !== value) continue;
      sum += value * value;
      count++;
    }
    return { ofError: this.squares > 0 ? sum / this.squares : 0, rms: Math.sqrt(sum / Math.max(1, count)) };
  }

  tell() {
    const { chosen, data, share } = this;
    if (!chosen || !data || !share) return this.told(null);
    const part = percent(chosen.length / data.columns.t.length);
    const scale = torqueScale(data.unit, share.rms);
    const rms = chosen.length > 0 ? ` (RMS ${number(share.rms * scale.factor)} ${scale.unit})` : "";
    const count = chosen.length.toLocaleString("en");
    return this.told(
      `${count} samples chosen, ${part} of all: they have ${percent(share.ofError)} of the squared error${rms}`,
    );
  }
}

/**
 * One component alone: modelled, and measured less everything else that is modelled.
 * @param {Columns} columns
 * @param {Float32Array} part
 */
function isolated({ residual }, part) {
  return { measured: part.map((value, i) => value + residual[i]), modelled: part };
}

/**
 * The edges of the 95 % band around the model.
 * @param {Float32Array} modelled
 * @param {Float32Array} half width of the band to one side
 */
function band(modelled, half) {
  return [-1, 1].map((side) => ({
    colour: "--band",
    chosen: null,
    y: modelled.map((value, i) => value + side * half[i]),
    strength: 0.6,
  }));
}
