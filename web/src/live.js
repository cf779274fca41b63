/** A recording while it goes on: plots that grow, figures, and the way to stop it. */

import { Refusal, fetchBytes, post, wordsOf } from "./api.js";
import { limits } from "./axes.js";
import { byId } from "./dom.js";
import { number, thousands, torqueScale } from "./numbers.js";
import { Plot } from "./plot.js";
import { unpacked } from "./store.js";
import { timed } from "./timing.js";

/** @typedef {import("./types.js").Live} Told */

const PAUSE_MS = 120; // between the answer to one question and the next question
const PATIENCE = 8; // questions that may stay without an answer
const PLOTS = /** @type {const} */ ([
  { y: "tau", x: "t", name: "torque over time" },
  { y: "tau", x: "theta", name: "torque over position" },
  { y: "theta", x: "t", name: "angle over time" },
  { y: "omega", x: "t", name: "velocity over time" },
]);
const WORDS = { tau: "torque", theta: "angle, rad", omega: "velocity, rad/s", t: "time, s" };

export class Live {
  /**
   * @param {{done: () => void, failed: (reason: unknown) => void, say: (words: string) => void,
   *   open: (path: string) => void}} heard
   */
  constructor(heard) {
    this.heard = heard;
    this.plots = PLOTS.map(({ name }) => new Plot(`${name}, as it is recorded`, () => {}));
    byId("live-plots").append(...this.plots.map(({ element }) => element));
    /** @type {Record<string, Float32Array>} what has come */
    this.columns = {};
    /** @type {Told | null} */
    this.told = null;
    this.waiting = false;
    this.following = false;
    this.unwanted = false;
    byId("live-stop").addEventListener("click", () => this.stop(true));
    byId("live-cancel").addEventListener("click", () => this.stop(false));
    byId("live-close").addEventListener("click", () => this.close());
    byId("live-open").addEventListener("click", () => {
      this.close();
      if (this.told) heard.open(this.told.log);
    });
    new ResizeObserver(() => this.draw()).observe(byId("live-plots"));
  }

  /** Show the recording until it has ended. */
  async follow() {
    if (this.following) return byId("live-stop").focus(); // which a dialog that closes takes away
    this.following = true;
    this.unwanted = false;
    this.forget();
    this.phase("");
    this.offer(["live-stop", "live-cancel"]);
    byId("live-said").textContent = "";
    byId("live").hidden = false;
    byId("live-stop").focus();
    let silent = 0; // questions in a row that nobody answered
    try {
      do {
        try {
          await this.look();
          silent = 0;
        } catch (reason) {
          if (reason instanceof Refusal || ++silent > PATIENCE) throw reason;
        }
      } while (!this.told?.ended && (await pause()));
      this.ended();
    } catch (reason) {
      byId("live-said").textContent = wordsOf(reason);
      this.offer(["live-close"]);
    } finally {
      this.following = false;
    }
  }

  /** The newest angle of what is recorded, rad; null where nothing is. */
  get angle() {
    return this.following ? (this.columns.theta?.at(-1) ?? null) : null;
  }

  /** Nothing is known yet of what is recorded now. */
  forget() {
    this.columns = {};
    this.told = null;
  }

  /** Fetch what came since the last time, and show it in the next frame. */
  async look() {
    const since = String(this.columns.t?.length ?? 0);
    const { head, columns } = unpacked(await fetchBytes("/api/live", { since }));
    this.told = head.live ?? null;
    for (const [name, more] of Object.entries(columns)) this.columns[name] = appended(this.columns[name], more);
    if (this.waiting) return; // a page that nobody looks at draws nothing
    this.waiting = true;
    timed("live", () => {
      this.waiting = false;
      this.tell();
      this.draw();
    });
  }

  /** @param {boolean} keep */
  async stop(keep) {
    this.unwanted = !keep;
    this.offer([]);
    this.phase(keep ? "stopping" : "disarming");
    try {
      await post("stop", { keep });
    } catch (reason) {
      this.heard.failed(reason);
    }
  }

  /** Say what is being done. @param {string} what */
  phase(what) {
    byId("live-what").textContent = what;
  }

  ended() {
    const { error, log, capture } = this.told ?? {};
    if (capture !== null || this.unwanted) {
      this.close();
      this.heard.say(error ?? `recorded ${log}`);
      this.heard.done();
      return;
    }
    this.phase("the recording has ended");
    byId("live-said").textContent = error ?? "";
    this.offer(this.told?.received ? ["live-open", "live-close"] : ["live-close"]);
    byId("live-close").focus();
  }

  close() {
    byId("live").hidden = true;
  }

  /** Show these buttons and no others. @param {string[]} ids */
  offer(ids) {
    for (const id of ["live-stop", "live-cancel", "live-open", "live-close"]) byId(id).hidden = !ids.includes(id);
  }

  /** The figures in words. */
  tell() {
    if (!this.told) return;
    const { what, log, every, done, elapsed_s, total_s, received = 0, missing = 0, rate_hz } = this.told;
    if (byId("live-what").textContent === "") this.phase(what);
    const bar = /** @type {HTMLProgressElement} */ (byId("live-done"));
    if (done === null) bar.removeAttribute("value");
    else bar.value = done;
    byId("live-time").textContent = `${seconds(elapsed_s)} of ${seconds(total_s)}`;
    const { peak_torque: peak, torque_limit: limit = 0, temperature, clipped = {} } = this.told;
    const scale = torqueScale({ unit: "N m", peak: peak ?? 0 });
    const figures = [
      `${thousands(received)} samples`,
      `${thousands(missing)} lost`,
      `${thousands(Math.round(rate_hz ?? 0))} Hz`,
    ];
    if (peak) figures.push(`peak ${number(peak * scale.factor)} ${scale.unit}, allowed ${number(limit * scale.factor)}`);
    for (const [name, count] of Object.entries(clipped)) if (count) figures.push(`${name} saturated ${count} times`);
    if (typeof temperature === "number") figures.push(`${Math.round(temperature)} °C`);
    byId("live-figures").textContent = figures.join(" · ");
    byId("live-figures").classList.toggle("wrong", missing > 0);
    const drawn = every > 1 ? `Drawn here: one of every ${every} samples. ` : "";
    byId("live-note").textContent = `${drawn}The wire log has everything: ${log}`;
  }

  draw() {
    const { t } = this.columns;
    if (!t || t.length === 0 || byId("live").hidden) return;
    for (const [at, { x, y, name }] of PLOTS.entries()) {
      const [low, high] = limits([this.columns[y]]);
      const across = x === "t" ? [0, span(t[t.length - 1], this.told?.total_s)] : limits([this.columns[x]]);
      const scale = y === "tau" ? torqueScale({ unit: "N m", peak: Math.max(-low, high) }) : null;
      this.plots[at].show({
        title: name,
        x: this.columns[x],
        xAxis: { low: across[0], high: across[1], factor: 1, label: WORDS[x] },
        yAxis: { low, high, factor: scale?.factor ?? 1, label: scale ? `${WORDS[y]}, ${scale.unit}` : WORDS[y] },
        series: [{ colour: "--measured", chosen: null, y: this.columns[y], strength: 0.6 }],
        picked: 0,
        noise: null,
      });
    }
  }
}

/** @param {Float32Array | undefined} before @param {Float32Array} more */
function appended(before, more) {
  if (!before) return more;
  if (more.length === 0) return before;
  const whole = new Float32Array(before.length + more.length);
  whole.set(before);
  whole.set(more, before.length);
  return whole;
}

/**
 * How much time an axis shows: it doubles whenever it is full, up to the whole run.
 * @param {number} elapsed
 * @param {number} [total]
 */
function span(elapsed, total = Infinity) {
  return Math.min(total, Math.max(2, 2 ** Math.ceil(Math.log2(elapsed))));
}

/** @param {number | undefined} value */
function seconds(value) {
  return value === undefined ? "–" : `${value.toFixed(1)} s`;
}

/** @returns {Promise<true>} */
function pause() {
  return new Promise((resolve) => setTimeout(() => resolve(true), PAUSE_MS));
}
