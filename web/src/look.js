/** The linked plots of a report and of a notebook: steps to choose from, what could be missing beside them. */

import { Candidates } from "./candidates.js";
import { USUAL } from "./contents.js";
import { make } from "./dom.js";
import { Linked } from "./linked.js";
import { known, titleOf } from "./names.js";
import { number, thousands, torqueScale } from "./numbers.js";
import { timed } from "./timing.js";

/** @typedef {import("./store.js").Columns} Columns */
/** @typedef {import("./types.js").Head} Head */

const HINT = "Drag a rectangle in any plot: its samples light up in all of them. Escape clears.";

export class Look {
  /**
   * @param {Head} head
   * @param {Columns} measured t, theta, omega, tau
   * @param {Float32Array[]} residuals of each step
   * @param {{step: (at: number) => void, look: (effect: string | null) => void,
   *   chosen?: () => void}} deeds of the person
   */
  constructor(head, measured, residuals, deeds) {
    this.head = head;
    known(head);
    this.measured = measured;
    this.residuals = residuals;
    this.deeds = deeds;
    /** @type {string | null} the candidate that stays laid over the residuals when the pointer leaves it */
    this.held = null;
    const words = make("p", { class: "soft", "aria-live": "polite", text: HINT });
    /** @type {import("./types.js").Seen} */
    this.view = { axes: USUAL, isolated: false, band: false, held: true };
    this.step = 0;
    this.linked = new Linked(
      (said) => {
        words.textContent = said ?? HINT;
        deeds.chosen?.();
      },
      (axes) => {
        this.view = { ...this.view, axes };
        this.show(this.step);
      },
    );
    this.buttons = head.steps.map(({ label, rmse }, at) => {
      const scale = torqueScale(head);
      const text = `${label}: ${number(rmse * scale.factor)} ${scale.unit}`;
      return make("button", { type: "button", text, on: { click: () => deeds.step(at) } });
    });
    this.looked = make("span", { class: "key" });
    this.missing = make("section", { class: "missing", "aria-label": "what could be missing" });
    this.candidates = new Candidates(
      this.missing,
      { look: (effect) => deeds.look(effect ?? this.held), take: (effect) => this.hold(effect) },
      "Hold",
    );
    const closer = make("button", {
      ...{ type: "button", text: "Zoom", title: "Z: see the rectangle alone, or everything again" },
      on: { click: () => this.linked.lookCloser() },
    });
    const weighed = head.steps.some(({ candidates }) => candidates);
    this.element = make(
      "div",
      { class: "look", on: { keydown: (event) => this.key(event) } },
      make("div", { class: "steps" }, ...this.buttons, ...keys(), this.looked),
      make("div", { class: weighed ? "beside" : "" }, this.linked.element, weighed ? this.missing : null),
      make("div", { class: "below" }, words, closer),
      head.n < head.all ? make("p", { class: "soft", text: thinned(head) }) : null,
    );
    // Around these plots there is something to scroll: the wheel is theirs only once they are clicked.
    this.element.addEventListener("wheel", (event) => within(event) || event.stopPropagation(), { capture: true });
  }

  /** @param {number} step */
  show(step) {
    const { head, measured, residuals } = this;
    const columns = { ...measured, residual: residuals[step] };
    this.step = step;
    this.held = null;
    for (const [at, button] of this.buttons.entries()) button.setAttribute("aria-pressed", String(at === step));
    const { candidates } = head.steps[step];
    this.missing.hidden = candidates === null;
    if (candidates) this.candidates.show({ candidates, concluded: [], node: String(step), job: null, searched: true, active: Array(this.head.captures).fill("") }, head);
    timed("data", () => this.linked.show({ ...head, columns, fitted: true }, this.view));
  }

  /**
   * Lay what a candidate would explain over the residuals.
   * @param {string | null} effect
   * @param {Float32Array | null} signature
   */
  overlay(effect, signature) {
    const said = effect ? [make("i", { class: "signature" }), `what ${titleOf(effect)} would explain`] : [];
    this.looked.replaceChildren(...said);
    timed("look", () => this.linked.overlay(signature));
  }

  /** @param {KeyboardEvent} event */
  key({ key, ctrlKey, altKey, metaKey }) {
    if (key === "Escape") this.clear();
    if (key === "z" && !ctrlKey && !altKey && !metaKey) this.linked.lookCloser();
  }

  /** @param {string} effect to keep; the one that is kept already is let go */
  hold(effect) {
    this.keep(this.held === effect ? null : effect);
  }

  /** Choose nothing, hold nothing. */
  clear() {
    this.keep(null);
    this.linked.clear();
  }

  /** @param {string | null} effect */
  keep(effect) {
    this.held = effect;
    for (const item of this.candidates.items) {
      item.querySelector("button")?.setAttribute("aria-pressed", String(item.dataset.effect === effect));
    }
    this.deeds.look(effect);
  }
}

/** @param {WheelEvent} event @returns {boolean} whether it is over the plot that has the focus */
function within({ target }) {
  return target instanceof Element && target.closest(".plot")?.matches(":focus") === true;
}

function keys() {
  const words = { measured: "measured", modelled: "modelled", masked: "not fitted", wrong: "residual", chosen: "chosen", noise: "± 2 noise floor" };
  return Object.entries(words).map(([name, text]) => make("span", { class: "key" }, make("i", { class: name }), text));
}

/** @param {Head} head */
function thinned({ n, all }) {
  const [shown, whole] = [n, all].map(thousands);
  return `${shown} of ${whole} samples are shown, taken at random; shares of the error are estimated from them.`;
}
