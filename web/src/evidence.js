/** What a next experiment promises: its evidence as bars, its headline and its limits in words. */

import { make } from "./dom.js";
import { motionWords, number, torqueScale, torqueWord } from "./numbers.js";
import { nodes } from "./said.js";

/** @typedef {import("./types.js").Experiment} Experiment */

const LEAST_D = 0.1; // where the bars of D begin
const MOST_D = 100; // and end: beyond it more tells no more, for nobody would choose the wrong one

/**
 * What each limit of a motion is called, with its unit: of torques that of the plots.
 * @param {import("./said.js").About} about
 * @returns {Record<string, string>}
 */
export function limitWords(about) {
  const { theta, omega, alpha } = motionWords(about);
  return {
    torque_Nm: `${torqueWord(about.unit)}, ${torqueScale(about).unit}`,
    omega_rad_s: `${omega.name}, ${omega.unit}`,
    alpha_rad_s2: `${alpha.name}, ${alpha.unit}`,
    theta_min_rad: `from ${theta.name}, ${theta.unit}`,
    theta_max_rad: `to ${theta.name}, ${theta.unit}`,
    duration_s: "at most, s",
    sample_rate_hz: "recorded at, Hz",
  };
}

/** By what a limit in SI is shown. @param {string} name @param {import("./said.js").About} about */
export function limitFactor(name, about) {
  return name === "torque_Nm" ? torqueScale(about).factor : 1;
}

/**
 * How wide a limit would have to be, in words; a range by its two ends.
 * @param {Record<string, number>} wider limits by their names
 * @param {import("./said.js").About} about
 */
export function enoughWords({ theta_min_rad: from, ...wider }, about) {
  const { theta } = motionWords(about);
  if (from !== undefined) return `${theta.name} from ${number(from)} to ${number(wider.theta_max_rad)} ${theta.unit}`;
  const [[name, to]] = Object.entries(wider);
  if (name === "duration_s") return `at most ${number(to)} s`;
  const [called, unit] = (limitWords(about)[name] ?? name).split(", ");
  return `${called} up to ${number(to * limitFactor(name, about), 4)} ${unit}`;
}

/**
 * What is said of limits, with the words of the form in the place of the names that files have.
 * @param {string} said
 * @param {import("./said.js").About} about
 */
export function ofLimits(said, about) {
  return said.startsWith("limits") ? inFormWords(said, about) : said;
}

/**
 * Words with those of the form in the place of the names that files have for limits.
 * @param {string} said
 * @param {import("./said.js").About} about
 */
export function inFormWords(said, about) {
  const pairs = Object.entries(limitWords(about));
  const own = said.replaceAll(/(?<=torque_Nm: (?:is )?)-?\d[\d.e+-]*\d|(?<=torque_Nm: (?:is )?)-?\d/g, (value) =>
    String(Number((Number(value) * limitFactor("torque_Nm", about)).toPrecision(6))));
  return pairs.reduce((words, [name, called]) => words.replaceAll(name, `“${called}”`), own);
}

/**
 * The bars of a pair: what the motion promises, what the best standard one would, what came.
 * @param {Experiment["pairs"][0]} pair
 * @param {import("./said.js").About} about
 * @param {number} told from which D on they are told apart
 */
export function bars({ names, d, standard_d, wrong_choice, came }, about, told) {
  const share = (/** @type {number} */ value) =>
    `${(100 * Math.log(Math.min(Math.max(value, LEAST_D), MOST_D) / LEAST_D)) / Math.log(MOST_D / LEAST_D)}%`;
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
      make("span", { class: "figure", text: value > MOST_D ? `> ${MOST_D}` : number(value), title: number(value) }),
    );
  };
  const wrong = wrong_choice < 1e-4 ? "less than 0.01 %" : `${number(100 * wrong_choice, 2)} %`;
  return [
    make("p", {}, make("strong", {}, ...nodes(names[0], about), " or ", ...nodes(names[1], about)), `: the wrong one is chosen in ${wrong} of cases`),
    row("this motion", d, "promised"),
    row("best standard motion", standard_d, "standard"),
    ...(came === null ? [] : [row("what came", came, "came")]),
  ];
}
