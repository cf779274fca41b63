/** What the plots show of the data: columns, axes, colours. */

import { limits } from "./axes.js";
import { torqueScale, torqueWord } from "./numbers.js";

/** @typedef {import("./store.js").Columns} Columns */
/** @typedef {import("./plot.js").Contents} Contents */

/**
 * What the plots are made of.
 * @typedef {{columns: Columns, unit: string, coordinate: "rotary" | "linear", noise: number | null, fitted: boolean,
 *   name?: string, beside?: Beside | null}} Data
 * `columns`: t, theta, omega, tau, residual; for isolated components also position_part and velocity_part; for
 * the band also band. `fitted`: no parameter is dragged away from the fit. `name`: of the branch
 * @typedef {{name: string, residual: Float32Array}} Beside another branch of the same captures
 * @typedef {{isolated: boolean, band: boolean, held: boolean}} View
 * `held`: the residuals keep the scale of the worst fit, so that they are seen to fall
 * @typedef {{torque: Contents, residual: Contents, beside: Contents | null}} Row over one coordinate
 */

export const ROWS = /** @type {const} */ ([
  { over: "position", column: "theta", part: "position_part", units: { linear: "m", rotary: "rad" } },
  { over: "velocity", column: "omega", part: "velocity_part", units: { linear: "m/s", rotary: "rad/s" } },
  { over: "time", column: "t", part: null, units: { linear: "s", rotary: "s" } },
]);

const NAME = 32; // letters of a branch's name in a title

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

/**
 * How far the residuals reach from zero, in SI.
 * @param {Data} data
 */
export function reachOf({ columns, beside, noise }) {
  const [low, high] = limits(beside ? [columns.residual, beside.residual] : [columns.residual], { around: 0 });
  return Math.max(-low, high, 2 * (noise ?? 0));
}

/**
 * What each row of plots shows.
 * @param {Data} data
 * @param {View} view
 * @param {number} widest that the residuals' axes reach, SI
 * @returns {Row[]}
 */
export function rowsOf(data, view, widest) {
  const { columns, beside, coordinate } = data;
  const word = torqueWord(data.unit);
  const model = less(columns.tau, columns.residual);
  const other = beside ? less(columns.tau, beside.residual) : null;
  return ROWS.map((row) => {
    const x = columns[row.column];
    const [low, high] = limits([x], { air: 0.01 });
    const common = { x, xAxis: { low, high, factor: 1, label: `${row.over}, ${row.units[coordinate]}` }, picked: 0 };
    const part = view.isolated && row.part ? columns[row.part] : null;
    const { measured, modelled } = part ? isolated(columns, part) : { measured: columns.tau, modelled: model };
    const series = [
      { colour: "--measured", chosen: "--chosen", y: measured, strength: 0.4 },
      ...(view.band && columns.band ? band(modelled, columns.band) : []),
      ...(other && !part ? [{ colour: "--beside", chosen: "--beside", y: other, strength: 0.35 }] : []),
      { colour: "--modelled", chosen: "--modelled", y: modelled, strength: 0.35 },
    ];
    const [lowest, highest] = limits([measured, modelled]);
    const scale = torqueScale(data.unit, Math.max(-lowest, highest));
    const torque = {
      ...common,
      yAxis: { low: lowest, high: highest, factor: scale.factor, label: `${word}, ${scale.unit}` },
      title: part ? `what depends on ${row.over} alone` : `${word} over ${row.over}`,
      series,
      noise: null,
    };
    const fine = torqueScale(data.unit, widest);
    const rest = (/** @type {Float32Array} */ y, /** @type {string} */ colour, /** @type {string} */ title) => ({
      ...common,
      yAxis: { low: -1.04 * widest, high: 1.04 * widest, factor: fine.factor, label: `residual, ${fine.unit}` },
      title,
      series: [{ colour, chosen: "--chosen", y, strength: 0.3 }],
      noise: data.noise && 2 * data.noise,
    });
    const own = beside && data.name ? `residual, ${short(data.name)}` : "measured − modelled";
    return {
      torque,
      residual: rest(columns.residual, "--wrong", own),
      beside: beside ? rest(beside.residual, "--beside", `residual, ${short(beside.name)}`) : null,
    };
  });
}

/** @param {Float32Array} from @param {Float32Array} what */
function less(from, what) {
  return from.map((value, i) => value - what[i]);
}

/** @param {string} name */
function short(name) {
  return name.length > NAME ? `${name.slice(0, NAME)}…` : name;
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
