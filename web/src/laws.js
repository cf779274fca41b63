/** Laws for what no effect explains: looked for when asked, laid over the residuals, taken under a name. */

import { byId, make } from "./dom.js";
import { percent } from "./numbers.js";

/** @typedef {import("./types.js").Law} Law */
/** @typedef {import("./types.js").State} State */

export class Laws {
  /**
   * @param {HTMLElement} place
   * @param {{ask: () => void, look: (number: number | null) => void, take: (number: number, name: string) => void,
   *   add: (formula: object) => Promise<boolean>}} deeds
   */
  constructor(place, deeds) {
    this.place = place;
    this.deeds = deeds;
    this.shown = "";
    const form = /** @type {HTMLFormElement} */ (byId("own-form"));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      if (await this.deeds.add(Object.fromEntries(new FormData(form)))) form.reset();
    });
  }

  /** @param {Pick<State, "candidates" | "proposed" | "proposed_text" | "node" | "job" | "rmse">} state */
  show({ candidates, proposed, proposed_text, node, job, rmse }) {
    const shown = JSON.stringify([candidates.ready, proposed, node, job === null]);
    if (shown === this.shown) return;
    this.shown = shown;
    byId("own").hidden = node === null;
    if (!candidates.ready || node === null) {
      this.place.replaceChildren();
    } else if (proposed === null) {
      const ask = make("button", {
        ...{ type: "button", text: "Look for a law…", disabled: job !== null },
        ...{ title: "formulas that would explain what is left, where no effect does", on: { click: () => this.deeds.ask() } },
      });
      this.place.replaceChildren(make("p", {}, ask));
    } else {
      const list = proposed.map((law, at) => this.item(law, at + 1, rmse ?? law.rmse));
      this.place.replaceChildren(
        make("p", { class: "soft", text: proposed_text, role: "status" }),
        ...(list.length > 0 ? [make("ul", { class: "laws", "aria-label": "laws that are proposed" }, ...list)] : []),
      );
    }
  }

  /** @param {Law} row @param {number} number @param {number} rmse what is left without it */
  item({ label, law, words, rmse: left, start }, number, rmse) {
    const edit = make("button", {
      ...{ type: "button", text: "Edit…", "aria-label": `edit law ${number}`, title: "as a formula of your own" },
      on: { click: () => edited(law, start) },
    });
    const take = make("button", {
      ...{ type: "submit", text: "Add", "aria-label": `add law ${number}` },
      ...{ title: "fit it with the model, as an effect of this name" },
    });
    const name = make("input", {
      ...{ type: "text", name: "name", size: 8, placeholder: "law", spellcheck: "false", autocomplete: "off" },
      "aria-label": `name of law ${number}`,
    });
    const form = make("form", {}, edit, name, take);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.deeds.take(number, /** @type {HTMLInputElement} */ (name).value);
    });
    const look = () => this.deeds.look(number);
    const away = () => this.deeds.look(null);
    return make(
      "li",
      { class: "law", on: { pointerenter: look, pointerleave: away, focusin: look, focusout: away } },
      make("code", { text: label }),
      make("span", { class: "figure", text: percent(left / rmse - 1), title: "fall of the RMS error" }),
      make("span", { class: "soft", text: words.join("; ") }),
      form,
    );
  }
}

/** Put a law where formulas are typed. @param {string} law @param {string} start */
function edited(law, start) {
  const form = /** @type {HTMLFormElement} */ (byId("own-form"));
  /** @type {HTMLDetailsElement} */ (byId("own")).open = true;
  for (const [name, value] of Object.entries({ law, guess: start, name: "" })) {
    const typed = form.elements.namedItem(name);
    if (typed instanceof HTMLInputElement) typed.value = value;
  }
  /** @type {HTMLInputElement} */ (form.elements.namedItem("law")).focus();
}
