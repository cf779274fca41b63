/** The parameter table: values that can be dragged to feel what each does. */

import { byId, make } from "./dom.js";
import { paramOf, titleOf } from "./names.js";
import { asKnown, number, scaleOf, unitWords } from "./numbers.js";
import { sentence } from "./said.js";

/** @typedef {import("./types.js").Param} Param */

const STEPS = 400; // of a slider
const WORDED = 8; // parameters of an effect: of more, as of a series of waves, words are seen by pointing

export class Params {
  /**
   * @param {HTMLElement} place
   * @param {{drag: (values: Record<string, number>) => void, drop: (effect: string) => void}} deeds
   */
  constructor(place, deeds) {
    this.place = place;
    this.deeds = deeds;
    /** @type {Map<string, {slider: HTMLInputElement, value: HTMLElement, error: HTMLElement, apart: HTMLElement, low: number, high: number, factor: number}>} */
    this.rows = new Map();
    /** @type {string} */
    this.shape = "";
  }

  /** @param {Param[]} params @param {import("./types.js").Together[]} together @param {import("./said.js").About} about */
  show(params, together, about) {
    showTogether(together);
    const units = params.map(({ unit }) => scaleOf(unit, about));
    const shape = JSON.stringify(params.map(({ name, fitted, lower, upper }, at) => [name, fitted, lower, upper, units[at]]));
    if (shape !== this.shape) this.build(params, about);
    this.shape = shape;
    for (const [at, param] of params.entries()) {
      const row = this.rows.get(param.name);
      if (!row) continue;
      const shown = param.dragged ? number(param.value * row.factor, 4) : asKnown(param.value * row.factor, halfOf(param) * row.factor);
      row.value.textContent = shown;
      row.apart.textContent = apart(param);
      row.error.hidden = param.dragged; // of the fitted value, not of one that a hand gave
      row.slider.setAttribute("aria-valuetext", `${shown} ${units[at].unit}`);
      row.value.classList.toggle("moved", param.dragged);
      if (document.activeElement !== row.slider) row.slider.value = String(place(param.value, row));
    }
  }

  /** @param {Param[]} params @param {import("./said.js").About} about */
  build(params, about) {
    const focused = document.activeElement?.getAttribute("data-param");
    this.rows.clear();
    const groups = Map.groupBy(params, ({ name }) => name.split(".")[0]);
    const lines = [...groups].flatMap(([effect, own]) => {
      const doubts = own.map(({ name, doubt }) => (doubt ? sentence(withoutName(doubt, name), about).trim() : ""));
      const shared = sharedDoubts(own, doubts);
      return [
        this.heading(effect, groups.size > 1),
        ...[...shared].map(([doubt, names]) => reason(`${names.join(", ")}: ${doubt}`)),
        ...own.flatMap((param, at) => [
          this.line(param, doubts[at], scaleOf(param.unit, about)),
          own.length <= WORDED ? this.meaning(param) : "",
          shared.has(doubts[at]) ? "" : reason(doubts[at]),
        ]),
      ];
    });
    const widths = make("colgroup", {}, ...["name", "slide", "value", "unit"].map((name) => make("col", { class: name })));
    this.place.replaceChildren(make("table", { class: "params" }, widths, make("tbody", {}, ...lines)));
    if (focused) this.rows.get(focused)?.slider.focus();
  }

  /** @param {string} effect @param {boolean} removable */
  heading(effect, removable) {
    const drop = make("button", {
      ...{ type: "button", text: "×", title: `remove ${titleOf(effect)}`, "aria-label": `remove ${titleOf(effect)}` },
      on: { click: () => this.deeds.drop(effect) },
    });
    const name = make("th", { scope: "rowgroup", colspan: 3, text: titleOf(effect), title: effect });
    return make("tr", { class: "effect" }, name, make("td", { class: "remove" }, removable ? drop : ""));
  }

  /** @param {Param} param @param {string} doubted why its value is doubted @param {ReturnType<typeof scaleOf>} scale */
  line(param, doubted, { factor, unit }) {
    const { low, high } = span(param);
    const slider = make("input", {
      ...{ type: "range", min: 0, max: STEPS, step: 1, value: place(param.value, { low, high }) },
      ...{ "aria-label": paramOf(param.name), "data-param": param.name, disabled: param.role === "fixed" },
      on: { input: () => this.drag(param.name) },
    });
    const value = make("span", { class: "figure" });
    const error = make("span", { class: "error soft figure", text: plusMinus(param, factor) });
    this.rows.set(param.name, { slider, value, error, apart: make("span"), low, high, factor });
    const between = param.ci95 ? param.ci95.map((end) => number(end * factor)).join(" … ") : "not determined";
    const doubt = doubted ? make("span", { class: "doubt", text: " ⚠", "aria-hidden": "true" }) : null;
    const about = [param.name, param.meaning, doubted].filter(Boolean).join(": ");
    return make(
      "tr",
      {},
      make("th", { scope: "row", title: about }, param.name.split(".").slice(1).join("."), doubt),
      make("td", { class: "slide" }, interval(param.ci95, { low, high }), slider),
      make("td", { class: "value", title: `95 % interval ${between} ${unit}` }, value, " ", error),
      make("td", { class: "soft unit", text: unitWords(unit), title: unit }),
    );
  }

  /** What a parameter is, below it. @param {Param} param */
  meaning({ name, meaning: words }) {
    if (!words || name.endsWith(`.${words}`)) return ""; // of a law of one's own there are its letters alone
    return make("tr", {}, make("td", { class: "meaning soft", colspan: 4 }, words, this.rows.get(name)?.apart ?? ""));
  }

  /** @param {string} name */
  drag(name) {
    const row = this.rows.get(name);
    if (!row) return;
    const value = row.low + (Number(row.slider.value) / STEPS) * (row.high - row.low);
    row.value.textContent = number(value * row.factor, 4);
    row.value.classList.add("moved");
    this.deeds.drag({ [name]: value });
  }
}

/**
 * A period over 2 pi, by which laws are written, as a person counts what returns with it; nothing of other parameters.
 * @param {Pick<Param, "name" | "unit" | "value">} param
 */
export function apart({ name, unit, value }) {
  if (!name.endsWith(".P") || !(value > 0)) return "";
  if (unit !== "rad") return unit === "m" ? `: every ${number(2000 * Math.PI * value, 4)} mm` : "";
  return `: ${number(1 / value, 4)} a turn, ${number(360 * value, 4)}° apart`;
}

/**
 * A sentence without the parameter that it begins with, below which it stands; one that goes on to another needs both.
 * @param {import("./said.js").Part[]} said
 * @param {string} name
 */
export function withoutName([first, ...rest], name) {
  const own = typeof first === "object" && "param" in first && first.param === name;
  const beside = typeof rest[0] === "string" && /^( and |, )/.test(rest[0]);
  return own && !beside ? rest : [first, ...rest];
}

/**
 * What is doubted alike of several values of an effect, with their letters: it is said once.
 * @param {Pick<Param, "name">[]} own
 * @param {string[]} doubts of each, empty for none
 */
export function sharedDoubts(own, doubts) {
  const letters = own.map(({ name }) => name.split(".").slice(1).join("."));
  const several = new Set(doubts.filter((doubt, at) => doubt !== "" && doubts.indexOf(doubt) !== at));
  return new Map([...several].map((doubt) => [doubt, letters.filter((_, at) => doubts[at] === doubt)]));
}

/** Why a value is doubted, below it. @param {string} doubt */
function reason(doubt) {
  if (!doubt) return "";
  return make("tr", {}, make("td", { class: "reason doubt", colspan: 4, text: doubt }));
}

/** The pairs that the captures tell apart least. @param {import("./types.js").Together[]} together */
function showTogether(together) {
  byId("together").hidden = together.length === 0;
  const rows = together.map(({ names, correlation }) =>
    make("tr", {}, make("th", { scope: "row", text: names.map(paramOf).join(" and "), title: names.join(", ") }), make("td", { class: "figure", text: number(correlation, 3) })),
  );
  byId("together-rows").replaceChildren(...rows);
}

/**
 * What a slider reaches: as far again as the value is from zero, or four times its interval, within bounds.
 * @param {Param} param
 */
function span({ fitted, ci95, lower, upper }) {
  const half = ci95 ? 2 * Math.abs(ci95[1] - ci95[0]) : 0;
  const reach = Math.max(Math.abs(fitted), half, 1e-9);
  return { low: Math.max(fitted - reach, lower ?? -Infinity), high: Math.min(fitted + reach, upper ?? Infinity) };
}

/** Half the 95 % interval; NaN where there is none. @param {Pick<Param, "ci95">} param */
function halfOf({ ci95 }) {
  return ci95 ? 0.5 * (ci95[1] - ci95[0]) : NaN;
}

/**
 * Half the 95 % interval, in as many digits as it is known to.
 * @param {Pick<Param, "ci95" | "role">} param
 * @param {number} [factor] from SI to the unit that is shown
 */
export function plusMinus({ ci95, role }, factor = 1) {
  if (role === "fixed") return "fixed";
  if (!ci95) return "± ?";
  const half = factor * halfOf({ ci95 });
  return half > 0 ? `± ${asKnown(half, half)}` : "";
}

/**
 * The interval as a bar below the slider, as far as the slider reaches; nothing where there is none.
 * @param {Param["ci95"]} ci95
 * @param {{low: number, high: number}} reach
 */
function interval(ci95, { low, high }) {
  if (!ci95 || !(high > low)) return null;
  const [from, to] = ci95.map((end) => Math.min(1, Math.max(0, (end - low) / (high - low))));
  const bar = make("span", { class: "interval" });
  bar.style.left = `calc(var(--thumb) / 2 + ${from} * (100% - var(--thumb)))`;
  bar.style.width = `calc(${to - from} * (100% - var(--thumb)))`;
  return bar;
}

/** @param {number} value @param {{low: number, high: number}} row */
function place(value, { low, high }) {
  return high > low ? Math.round((STEPS * (value - low)) / (high - low)) : 0;
}
