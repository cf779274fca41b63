/** Any effect of the catalogue: what it is, where it shows, and a way to add it without waiting for evidence. */

import { fetchPicture, wordsOf } from "./api.js";
import { byId, make } from "./dom.js";

/** @typedef {import("./types.js").Effect} Effect */

/** @type {Map<string, string>} addresses of pictures that were fetched */
const pictures = new Map();

/** @type {Record<string, string>} */
const PLACES = { load: "torque of the knob", coupling: "joint between shaft and knob", sensor: "torque sensor" };

/** Let any effect that the model lacks be chosen. */
export class AnyEffect {
  /** @param {(effect: string) => void} add */
  constructor(add) {
    this.select = /** @type {HTMLSelectElement} */ (byId("any-effect"));
    /** @type {Effect[]} */
    this.absent = [];
    byId("any").addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.select.value) add(this.select.value);
    });
    byId("any-about").addEventListener("click", () => {
      const chosen = this.absent.find(({ effect }) => effect === this.select.value);
      if (chosen) about(chosen);
    });
    byId("about-close").addEventListener("click", () => dialog().close());
  }

  /** @param {Effect[]} absent */
  show(absent) {
    byId("any").hidden = absent.length === 0;
    const names = (/** @type {Effect[]} */ effects) => effects.map(({ effect }) => effect).join();
    if (names(absent) !== names(this.absent)) {
      this.select.replaceChildren(...absent.map(({ effect, name }) => make("option", { value: effect, text: `${effect}: ${name}` })));
    }
    this.absent = absent;
  }
}

/**
 * Show what an effect is and where it shows.
 * @param {Effect} effect
 */
export function about({ effect, place, law, source, shows, name, about: sentence, causes, remedies }) {
  const alt = `${law}: what it adds to the torque of a small knob; it shows ${shows}`;
  const picture = make("img", { alt, src: pictures.get(effect) });
  byId("about-title").textContent = effect;
  byId("about-text").replaceChildren(
    make("p", {}, make("strong", { text: name })),
    make("p", { text: sentence }),
    ...listed("Usual causes", causes),
    ...listed("What helps", remedies),
    make("p", { class: "soft", text: `Acts on the ${PLACES[place] ?? place}. ${source}` }),
    picture,
  );
  dialog().showModal();
  if (pictures.has(effect)) return;
  fetchPicture(effect).then(
    (blob) => {
      pictures.set(effect, URL.createObjectURL(blob));
      picture.src = pictures.get(effect) ?? "";
    },
    (reason) => picture.replaceWith(make("p", { class: "wrong", text: wordsOf(reason) })),
  );
}

/**
 * Phrases under a title, if there are any.
 * @param {string} title
 * @param {string[]} phrases
 */
function listed(title, phrases) {
  if (phrases.length === 0) return [];
  return [make("h3", { text: title }), make("ul", {}, ...phrases.map((text) => make("li", { text })))];
}

function dialog() {
  return /** @type {HTMLDialogElement} */ (byId("about"));
}
