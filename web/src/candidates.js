/** What could be missing: each effect with its evidence; the one that is looked at is laid over the residuals. */

import { make } from "./dom.js";
import { fitFormulas, lawOf, lettersOf, othersIn, printed } from "./math.js";
import { listed, titleOf } from "./names.js";
import { number, percent } from "./numbers.js";
import { nodes, sentence } from "./said.js";
import { apartButton, boundsButton } from "./untold.js";

/** @typedef {import("./types.js").Candidate} Candidate */
/** @typedef {import("./types.js").State} State */

const NOTHING = "No effect that was weighed explains enough of what is left.";
const NO_MORE = "Nothing that was weighed is still missing.";
const FEW = 4; // letters of a law, of which a line says what they mean; of more, that is asked for
const NAMED = 0.01; // of the error, from which on what is ruled out is named
/** Of who goes step by step, for the one path may end elsewhere than the other. */
const ALONE = "Weighed one at a time; Find everything weighs sets too, from the first model on, and may end elsewhere.";

export class Candidates {
  /**
   * @param {HTMLElement} place
   * @param {{look: (effect: string | null) => void, take: (effect: string) => void, ask?: () => void,
   *   about?: (row: Candidate) => void, apart?: (effects: string[]) => void,
   *   bounds?: (effects: string[]) => void}} deeds
   * @param {string} taking what it is called to take one
   */
  constructor(place, deeds, taking) {
    this.place = place;
    this.deeds = deeds;
    this.taking = taking;
    this.shown = "";
    this.at = 0;
    this.inside = false; // whether the keys were here when the list went away
    this.several = false; // whether they were weighed on more than one capture
    /** @type {HTMLElement[]} */
    this.items = [];
    /** @type {Candidate[]} */
    this.rows = [];
    place.tabIndex = -1;
    place.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => fitFormulas(place)).observe(place);
  }

  /** @param {Pick<State, "candidates" | "concluded" | "node" | "job" | "searched" | "active">} state @param {import("./said.js").About} about */
  show({ candidates, concluded, node, job, searched, active }, about) {
    const shown = JSON.stringify([candidates, concluded, node, job?.id, searched, active.length, about]);
    if (shown === this.shown) return;
    this.shown = shown;
    this.inside ||= this.place.contains(document.activeElement);
    this.at = 0;
    const could = candidates.rows.filter((row) => row.could_be);
    const rest = candidates.rows.filter((row) => !row.could_be);
    const ruledOut = rest.filter((row) => row.word === "implausible");
    this.rows = [...could, ...ruledOut, ...rest.filter((row) => row.word !== "implausible")];
    this.several = active.length > 1;
    this.items = this.rows.map((row, at) => this.item(row, at, about));
    const [out, others] = [this.items.slice(could.length, could.length + ruledOut.length), this.items.slice(could.length + ruledOut.length)];
    const ask = make("button", {
      ...{ type: "button", text: "What is missing?", disabled: job !== null || node === null },
      on: { click: () => this.deeds.ask?.() },
    });
    this.place.replaceChildren(
      ...(candidates.ready ? [] : [make("p", { class: "soft" }, job ? `${sentence(job.what, about)} …` : ask)]),
      candidates.ready && !searched && could.length > 0 ? make("p", { class: "soft alone", text: ALONE }) : "",
      ...(candidates.ready && this.items.length === 0
        ? [make("p", { class: "well", text: "Nothing is left to be weighed." })]
        : []),
      candidates.ready && could.length === 0 && this.items.length > 0 ? make("p", { class: "soft", text: candidates.unexplained ? NOTHING : NO_MORE }) : "",
      make("ul", { "aria-label": "candidates", class: "candidates" }, ...this.items.slice(0, could.length)),
      out.length > 0 ? folded(out, `${out.length} ruled out by values that none can have: ${outWords(ruledOut)}`) : "",
      others.length > 0 ? folded(others, `${restWords(others.length, this.items.length)}: no better than chance, or too little to matter`) : "",
      ...(concluded.length > 0 ? [] : remainder(candidates.unexplained, about)), // where it stands first already
    );
    fitFormulas(this.place);
    // On the list as a whole: on an item a second Enter would take another one, unseen.
    if (this.inside && document.activeElement === document.body) this.place.focus();
    if (this.items.length > 0) this.inside = false;
  }

  /** @param {Candidate} row @param {number} at @param {import("./said.js").About} about */
  item(row, at, about) {
    const bar = make("span", { class: "bar" });
    bar.style.width = `${100 * Math.min(1, Math.max(0, row.error_fall))}%`;
    const take = make("button", {
      ...{ type: "button", text: this.taking, tabindex: -1, "aria-label": `${this.taking} ${titleOf(row.effect)}` },
      on: { click: () => this.deeds.take(row.effect) },
    });
    const what = make("button", {
      ...{ type: "button", text: "?", tabindex: -1, "aria-label": `about ${titleOf(row.effect)}`, title: "what it is (key: ?)" },
      on: { click: () => this.deeds.about?.(row) },
    });
    const chance = row.could_be ? "" : " chance";
    return make(
      "li",
      {
        ...{ class: `candidate${chance}`, tabindex: at === 0 ? 0 : -1, "data-effect": row.effect },
        "aria-label": `${titleOf(row.effect)}, ${row.name}: error falls by ${percent(Math.max(0, row.error_fall))}, ${evidence(row, about)}`,
        on: {
          pointerenter: () => this.deeds.look(row.effect),
          pointerleave: () => this.deeds.look(null),
          focus: () => this.focused(at),
          blur: () => this.deeds.look(null),
        },
      },
      make("span", { class: "label", text: titleOf(row.effect), title: row.effect }),
      make("span", { class: "track" }, bar),
      make("span", { class: "figure", text: percent(-Math.max(0, row.error_fall)), title: "fall of the RMS error" }),
      make("span", { class: "deeds" }, this.deeds.about ? what : null, take),
      make("span", { class: "alike", text: row.name }),
      ...(row.could_be ? [make("span", { class: "alike law-of" }, lawOf(row)), meant(row)] : []),
      make("span", { class: "evidence soft", text: evidence(row, about) }),
      this.untold(row),
      ...remarks(row).map((words) => make("span", { class: "alike soft" }, ...words)),
      row.could_be && row.unsettled ? make("span", { class: "alike doubt", text: `⚠ ${row.unsettled}` }) : null,
      ...row.implausible.map((why) => make("span", { class: "alike doubt" }, "⚠ ", ...nodes(why, about))),
    );
  }

  /**
   * What this one cannot be told from, with the button that designs the motion which would tell.
   * @param {Candidate} row
   */
  untold({ effect, equivalent }) {
    if (equivalent.length === 0) return null;
    const { apart, bounds } = this.deeds;
    const [all, title] = [[effect, ...equivalent], titleOf(effect)];
    const buttons = apart && bounds ? [apartButton(all, apart, title), " ", boundsButton(all, bounds, title)] : [];
    return make("span", { class: "alike soft" }, `${this.several ? "these captures" : "this capture"} cannot tell it from `, ...listed(equivalent, ", "), " ", ...buttons);
  }

  /** Go to an effect. @param {string} effect */
  go(effect) {
    const item = this.items.find(({ dataset }) => dataset.effect === effect);
    const fold = item?.closest("details");
    if (fold) fold.open = true; // what is folded away takes no focus
    item?.focus();
  }

  /** @param {number} at */
  focused(at) {
    this.at = at;
    for (const [other, item] of this.items.entries()) {
      item.tabIndex = other === at ? 0 : -1;
      if (other === at) item.setAttribute("aria-current", "true");
      else item.removeAttribute("aria-current");
    }
    this.deeds.look(this.items[at].dataset.effect ?? null);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const at = event.target === this.place ? -1 : this.at;
    const moves = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: this.items.length - 1 };
    if (event.key in moves) {
      const to = moves[/** @type {keyof typeof moves} */ (event.key)];
      const item = this.items[Math.min(this.items.length - 1, Math.max(0, to))];
      if (item) this.go(item.dataset.effect ?? "");
      event.preventDefault();
    } else if (event.key === "Enter" && event.target === this.items[this.at]) {
      this.deeds.take(this.items[this.at].dataset.effect ?? "");
      event.preventDefault();
    } else if (event.key === "?") {
      if (this.rows[this.at]) this.deeds.about?.(this.rows[this.at]);
    }
  }
}

/**
 * What could not be it: there for those who ask.
 * @param {HTMLElement[]} items
 * @param {string} words why
 */
function folded(items, words) {
  return make("details", {}, make("summary", { class: "soft", text: words }), make("ul", { class: "candidates" }, ...items));
}

/** How those are counted that come after others, or are all that there are. @param {number} rest @param {number} all */
export function restWords(rest, all) {
  return rest < all ? `${rest} more` : `${rest} weighed`;
}

/** What would have taken something off; the others are counted. @param {Candidate[]} rows */
export function outWords(rows) {
  const some = rows.filter(({ error_fall: fall }) => fall >= NAMED);
  const named = (some.length > 0 ? some : rows.slice(0, 1)).map(({ effect, error_fall: fall }) => `${titleOf(effect)} (${percent(-Math.max(0, fall))})`);
  return [...named, ...(named.length < rows.length ? [`${rows.length - named.length} that would take off less than 1\u00a0%`] : [])].join(", ");
}

/** @param {Candidate} row @param {import("./said.js").About} about */
function evidence(row, about) {
  const chance = row.p_value <= 0.001 ? "p\u00a0≤\u00a00.001" : `p\u00a0=\u00a0${number(row.p_value, 2)}`;
  return `${sentence(row.said, about)} (${chance})`;
}

/** What the letters of a law mean, where they are few. @param {Pick<Candidate, "letters" | "latex">} row */
function meant({ letters, latex }) {
  if (letters.length === 0 || letters.length > FEW) return null;
  // What moves is known by its letter; which friction it is that changes is not.
  const friction = othersIn(latex, []).filter(([tex]) => tex.startsWith("C_"));
  const parts = [...letters.map(({ names, meaning }) => [lettersOf(names, latex), meaning]), ...friction.map(([tex, meaning]) => [printed(tex), meaning])];
  return make("span", { class: "alike soft meant" }, ...parts.flatMap(([letter, meaning], at) => [at > 0 ? " · " : "", letter, ` ${meaning}`]));
}

/**
 * What else there is to say about a candidate, a line each.
 * @param {Candidate} row
 */
function remarks({ equivalent, confused, note }) {
  const others = confused.filter((effect) => !equivalent.includes(effect));
  return [...(others.length > 0 ? [["often confused with ", ...listed(others, ", ")]] : []), ...(note ? [[note]] : [])];
}

/** @param {State["candidates"]["unexplained"]} unexplained @param {import("./said.js").About} about */
function remainder(unexplained, about) {
  if (!unexplained) return [];
  const { axis, share, hint } = unexplained;
  const where = sentence(hint, about);
  const words = `Unexplained over ${sentence([{ along: axis }], about)}: ${percent(share)} of what remains${where ? ` (${where})` : ""}.`;
  return [make("p", { class: "soft", text: words })];
}
