/** The cross-section of an effect in motion: it goes along a capture, or stands where a person puts it. */

import { make, styleValue } from "./dom.js";
import { number, torqueScale } from "./numbers.js";
import { Motion, SEEN, drawSection, kindOf } from "./section.js";

/** @typedef {import("./types.js").Effect} Effect */
/** @typedef {{data: import("./contents.js").Data, at: number | null, added: () => Promise<Float32Array | null>}} Shown */

const PACE = 0.35; // of the time that the motion took: slower, to be followed

/**
 * What an effect adds at a moment; of one to which nothing is fitted nothing is known.
 * @param {number} seconds
 * @param {number | null} torque SI, null where the effect was not weighed
 * @param {{factor: number, unit: string}} scale
 */
export function momentWords(seconds, torque, { factor, unit }) {
  const at = `${String(Number(seconds.toPrecision(4))).replace("-", "−")} s: `; // no powers of ten: it is a clock
  if (torque === null) return `${at}what it adds is not weighed here`;
  return at + (Number.isFinite(torque) ? `adds ${number(torque * factor)} ${unit}` : "nothing is fitted to this moment");
}

/** The first sample to which something is fitted; the beginning where there is none. @param {Float32Array} column */
export function firstFitted(column) {
  return Math.max(0, column.findIndex((one) => Number.isFinite(one)));
}

/**
 * @param {Effect} effect
 * @param {Shown} shown `added`: what it would add at each sample, null where it is not weighed
 * @returns {HTMLElement}
 */
export function acting(effect, { data, at, added }) {
  const { t } = data.columns;
  const canvas = make("canvas", { class: "section", role: "img", "aria-label": SEEN[kindOf(effect)] });
  const slider = make("input", { type: "range", min: 0, max: t.length - 1, step: 1, value: at ?? 0, "aria-label": "moment" });
  const play = make("button", { type: "button", text: "Play", "aria-pressed": "false" });
  const words = make("span", { class: "soft figure" });
  const element = make(
    "div",
    { class: "acting" },
    ...[canvas, make("div", {}, make("p", { class: "soft", text: SEEN[kindOf(effect)] }), words), make("div", { class: "along" }, play, slider)],
  );
  let motion = new Motion(data.columns, null);
  let [playing, begun] = [false, { clock: 0, time: 0 }];

  const draw = () => {
    const now = Number(slider.value);
    const named = { ink: "--ink", soft: "--soft", shade: "--shade", colour: "--signature" };
    const colours = Object.fromEntries(Object.entries(named).map(([name, style]) => [name, styleValue(style, canvas)]));
    drawSection(canvas, effect, motion, now, /** @type {import("./section.js").Look} */ (colours));
    const scale = torqueScale(data);
    words.textContent = momentWords(t[now], motion.added ? motion.added[now] : null, scale);
  };
  const frame = (/** @type {number} */ clock) => {
    if (!playing || !canvas.isConnected || !canvas.closest("dialog[open]")) return run(false);
    const time = begun.time + (PACE * (clock - begun.clock)) / 1000;
    let now = Number(slider.value);
    while (now < t.length - 1 && t[now] < time) now++;
    slider.value = String(now);
    draw();
    if (now >= t.length - 1) return run(false);
    return requestAnimationFrame(frame);
  };
  const run = (/** @type {boolean} */ on) => {
    playing = on;
    play.textContent = on ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(on));
    if (!on) return;
    if (Number(slider.value) >= t.length - 1) slider.value = "0";
    begun = { clock: performance.now(), time: t[Number(slider.value)] };
    requestAnimationFrame(frame);
  };
  play.addEventListener("click", () => run(!playing));
  slider.addEventListener("input", () => {
    run(false);
    draw();
  });
  added().then(
    (column) => {
      motion = new Motion(data.columns, column);
      // Nobody chose the beginning, and often nothing is fitted to it.
      if (at === null && column && slider.value === "0") slider.value = String(firstFitted(column));
      if (playing) run(true);
      draw();
    },
    () => {}, // without it the motion is still shown
  );
  requestAnimationFrame(() => {
    draw();
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) run(true);
  });
  return element;
}
