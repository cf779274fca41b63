/** What was hidden in a knob: how the search for it goes, hints, and the answer for who asks. */

import { ask, post } from "./api.js";
import { byId, make } from "./dom.js";
import { titleOf } from "./names.js";

/** @typedef {import("./types.js").State} State */

/** @type {string[]} captures that hide something */
let hiding = [];
let asked = 0;
let level = ""; // of the challenge that is shown

/** @param {{failed: (reason: unknown) => void, done: () => void}} heard */
export function unhiding({ failed, done }) {
  byId("unhide").addEventListener("click", async () => {
    try {
      const told = await Promise.all(hiding.map((capture) => post("hidden", { capture })));
      byId("unhidden").textContent = [...new Set(told.map(({ hidden }) => (hidden ?? []).map(titleOf).join(" and ")))].join("; ");
    } catch (reason) {
      failed(reason);
    }
  });
  const hint = (/** @type {boolean} */ whole) => post("hint", { capture: hiding[0], whole }).catch(failed);
  byId("hint").addEventListener("click", () => hint(false));
  byId("unseal").addEventListener("click", () => hint(true));
  byId("next-challenge").addEventListener("click", () => post("simulate", { level }).then(done, failed));
}

/** @param {State} state */
export async function showHidden({ captures, active }) {
  const now = captures.filter(({ id, hides }) => hides && active.includes(id)).map(({ id }) => id);
  byId("hides").hidden = now.length === 0;
  if (now.join() !== hiding.join()) byId("unhidden").textContent = "";
  hiding = now;
  if (now.length === 0) {
    document.body.classList.remove("sealed");
    return;
  }
  const mine = ++asked;
  /** @type {import("./types.js").Challenge | null} */
  const told = await ask("challenge", { capture: now[0] }).catch(() => null);
  if (told && mine === asked) showStanding(told);
}

/** @param {import("./types.js").Challenge} challenge */
function showStanding({ hints, more, wrong, found, hidden, solved, given_up, graded, level: of, sealed, score }) {
  const over = solved || given_up;
  level = of;
  document.body.classList.toggle("sealed", sealed);
  byId("unseal").hidden = !sealed;
  byId("challenge-said").classList.toggle("well", solved && !given_up);
  byId("challenge-score").textContent = graded ? `${score} points` : "";
  byId("challenge-said").textContent = graded ? standingWords({ wrong, found, hidden, solved, given_up }) : surpriseWords({ found, hidden, solved });
  byId("hint").hidden = !graded || over;
  byId("unhide").hidden = graded && solved && !given_up; // it stands in the model
  byId("next-challenge").hidden = !graded || !over;
  byId("challenge-hints").replaceChildren(...hints.map((text) => make("li", { text })));
  /** @type {HTMLButtonElement} */ (byId("hint")).disabled = !more;
}

/**
 * The same of a surprise, of which the page says all that it thinks: nothing is to be earned, and nothing lost by what
 * the page itself has advised.
 * @param {Pick<import("./types.js").Challenge, "found" | "hidden" | "solved">} standing
 */
export function surpriseWords({ found, hidden, solved }) {
  const [what, is] = hidden === 1 ? ["What was hidden", "one effect is"] : [`All ${hidden} effects that were hidden`, `${hidden} effects are`];
  if (solved) return `${what} ${hidden === 1 ? "is" : "are"} in the model, and nothing that was not.`;
  if (found === hidden) return `${what} ${hidden === 1 ? "is" : "are"} in the model, but so is something that was not.`;
  return `In this knob ${is} hidden${found > 0 ? `, ${found} of them found` : ""}: see whether it is found.`;
}

/**
 * How the search goes, in words.
 * @param {Pick<import("./types.js").Challenge, "wrong" | "found" | "hidden" | "solved" | "given_up">} standing
 */
export function standingWords({ wrong, found, hidden, solved, given_up }) {
  const many = hidden === 1 ? "one effect is hidden" : `${hidden} effects are hidden`;
  const costs = wrong.length > 0 ? `; not there: ${wrong.map(titleOf).join(", ")}` : "";
  if (given_up) return `Given up: ${solved ? "what was hidden is in the model, after it was told" : "add what was hidden, and see the residual become noise"}${costs}.`;
  if (solved) return `Solved: what was hidden is in the model, and nothing that was not${costs}.`;
  if (found === hidden) return `All that is hidden is in the model, but so is something else${costs}.`;
  return `In this knob ${many}${found > 0 ? `, ${found} of them found` : ""}. Look where the residual has structure, and add what explains it${costs}.`;
}
