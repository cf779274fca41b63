/** Branches of the session: what each has, how far its error fell, and which is shown beside the current one. */

import { make } from "./dom.js";
import { changeOf } from "./names.js";
import { number, torqueScale } from "./numbers.js";

/** @typedef {import("./types.js").State} State */

/**
 * Whether a branch can be held against the current one: it is another, fitted to the same captures.
 * @param {State} state
 * @param {string | null} branch
 */
export function comparable({ branches, branch: current, active }, branch) {
  const other = branches.find(({ id }) => id === branch && id !== current);
  return other !== undefined && other.steps[other.at]?.captures.join() === active.join();
}

/**
 * @param {HTMLElement} place
 * @param {State} state
 * @param {string | null} beside the branch beside the current one
 * @param {{choose: (branch: string) => void, beside: (branch: string | null) => void}} deeds
 */
export function showBranches(place, state, beside, deeds) {
  const focused = document.activeElement?.getAttribute("data-beside");
  const scale = torqueScale(state);
  const cards = state.branches.map(({ id, name, steps, at }) => {
    const step = steps[at];
    const done = steps.slice(0, at + 1);
    const own = done.slice(done.findLastIndex(({ anew }) => anew)); // not of a knob that was here before
    const changed = own.filter(({ added, dropped }) => added || dropped.length > 0); // not only fitted anew
    const changes = changed.map(changeOf);
    const words = changes.join(" ") || "nothing added";
    const card = make(
      "button",
      {
        ...{ type: "button", class: "branch", "aria-pressed": String(id === state.branch), "data-branch": id },
        on: { click: () => deeds.choose(id) },
      },
      make("strong", { text: name }),
      make("span", { class: "soft", text: words }),
      make("span", { class: "figure", text: step ? `${number(step.rmse * scale.factor)} ${scale.unit}` : "–" }),
    );
    if (id === state.branch) return make("div", { class: "card" }, card);
    const there = comparable(state, id);
    const box = make("input", {
      ...{ type: "checkbox", checked: id === beside, "data-beside": id, disabled: !there },
      ...{ title: there ? null : "it is fitted to other captures, or to the same read otherwise" },
      on: { change: () => deeds.beside(id === beside ? null : id) },
    });
    return make("div", { class: "card" }, card, make("label", {}, box, " side by side"));
  });
  place.replaceChildren(...cards);
  if (focused) {
    /** @type {HTMLElement | null} */ (place.querySelector(`[data-beside="${CSS.escape(focused)}"]`))?.focus();
  }
}

/**
 * The captures that a fit is to: of one that is no step yet, those that are shown.
 * @param {string} node
 * @param {import("./types.js").State} state
 */
export function capturesOf(node, { branches, active }) {
  return branches.flatMap(({ steps }) => steps).find((step) => step.node === node)?.captures ?? active;
}
