/** Any effect of the catalogue: what it is, where it shows, and a way to add it without waiting for evidence. */

import { acting } from "./acting.js";
import { fetchPicture, wordsOf } from "./api.js";
import { byId, make } from "./dom.js";
import { fitFormulas, lawOf, lettersOf, othersIn, printed } from "./math.js";
import { titleOf } from "./names.js";
import { unitOf, unitWords } from "./numbers.js";

/** @typedef {import("./types.js").Effect} Effect */

/** @type {Map<string, string>} addresses of pictures that were fetched */
const pictures = new Map();

/** @type {Record<string, string>} */
const PLACES = { load: "moving part itself", coupling: "joint between what drives and what is moved", sensor: "reading" };

/** Let any effect that the model lacks be chosen. */
export class AnyEffect {
  /** @param {(effect: string) => void} add @param {(effect: Effect) => void} tell what it is */
  constructor(add, tell) {
    this.select = /** @type {HTMLSelectElement} */ (byId("any-effect"));
    /** @type {Effect[]} */
    this.absent = [];
    byId("any").addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.select.value) add(this.select.value);
    });
    byId("any-about").addEventListener("click", () => {
      const chosen = this.absent.find(({ effect }) => effect === this.select.value);
      if (chosen) tell(chosen);
    });
    byId("about-close").addEventListener("click", () => dialog().close());
  }

  /** @param {Effect[]} absent */
  show(absent) {
    byId("any").hidden = absent.length === 0;
    const names = (/** @type {Effect[]} */ effects) => effects.map(({ effect }) => effect).join();
    if (names(absent) !== names(this.absent)) {
      // None is chosen at first, nor once one was added: a second Enter adds nothing.
      const none = make("option", { value: "", text: "choose one" });
      this.select.replaceChildren(none, ...absent.map(({ effect, name }) => make("option", { value: effect, text: `${titleOf(effect)}: ${name}`, title: effect })));
    }
    this.absent = absent;
  }
}

/**
 * Show what an effect is and where it shows, in motion where there is one.
 * @param {Effect} effect
 * @param {import("./acting.js").Shown | null} shown
 * @param {string} torque the unit that the captures have for it
 */
export function about(effect, shown, torque) {
  const { effect: id, place, source, shows, name, about: sentence, causes, remedies } = effect;
  // The words are there at once; the picture is drawn meanwhile, where room is kept for it.
  const drawing = make("p", { class: "soft", text: "The picture is being drawn …" });
  const frame = make("div", { class: "picture", role: "status" }, drawing);
  const example = `Below, an example: what it adds to a small knob that turns, with torques in mNm${torque === "N m" ? "" : `; the captures here are in ${torque}`}.`;
  byId("about-title").textContent = `${titleOf(id)}: ${name}`;
  byId("about-title").title = id;
  byId("about-text").replaceChildren(
    make("p", { text: sentence }),
    lawOf(effect),
    meanings(effect, torque),
    shown ? acting(effect, shown) : "",
    make("div", { class: "columns-of-two" }, listed("Usual causes", causes), listed("What helps", remedies)),
    make("p", { class: "soft", text: `Acts on the ${PLACES[place] ?? place}. Shows ${shows}. Source: ${source}.` }),
    make("p", { class: "soft", text: example }),
    frame,
  );
  dialog().showModal();
  fitFormulas(byId("about-text"));
  const alt = `${name}: what it adds to a small model's torque; it shows ${shows}`;
  const drawn = () => frame.replaceChildren(make("img", { alt, src: pictures.get(id) }));
  if (pictures.has(id)) return drawn();
  fetchPicture(id).then(
    (blob) => {
      pictures.set(id, URL.createObjectURL(blob));
      drawn();
    },
    (reason) => frame.replaceChildren(make("p", { class: "wrong", text: wordsOf(reason) })),
  );
}

/** What each letter of a law means, with its unit. @param {Pick<Effect, "letters" | "latex">} effect @param {string} torque */
function meanings({ letters, latex }, torque) {
  const written = (/** @type {string} */ unit) => unitWords(unitOf(unit, torque));
  const rows = letters.map(({ names, meaning, unit }) => make("li", {}, lettersOf(names, latex), ` ${meaning}`, written(unit) ? `, ${written(unit)}` : ""));
  const own = letters.flatMap(({ names }) => names);
  rows.push(...othersIn(latex, own).map(([tex, words]) => make("li", {}, printed(tex), ` ${words}`)));
  return rows.length > 0 ? make("ul", { class: "letters soft", "aria-label": "letters of the law" }, ...rows) : "";
}

/**
 * Phrases under a title, if there are any.
 * @param {string} title
 * @param {string[]} phrases
 */
function listed(title, phrases) {
  if (phrases.length === 0) return null;
  return make("div", {}, make("h3", { text: title }), make("ul", {}, ...phrases.map((text) => make("li", { text }))));
}

function dialog() {
  return /** @type {HTMLDialogElement} */ (byId("about"));
}
