/** Laws for what no effect explains: looked for when asked, laid over the residuals, taken under a name. */

import { curveWords, drawCurve, lettered } from "./curve.js";
import { byId, make } from "./dom.js";
import { fitFormulas, lawOf } from "./math.js";
import { aboutOf, nodes } from "./said.js";
import { drawSurface, surfaceWords } from "./surface.js";
import { number as written, percent, torqueScale, torqueWord } from "./numbers.js";

/** @typedef {import("./types.js").Law} Law */
/** @typedef {import("./types.js").State} State */

const TYPED_MS = 350; // after the last letter

export class Laws {
  /**
   * @param {HTMLElement} place
   * @param {{ask: () => void, look: (number: number | null) => void, take: (number: number, name: string) => void,
   *   add: (formula: object) => Promise<boolean>, attempt: (formula: object, tried: (tried: Law) => void) => Promise<string>}} deeds
   */
  constructor(place, deeds) {
    this.place = place;
    this.deeds = deeds;
    this.shown = "";
    this.of = ""; // which captures what is typed is about
    /** @type {(Pick<State, "curve" | "surface"> & import("./said.js").About) | null} */
    this.about = null;
    new ResizeObserver(() => this.draw()).observe(byId("curve"));
    new ResizeObserver(() => this.draw()).observe(byId("surface"));
    new ResizeObserver(() => fitFormulas(place)).observe(place);
    const form = /** @type {HTMLFormElement} */ (byId("own-form"));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      clearTimeout(this.typing);
      if (await this.deeds.add(Object.fromEntries(new FormData(form)))) form.reset();
      byId("own-tried").textContent = "";
    });
    form.addEventListener("input", ({ target }) => {
      if (!(target instanceof HTMLInputElement && target.name === "name")) this.typed(form);
    });
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.typing = undefined;
  }

  /** Of other captures what was typed says nothing. @param {string} captures */
  another(captures) {
    if (this.of !== "") /** @type {HTMLFormElement} */ (byId("own-form")).reset();
    clearTimeout(this.typing);
    byId("own-tried").textContent = "";
    this.of = captures;
  }

  /** Fit what is typed, once nothing more comes, and say what it would leave. @param {HTMLFormElement} form */
  typed(form) {
    clearTimeout(this.typing);
    const said = byId("own-tried");
    this.typing = setTimeout(async () => {
      const formula = Object.fromEntries(new FormData(form));
      if (String(formula.law).trim() === "") {
        said.textContent = "";
        return this.deeds.look(null);
      }
      const now = this.typing;
      const words = await this.deeds.attempt(formula, ({ rmse, rmse_heldout, words: params, doubt }) => {
        if (now !== this.typing || !this.about) return;
        const scale = torqueScale(this.about);
        const unseen = rmse_heldout === null ? "" : `, ${written(rmse_heldout * scale.factor)} on unseen blocks`;
        said.className = "";
        said.textContent = `would leave ${written(rmse * scale.factor)} ${scale.unit}${unseen}; ${[...params, ...(doubt ? [`⚠ ${doubt}`] : [])].join("; ")}`;
      });
      if (now !== this.typing || words === "") return undefined;
      said.className = "doubt";
      said.textContent = words;
      return undefined;
    }, TYPED_MS);
  }

  /** Draw the curve, with one of the laws before the others, and the map beside that of the law. @param {number} [looked] from 1 */
  draw(looked = 1) {
    this.drawMaps(looked);
    const curve = this.about?.curve ?? null;
    byId("curve").hidden = curve === null;
    if (!curve || !this.about) return;
    const canvas = /** @type {HTMLCanvasElement} */ (byId("curve-plot"));
    drawCurve(canvas, curve, this.about, looked);
    const words = curveWords(curve, looked);
    byId("curve-words").textContent = words;
    canvas.setAttribute("aria-label", words);
  }

  /** @param {number} looked from 1; of a law of fewer variables, the first that has a map stays beside */
  drawMaps(looked) {
    const surface = this.about?.surface ?? null;
    byId("surface").hidden = surface === null;
    if (!surface || !this.about) return;
    const law = surface.laws[looked - 1] ? looked : surface.laws.findIndex((one) => one !== null) + 1;
    const words = surfaceWords(surface, this.about);
    byId("surface-words").textContent = words;
    for (const [id, shown] of /** @type {const} */ ([["surface-left", null], ["surface-law", law]])) {
      const canvas = /** @type {HTMLCanvasElement} */ (byId(id));
      drawSurface(canvas, surface, this.about, shown);
      canvas.setAttribute("aria-label", `${shown === null ? "what is left" : `what law ${shown} makes of it`}. ${words}`);
    }
  }

  /** @param {State} state */
  show(state) {
    const { candidates, proposed, proposed_said, node, job, curve, surface, active } = state;
    if (active.join() !== this.of) this.another(active.join());
    const shown = JSON.stringify([candidates.ready, proposed, node, job === null]);
    if (shown === this.shown) return;
    this.shown = shown;
    byId("own").hidden = node === null;
    this.about = { curve, surface, ...aboutOf(state) };
    showHow(this.about);
    this.draw();
    const nothing = candidates.unexplained === null && !candidates.rows.some((row) => row.could_be); // but chance is left
    if (!candidates.ready || node === null || (proposed === null && nothing)) {
      this.place.replaceChildren();
    } else if (proposed === null) {
      const ask = make("button", {
        ...{ type: "button", text: "Look for a law…", disabled: job !== null },
        ...{ title: "formulas that would explain what is left, where no effect does", on: { click: () => this.deeds.ask() } },
      });
      this.place.replaceChildren(make("p", {}, ask));
    } else {
      const list = proposed.map((law, at) => this.item(law, at + 1));
      this.place.replaceChildren(
        make("p", { class: "soft small", role: "status" }, ...nodes(proposed_said, this.about)),
        ...(list.length > 0 ? [make("ul", { class: "laws", "aria-label": "laws that are proposed" }, ...list)] : []),
      );
      fitFormulas(this.place);
    }
  }

  /** @param {Law} row @param {number} number */
  item({ label, law, variables, words, doubt, fall, start }, number) {
    const of = `over ${this.about ? lettered(variables, this.about) : ""}`;
    const edit = make("button", {
      ...{ type: "button", text: "Edit…", "aria-label": `edit law ${number}`, title: "as a formula of your own" },
      on: { click: () => edited(law, start) },
    });
    const take = make("button", {
      ...{ type: "submit", text: "Add", "aria-label": `add law ${number}` },
      ...{ title: "fit it with the model, as an effect of this name" },
    });
    const name = make("input", {
      ...{ type: "text", name: "name", size: 8, placeholder: "its name", title: "what it is called in the model; law where nothing is typed", spellcheck: "false", autocomplete: "off" },
      "aria-label": `name of law ${number}`,
    });
    const form = make("form", {}, edit, name, take);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.deeds.take(number, /** @type {HTMLInputElement} */ (name).value);
    });
    const look = () => {
      this.draw(number);
      this.deeds.look(number);
    };
    const away = () => {
      this.draw();
      this.deeds.look(null);
    };
    return make(
      "li",
      { class: "law", on: { pointerenter: look, pointerleave: away, focusin: look, focusout: away } },
      // What is drawn by splines has a name, and no formula that anybody reads.
      make("div", { class: "written", title: `typed as ${law}` }, `${number}.`, label === law ? lawOf({ latex: "", law }) : make("span", { text: label })),
      make("span", { class: "figure", text: percent(-fall), title: "fall of the RMS error, beside the model that it was looked for beside" }),
      make("span", { class: "soft", text: [...words, of].join("; ") }),
      doubt ? make("span", { class: "doubt", text: `⚠ ${doubt}` }) : null,
      form,
    );
  }
}

/** Say how a formula of these captures is typed. @param {import("./said.js").About} about */
function showHow(about) {
  const slides = about.coordinate === "linear";
  const [place, speed, change] = slides ? ["x", "v", "dv/dt"] : ["theta", "omega", "alpha"];
  const word = torqueWord(about.unit);
  byId("own-word").textContent = `${word.slice(0, 1).toUpperCase()}${word.slice(1)}`;
  byId("own-how").textContent = `It answers the ${word} in ${about.unit}, of t, ${place}, ${speed}, ${change}, direction and s, the way since a reversal; abs(load)*sign(${speed}) is friction under a load; every other name is a parameter.`;
  const law = /** @type {HTMLInputElement} */ (/** @type {HTMLFormElement} */ (byId("own-form")).elements.namedItem("law"));
  law.placeholder = `2 a (${speed}/w) / (1 + (${speed}/w)^2)`;
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
  form.dispatchEvent(new Event("input"));
}
