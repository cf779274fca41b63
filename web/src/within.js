/** Within which limits a motion is designed: those that the captures reached, unless others are typed. */

import { byId } from "./dom.js";
import { enoughWords, limitFactor, limitWords } from "./evidence.js";
import { aboutOf } from "./said.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Enough} Enough */

const DIGITS = 4;

export class Within {
  /** @param {() => unknown} design anew, within what is `wanted` by then */
  constructor(design) {
    /** @type {Record<string, number | string>} what was typed and is other than what was reached, by name */
    this.wanted = {};
    /** @type {Record<string, number>} what the captures reached */
    this.reached = {};
    this.unit = "";
    /** @type {import("./said.js").About | null} */
    this.about = null;
    this.shown = ""; // what the fields were filled with: what is being typed stays
    /** @type {Enough | null} */
    this.enough = null;
    byId("next-limits").addEventListener("submit", (event) => {
      event.preventDefault();
      this.read();
      design();
    });
    byId("next-enough").addEventListener("click", () => {
      if (!this.enough) return;
      this.wanted = { ...this.wanted, ...wider(this.enough, this.all) };
      design();
    });
  }

  /** All limits as they are wanted. @returns {Record<string, number>} */
  get all() {
    return /** @type {Record<string, number>} */ ({ ...this.reached, ...this.wanted });
  }

  /** Take what is typed; a field that is empty, or as it was filled, is for what the captures reached. */
  read() {
    this.wanted = {};
    for (const { name, value, validity } of this.fields) {
      if (validity.badInput) this.wanted[name] = "no number"; // the program says what is wrong with it
      else if (value.trim() !== "" && Number(value) !== this.shows(name, this.reached[name])) this.wanted[name] = Number(value) / this.factor(name);
    }
    this.shown = ""; // so that what is empty is filled again
  }

  /** By what a limit in SI is shown. @param {string} name */
  factor(name) {
    return this.about ? limitFactor(name, this.about) : 1;
  }

  /** A limit in SI as its field has it. @param {string} name @param {number} value */
  shows(name, value) {
    return shownLimit(name, value * this.factor(name), this.reached);
  }

  /** @returns {HTMLInputElement[]} */
  get fields() {
    return [...byId("next-limits").querySelectorAll("input")].filter(({ type }) => type === "number");
  }

  /**
   * Show the limits; what was typed is kept as long as torques and positions are in the same units.
   * @param {State} state
   */
  show(state) {
    const about = aboutOf(state);
    const unit = `${about.coordinate} ${about.unit}`;
    if (unit !== this.unit) this.wanted = {};
    this.unit = unit;
    this.about = about;
    this.reached = state.limits ?? {};
    const shown = JSON.stringify([unit, this.factor("torque_Nm"), this.all]);
    if (shown === this.shown) return;
    this.shown = shown;
    const words = limitWords(about);
    for (const field of this.fields) {
      const value = this.all[field.name];
      field.value = value === undefined ? "" : String(this.shows(field.name, value));
      if (field.name in words && field.previousElementSibling) field.previousElementSibling.textContent = words[field.name];
    }
    const own = Object.keys(this.wanted).length;
    byId("next-whose").textContent = own === 0 ? ": what the captures reached" : `: ${own} of your own`;
  }

  /**
   * Take the limits of a motion that is there, unless others are wanted: those of a session that goes on, say.
   * @param {Record<string, number>} limits
   */
  adopt(limits) {
    if (Object.keys(this.wanted).length > 0) return;
    const shown = (/** @type {string} */ name, /** @type {number} */ value) => shownLimit(name, value, this.reached);
    const other = Object.entries(limits).filter(([name, value]) => shown(name, value) !== shown(name, this.reached[name] ?? value));
    this.wanted = Object.fromEntries(other);
  }

  /**
   * Offer the smallest change of a limit that would do.
   * @param {Enough | null} enough
   * @param {State} state
   */
  offer(enough, state) {
    this.enough = enough;
    byId("next-enough").hidden = enough === null;
    if (enough) byId("next-enough").textContent = `Design with ${enoughWords(wider(enough, this.all), aboutOf(state))}`;
  }
}

/**
 * A limit as its field has it. An end of a range has the decimals of the range: 22 micrometres off zero, of a way of
 * 0.25 m, are no place.
 * @param {string} name
 * @param {number} value
 * @param {Record<string, number>} reached
 */
export function shownLimit(name, value, { theta_min_rad: low, theta_max_rad: high }) {
  if (!name.startsWith("theta_") || !(high > low)) return Number(value.toPrecision(DIGITS));
  const decimals = DIGITS - 1 - Math.floor(Math.log10(high - low));
  return Number(value.toFixed(Math.min(20, Math.max(0, decimals)))) + 0; // of a −0 that is 0
}

/**
 * A wider limit by its name; a wider range has both of its ends further out.
 * @param {Enough} enough
 * @param {Record<string, number>} limits
 * @returns {Record<string, number>}
 */
export function wider({ limit, to }, { theta_min_rad, theta_max_rad }) {
  return limit === "theta_max_rad" ? { theta_min_rad: theta_min_rad + theta_max_rad - to, theta_max_rad: to } : { [limit]: to };
}
