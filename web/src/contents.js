/** What the plots show of the data: columns, axes, colours. */

import { limits } from "./axes.js";
import { spectrumOf } from "./spectrum.js";
import { number, torqueScale, torqueWord } from "./numbers.js";
import { beyondWords, mostLimits, mostReach } from "./outliers.js";
import { remembered } from "./remembered.js";

/** @typedef {import("./store.js").Columns} Columns */
/** @typedef {import("./plot.js").Contents} Contents */
/** @typedef {import("./types.js").Seen["axes"][number]} Along */

/**
 * What the plots are made of.
 * @typedef {{columns: Columns, unit: string, peak: number, coordinate: "rotary" | "linear", noise: number | null, fitted: boolean, several?: boolean,
 *   of?: string, below_hz?: number | null, name?: string, beside?: Beside | null, splits?: import("./types.js").Split[] | null}} Data
 * `columns`: t, theta, omega, tau, residual; for isolated components also position_part and velocity_part; for
 * the band also band; over time `masked`, what was recorded of masked samples. `fitted`: no parameter is dragged
 * away from the fit. `several` captures, one after the other, have each a time of its own. `of`: which captures they
 * are, however they were read. `below_hz`: what is faster is
 * filtered off. `name`: of the branch.
 * `splits`: where the error lies, as soon as that is known
 * @typedef {{name: string, residual: Float32Array}} Beside another branch of the same captures
 * @typedef {import("./types.js").Seen} View
 * `held`: the residuals keep the scale of the worst fit, so that they are seen to fall
 * @typedef {{torque: Contents | null, residual: Contents, beside: Contents | null}} Row over one axis
 * @typedef {{words: string, column: string | null, part: string | null, units: [string, string] | null}} AxisOf
 * `column`: null for the torque of the model itself; `part`: what of the model depends on it alone; `units` rotary
 * and linear, null for a torque
 */

/** What torques and residuals can be drawn over: the axes that an error is split along and that samples have. */
export const AXES = /** @type {Record<Along, AxisOf>} */ ({
  position: { words: "position", column: "theta", part: "position_part", units: ["rad", "m"] },
  velocity: { words: "velocity", column: "omega", part: "velocity_part", units: ["rad/s", "m/s"] },
  acceleration: { words: "acceleration", column: "alpha", part: null, units: ["rad/s²", "m/s²"] },
  load: { words: "modelled torque", column: null, part: null, units: null },
  history: { words: "distance since reversal", column: "history", part: null, units: ["rad", "m"] },
  time: { words: "time", column: "t", part: null, units: ["s", "s"] },
  frequency: { words: "frequency", column: null, part: null, units: ["Hz", "Hz"] },
});

/** What they are drawn over before a person chooses. @type {Along[]} */
export const USUAL = ["position", "velocity", "time"];

const NAME = 32; // letters of a branch's name in a title

/**
 * The columns that a view needs.
 * @param {View} view
 * @returns {string[]}
 */
export function columnsOf(view) {
  const needed = ["t", "theta", "omega", "tau", "residual"];
  for (const { column } of view.axes.map((along) => AXES[along])) if (column && !needed.includes(column)) needed.push(column);
  if (view.axes.includes("time")) needed.push("masked");
  if (view.isolated) needed.push("position_part", "velocity_part");
  if (view.band) needed.push("band");
  return needed;
}

/**
 * How far the residuals reach from zero, in SI, but for a few that would flatten all others.
 * @param {Data} data
 */
export function reachOf({ columns, beside, noise }) {
  const shown = beside ? [columns.residual, beside.residual] : [columns.residual];
  return Math.max(...shown.map((one) => mostReach(one)), 2 * (noise ?? 0)) || 1;
}

/**
 * What each row of plots shows.
 * @param {Data} data
 * @param {View} view
 * @param {number} widest that the residuals' axes reach, SI
 * @returns {Row[]}
 */
export function rowsOf(data, view, widest) {
  const { columns, beside } = data;
  const word = torqueWord(data.unit);
  const slow = data.below_hz ? ` below ${number(data.below_hz)} Hz` : ""; // measured and modelled, through one filter
  const model = modelOf(columns.residual, columns.tau);
  const fitted = counted(model, columns.tau);
  const unfitted = notCounted(fitted, columns.tau, columns.masked ?? fitted);
  const other = beside ? modelOf(beside.residual, columns.tau) : null;
  const scale = torqueScale(data);
  const [ownLabel, besideLabel] = [columns, beside].map((one) => (one ? `residual, ${scale.unit}${beyondWords(one.residual, -1.04 * widest, 1.04 * widest)}` : ""));
  return view.axes.map((along) => {
    if (along === "frequency") return { torque: null, residual: alongFrequency(data), beside: null };
    const axis = AXES[along];
    const x = axis.column ? columns[axis.column] : model;
    const common = { x, xAxis: axisOf(along, along === "time" ? span(x) : spanOf(model)(x), data), picked: 0 };
    const part = view.isolated && axis.part ? columns[axis.part] : null;
    const { measured, modelled } = part ? isolated(columns, part) : { measured: fitted, modelled: model };
    const series = [
      ...(along === "time" ? [{ colour: "--masked", chosen: "--chosen", y: unfitted, strength: 1 }] : []),
      { colour: "--measured", chosen: "--chosen", y: measured, strength: 0.4 },
      ...(view.band && columns.band ? band(modelled, columns.band) : []),
      ...(other && !part ? [{ colour: "--beside", chosen: "--beside", y: other, strength: 0.35 }] : []),
      { colour: "--modelled", chosen: "--modelled", y: modelled, strength: 0.35 },
    ];
    const [lowest, highest] = limits([Float32Array.from(mostLimits(modelled, measured))]);
    const torque = {
      ...common,
      picked: series.findIndex(({ colour }) => colour === "--measured"), // what is not fitted is not taken by a brush
      xAxis: { ...common.xAxis, label: "" }, // where it is chosen it stands already
      yAxis: { low: lowest, high: highest, factor: scale.factor, label: `${word}${slow}, ${scale.unit}${beyondWords(measured, lowest, highest)}` },
      title: part ? `what depends on ${along} alone` : `${word} over ${axisWord(along, data.unit)}`,
      series,
      noise: null,
    };
    const rest = (/** @type {Float32Array} */ y, /** @type {string} */ label, /** @type {string} */ colour, /** @type {string} */ title) => ({
      ...common,
      yAxis: { low: -1.04 * widest, high: 1.04 * widest, factor: scale.factor, label },
      title,
      series: [{ colour, chosen: "--chosen", y, strength: 0.3 }],
      noise: data.noise && 2 * data.noise,
    });
    const own = beside && data.name ? `residual, ${short(data.name)}` : "measured − modelled";
    return {
      torque,
      residual: rest(columns.residual, ownLabel, "--wrong", own),
      beside: beside ? rest(beside.residual, besideLabel, "--beside", `residual, ${short(beside.name)}`) : null,
    };
  });
}

/**
 * The residual over frequency, across the row: what the core says of each bin.
 * @param {Data} data
 * @returns {Contents}
 */
export function alongFrequency({ splits, unit, peak, fitted }) {
  const spectrum = spectrumOf(splits?.find(({ axis }) => axis === "frequency"));
  const [least, most] = spectrum ? limits([spectrum.y, spectrum.chance].map((one) => Float32Array.from(one))) : [-4, -2];
  const [low, high] = spectrum ? [spectrum.x[0], spectrum.x[spectrum.x.length - 1]] : [0, 3];
  const scale = torqueScale({ unit, peak });
  return {
    ...{ x: new Float32Array(0), series: [], picked: 0, noise: null, spectrum },
    title: fitted ? "residual over frequency, beside what chance stays below" : "over frequency: of a fit only",
    xAxis: { low, high, factor: 1, label: "", log: true },
    yAxis: { low: least, high: most, factor: scale.factor, label: `RMS per bin, ${scale.unit}`, log: true },
  };
}

/**
 * An axis that holds all values of a column.
 * @param {Along} along
 * @param {[number, number]} span
 * @param {Data} data
 */
function axisOf(along, [low, high], data) {
  return { low, high, factor: 1, label: labelOf(along, data) };
}

/**
 * What an axis is called where what moves the knob is in this unit; one that is none by its name.
 * @param {string} along
 * @param {string} unit
 */
export function axisWord(along, unit) {
  return along === "load" ? `modelled ${torqueWord(unit)}` : (AXES[/** @type {Along} */ (along)]?.words ?? along);
}

/**
 * An axis with its unit, in words.
 * @param {Along} along
 * @param {{unit: string, coordinate: "rotary" | "linear"}} data
 */
export function labelOf(along, { unit, coordinate }) {
  const { units } = AXES[along];
  return `${axisWord(along, unit)}, ${units ? units[coordinate === "linear" ? 1 : 0] : unit}`;
}

/**
 * The samples that lie between two values of an axis, moving forward (1), backward (-1) or either way (0); null
 * along frequency, of which no sample has a value.
 * @param {Data} data
 * @param {{axis: Along, low: number, high: number, direction: number}} place
 * @returns {Uint32Array | null}
 */
export function samplesIn({ columns }, { axis, low, high, direction }) {
  if (axis === "frequency") return null;
  const { column } = AXES[axis];
  const x = column ? columns[column] : modelOf(columns.residual, columns.tau);
  const found = [];
  for (let i = 0; i < x.length; i++) {
    const counts = columns.residual[i] === columns.residual[i] && x[i] >= low && x[i] <= high;
    if (counts && (direction === 0 || Math.sign(columns.omega[i]) === direction)) found.push(i);
  }
  return Uint32Array.from(found);
}

/** What is modelled: what was measured less what is left. */
const modelOf = remembered((/** @type {Float32Array} */ residual, /** @type {Float32Array} */ tau) => {
  const model = new Float32Array(tau.length);
  for (let i = 0; i < tau.length; i++) model[i] = tau[i] - residual[i];
  return model;
});

/**
 * What was measured where the model is held against it: what counts for nothing sets no axis, and is no dot. Another model
 * of the same samples has the same, which is then drawn already.
 * @param {Float32Array} model
 * @param {Float32Array} tau
 */
function counted(model, tau) {
  const known = lastCounted.get(tau);
  if (known && sameGaps(known, tau, model)) return known;
  const found = new Float32Array(tau.length);
  for (let i = 0; i < tau.length; i++) found[i] = model[i] === model[i] ? tau[i] : NaN;
  lastCounted.set(tau, found);
  return found;
}

/** @type {WeakMap<Float32Array, Float32Array>} */
const lastCounted = new WeakMap();

/** Whether what counts of a column is what a model is held against. @param {Float32Array} found @param {Float32Array} tau @param {Float32Array} model */
function sameGaps(found, tau, model) {
  for (let i = 0; i < tau.length; i++) if (tau[i] === tau[i] && (found[i] === found[i]) !== (model[i] === model[i])) return false;
  return true;
}

/** What was recorded where nothing is fitted to it, be it masked, at rest or at an end. */
const notCounted = remembered((/** @type {Float32Array} */ fitted, /** @type {Float32Array} */ tau, /** @type {Float32Array} */ masked) => {
  const found = new Float32Array(tau.length);
  for (let i = 0; i < tau.length; i++) found[i] = fitted[i] === fitted[i] ? NaN : masked[i] === masked[i] ? masked[i] : tau[i];
  return found;
});

const AIR = 0.01; // of an axis, beyond its ends
const span = remembered((/** @type {Float32Array} */ x) => limits([x], { air: AIR }));

/** From where to where a column goes where a model is held against it; asked of a model first, which is forgotten sooner. */
const spanOf = remembered((/** @type {Float32Array} */ model) =>
  remembered((/** @type {Float32Array} */ x) => {
    let [low, high] = [NaN, NaN];
    for (let i = 0; i < x.length; i++) {
      if (model[i] !== model[i]) continue;
      if (!(x[i] >= low)) low = x[i] === x[i] ? x[i] : low;
      if (!(x[i] <= high)) high = x[i] === x[i] ? x[i] : high;
    }
    return limits([Float32Array.of(low, high)], { air: AIR });
  }),
);

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
