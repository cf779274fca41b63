/** Any effect of the catalogue: what it is, where it shows, and a way to add it without waiting for evidence. */

import { fetchPicture } from "./api.js";
import { byId, make } from "./dom.js";

/** @typedef {import("./types.js").Effect} Effect */

/** @type {Map<string, string>} addresses of pictures that were fetched */
const pictures = new Map();

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
      this.select.replaceChildren(...absent.map(({ effect }) => make("option", { value: effect, text: effect })));
    }
    this.absent = absent;
  }
}

/**
 * Show what an effect is and where it shows.
 * @param {Effect} effect
 */
export function about({ effect, place, law, source, shows, confused }) {
  const picture = make("img", { alt: `what ${effect} adds to the torque of a small knob`, src: pictures.get(effect) });
  byId("about-title").textContent = effect;
  byId("about-text").replaceChildren(
    make("p", {}, make("code", { text: law })),
    make("p", { text: `Acts on: ${place}. Shows: ${shows}.` }),
    confused.length > 0 ? make("p", { text: `Easily confused with ${confused.join(", ")}.` }) : "",
    make("p", { class: "soft", text: source }),
    picture,
  );
  dialog().showModal();
  if (pictures.has(effect)) return;
  fetchPicture(effect).then(
    (blob) => {
      pictures.set(effect, URL.createObjectURL(blob));
      picture.src = pictures.get(effect) ?? "";
    },
    (reason) => picture.replaceWith(make("p", { class: "wrong", text: String(reason.message ?? reason) })),
  );
}

function dialog() {
  return /** @type {HTMLDialogElement} */ (byId("about"));
}
