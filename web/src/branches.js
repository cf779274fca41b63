/** Branches of the session beside each other: what each has, and how far its error fell. */

import { make } from "./dom.js";
import { number, torqueScale } from "./numbers.js";

/** @typedef {import("./types.js").State} State */

/**
 * @param {HTMLElement} place
 * @param {State} state
 * @param {(branch: string) => void} chosen
 */
export function showBranches(place, state, chosen) {
  const tabs = state.branches.map(({ id, name, steps, at }) => {
    const step = steps[at];
    const scale = torqueScale(state.unit, step?.rmse ?? 0);
    const changes = steps.slice(1, at + 1).map(({ added, dropped }) => (added ? `+ ${added}` : `− ${dropped}`));
    const words = changes.join(" ") || "nothing added";
    return make(
      "button",
      {
        ...{ type: "button", class: "branch", "aria-pressed": String(id === state.branch), "data-branch": id },
        on: { click: () => chosen(id) },
      },
      make("strong", { text: name }),
      make("span", { class: "soft", text: words }),
      make("span", { class: "figure", text: step ? `${number(step.rmse * scale.factor)} ${scale.unit}` : "–" }),
    );
  });
  place.replaceChildren(...tabs);
}
