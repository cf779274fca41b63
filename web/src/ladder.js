/** The error ladder: one line per step of the branch, down to the noise floor. */

import { make } from "./dom.js";
import { changeOf } from "./names.js";
import { figure, torqueScale } from "./numbers.js";

/** @typedef {import("./types.js").State} State */

const FLOOR =
  "What noise alone would leave. It is read from the torque and from what the model leaves of it, where that is quieter: an error that is the same in every stretch passes for noise until the model has what makes it, and then the floor falls.";
const SAME = 0.1; // of itself that a floor is unsure by

/**
 * @param {HTMLElement} place
 * @param {State} state
 */
export function showLadder(place, state) {
  const branch = state.branches.find(({ id }) => id === state.branch);
  const key = JSON.stringify([branch, state.carried, state.rmse, state.noise_floor, state.unit, state.peak]);
  if (place.dataset.shown === key) return; // or it would fall again
  place.dataset.shown = key;
  const { steps, at: here } = broughtAlong(sameCaptures(branch?.steps ?? [], branch?.at ?? 0), state.carried);
  const errors = steps.flatMap(({ rmse, rmse_heldout }) => [rmse, rmse_heldout]).concat(state.rmse);
  const floor = state.noise_floor;
  const widest = Math.max(...errors.map((error) => error ?? 0), ...steps.map((step) => step.noise_floor ?? 0)) * 1.02;
  const scale = torqueScale(state);
  const shown = (/** @type {number | null} */ value) => figure(value === null ? null : value * scale.factor);

  const lines = steps.map(({ added, along, dropped, rmse, rmse_heldout, noise_floor }, at) => {
    const now = at === here;
    const undone = at > here;
    const label = changeOf({ added, along, dropped }) || (at === 0 ? "first model" : "fitted anew");
    const bar = make("span", { class: "bar" });
    const held = make("span", { class: "held" });
    bar.style.width = `${(100 * rmse) / widest}%`;
    if (now && at > 0) bar.style.setProperty("--from", `${(100 * steps[at - 1].rmse) / widest}%`); // from there it falls
    if (rmse_heldout !== null) held.style.left = `${(100 * rmse_heldout) / widest}%`;
    const track = make("span", { class: "track" }, bar, rmse_heldout === null ? null : held, floorMark(noise_floor, widest));
    return make(
      "li",
      { class: `ladder-line${now ? " now" : ""}${undone ? " undone" : ""}`, "aria-current": now ? "step" : null },
      make("span", { class: "label", text: label, title: [added, ...along, ...dropped].filter(Boolean).join(", ") || label }),
      make("span", { class: "figure", text: shown(rmse), title: "RMS error" }),
      make("span", { class: "figure soft", text: shown(rmse_heldout), title: "on blocks that the fit did not see" }),
      track,
    );
  });
  const head = make(
    "div",
    { class: "ladder-line head" },
    make("span", { class: "legend", text: floor === null ? "noise floor unknown" : `▖noise floor ${floorWords(steps, here, shown)}`, title: FLOOR }),
    make("span", { class: "figure", text: `RMS, ${scale.unit}` }),
    make("span", { class: "figure", text: "unseen" }),
  );
  place.replaceChildren(head, make("ol", {}, ...lines));
  const dragged = state.params.some((param) => param.dragged);
  if (dragged) place.append(make("p", { class: "soft", text: `as dragged: ${shown(state.rmse)} ${scale.unit}` }));
}

/**
 * The steps around the current one that were fitted to the same captures: errors on others cannot be compared. A search
 * begins with the first model, and so does its ladder: what had come in by hand is there with Undo.
 * @param {import("./types.js").Step[]} steps
 * @param {number} at
 */
export function sameCaptures(steps, at) {
  const of = (/** @type {number} */ step) => steps[step]?.captures.join();
  let [first, end] = [at, at + 1];
  while (first > 0 && !steps[first].anew && of(first - 1) === of(at)) first--;
  while (end < steps.length && !steps[end].anew && of(end) === of(at)) end++;
  return { steps: steps.slice(first, end), at: at - first };
}

/**
 * The same, with what the model of the first of them brought along as steps of their own.
 * @param {{steps: import("./types.js").Step[], at: number}} shown
 * @param {import("./types.js").Carried[]} carried
 */
function broughtAlong({ steps, at }, carried) {
  const brought = carried.map((one) => ({ ...steps[0], along: [], dropped: [], ...one }));
  return brought.length > 1 ? { steps: [...brought, ...steps.slice(1)], at: at + brought.length - 1 } : { steps, at };
}

/**
 * The floor of the current step, and what it was thought to be with the first model where that was clearly another.
 * @param {{noise_floor: number | null}[]} steps
 * @param {number} here
 * @param {(value: number) => string} shown
 */
export function floorWords(steps, here, shown) {
  const [now, first] = [steps[here].noise_floor ?? 0, steps[0].noise_floor ?? 0];
  const other = now > 0 && first > 0 && Math.abs(now / first - 1) > SAME;
  return other ? `${shown(now)} (${shown(first)} seen by the first model)` : shown(now);
}

/** @param {number | null} floor @param {number} widest */
function floorMark(floor, widest) {
  if (floor === null) return null;
  const mark = make("span", { class: "floor" });
  mark.style.left = `${(100 * floor) / widest}%`;
  return mark;
}
