/** What a next experiment promises: its evidence as bars, its headline and its limits in words. */

import { make } from "./dom.js";
import { number, percent, torqueWord, unitWords } from "./numbers.js";

/** @typedef {import("./types.js").Experiment} Experiment */
/** @typedef {import("./types.js").State} State */

const LEAST_D = 0.1; // where the bars of D begin

/**
 * What a motion would tell, with words beside the name of a parameter.
 * @param {string} headline
 * @param {State["params"]} params
 */
export function inWords(headline, params) {
  const named = params.find(({ name }) => headline.startsWith(`${name} `));
  return named?.meaning ? headline.replace(named.name, `${named.name} (${named.meaning})`) : headline;
}

/**
 * What each limit of a motion is called, with its unit.
 * @param {boolean} linear
 * @param {string} unit of what moves the knob
 * @returns {Record<string, string>}
 */
export function limitWords(linear, unit) {
  const [place, way] = linear ? ["position", "m"] : ["angle", "rad"];
  return {
    torque_Nm: `${torqueWord(unit)}, ${unit}`,
    omega_rad_s: `speed, ${way}/s`,
    alpha_rad_s2: `acceleration, ${unitWords(`${way}/s^2`)}`,
    theta_min_rad: `from ${place}, ${way}`,
    theta_max_rad: `to ${place}, ${way}`,
  };
}

/** @param {Experiment["pairs"]} pairs */
export function largest(pairs) {
  return Math.max(100, ...pairs.flatMap(({ d, standard_d, came }) => [d, standard_d, came ?? 0]));
}

/**
 * The bars of a pair: what the motion promises, what the best standard one would, what came.
 * @param {Experiment["pairs"][0]} pair
 * @param {number} told from which D on they are told apart
 * @param {number} most
 */
export function bars({ names, d, standard_d, wrong_choice, came }, told, most) {
  const share = (/** @type {number} */ value) =>
    `${(100 * Math.log(Math.max(value, LEAST_D) / LEAST_D)) / Math.log(most / LEAST_D)}%`;
  const row = (/** @type {string} */ words, /** @type {number} */ value, /** @type {string} */ name) => {
    const bar = make("span", { class: `bar ${name}` });
    const line = make("span", { class: "told" });
    bar.style.width = share(value);
    line.style.left = share(told);
    return make(
      "div",
      { class: "evidence-line" },
      make("span", { class: "label", text: words }),
      make("span", { class: "track" }, bar, line),
      make("span", { class: "figure", text: number(value) }),
    );
  };
  const wrong = wrong_choice < 1e-3 ? "less than 0.1 %" : percent(wrong_choice);
  return [
    make("p", {}, make("strong", { text: names.join(" or ") }), `: the wrong one is chosen in ${wrong}`),
    row("this motion", d, "promised"),
    row("best standard motion", standard_d, "standard"),
    ...(came === null ? [] : [row("what came", came, "came")]),
  ];
}
