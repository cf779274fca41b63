/** A metronome that leads a hand through a motion: a moving mark, where it turns next, the time left, and clicks. */

import { byId, styleValue } from "./dom.js";
import { COUNT_IN, angleAt, beats, range, stepAt, turnings } from "./lead.js";
import { number } from "./numbers.js";

/** @typedef {import("./types.js").HandStep} HandStep */

const AHEAD = 3; // seconds of the way that are seen before they come
const BEHIND = 0.5;
const CLICK = { turn: 1100, other: 700, length: 0.04 };

export class Metronome {
  /** @param {() => number | null} where the knob stands, rad, while it is recorded */
  constructor(where) {
    this.where = where;
    this.canvas = /** @type {HTMLCanvasElement} */ (byId("lead-way"));
    /** @type {import("./lead.js").Motion | null} */
    this.motion = null;
    /** @type {HandStep[]} */
    this.steps = [];
    /** @type {import("./lead.js").Beat[]} */
    this.beats = [];
    /** @type {import("./lead.js").Beat[]} */
    this.turnings = [];
    this.unit = { factor: 180 / Math.PI, name: "°" };
    this.next = 0; // of the beats
    /** @type {number | null} when the motion begins, ms; null while nothing is led */
    this.start = null;
    /** @type {AudioContext | null} */
    this.sound = null;
    byId("lead-start").addEventListener("click", () => (this.start === null ? this.begin() : this.stop()));
    byId("lead-close").addEventListener("click", () => this.close());
    new ResizeObserver(() => this.draw(this.seconds)).observe(this.canvas);
  }

  /**
   * Show it, ready to begin.
   * @param {import("./lead.js").Motion} motion
   * @param {HandStep[]} steps
   * @param {"rotary" | "linear"} coordinate
   */
  open(motion, steps, coordinate) {
    this.motion = motion;
    this.steps = steps;
    this.beats = beats(motion, steps);
    this.turnings = turnings(motion);
    this.unit = coordinate === "linear" ? { factor: 1000, name: " mm" } : { factor: 180 / Math.PI, name: "°" };
    byId("lead").hidden = false;
    this.stop();
    byId("lead-start").focus();
  }

  close() {
    this.stop();
    byId("lead").hidden = true;
  }

  /** Count in, and lead. */
  begin() {
    this.start = performance.now() + 1000 * COUNT_IN;
    this.next = -COUNT_IN + 1; // below 0: of the counting in
    byId("lead-start").textContent = "Stop";
    if (/** @type {HTMLInputElement} */ (byId("lead-click")).checked) this.sound ??= new AudioContext();
    requestAnimationFrame(() => this.go());
  }

  stop() {
    this.start = null;
    byId("lead-start").textContent = "Start";
    this.draw(0); // the first of the way, to be looked at
  }

  /** Seconds since the motion began, below 0 while it is counted in. */
  get seconds() {
    return this.start === null ? 0 : (performance.now() - this.start) / 1000;
  }

  get length() {
    return this.motion ? this.motion.t[this.motion.t.length - 1] : 0;
  }

  go() {
    if (this.start === null) return;
    const now = this.seconds;
    this.clickUntil(now);
    this.draw(now);
    if (now > this.length + BEHIND) this.stop();
    else requestAnimationFrame(() => this.go());
  }

  /** @param {number} now */
  clickUntil(now) {
    for (;;) {
      const at = this.next < 0 ? this.next : this.beats[this.next]?.at;
      if (at === undefined || at > now) return;
      this.click(this.next >= 0 && this.beats[this.next].turn);
      this.next++;
    }
  }

  /** @param {boolean} turn */
  click(turn) {
    const mark = byId("lead-beat");
    mark.classList.remove("turn", "beat");
    void mark.offsetWidth; // so that the same animation begins anew
    mark.classList.add(turn ? "turn" : "beat");
    if (!this.sound || !(/** @type {HTMLInputElement} */ (byId("lead-click")).checked)) return;
    const [tone, loud] = [this.sound.createOscillator(), this.sound.createGain()];
    const at = this.sound.currentTime;
    tone.frequency.value = turn ? CLICK.turn : CLICK.other;
    loud.gain.setValueAtTime(turn ? 0.4 : 0.2, at);
    loud.gain.exponentialRampToValueAtTime(1e-3, at + CLICK.length);
    tone.connect(loud).connect(this.sound.destination);
    tone.start(at);
    tone.stop(at + CLICK.length);
  }

  /** @param {number} now */
  draw(now) {
    if (!this.motion || byId("lead").hidden) return;
    this.tell(now);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width < 50 || height < 50) return;
    const scale = globalThis.devicePixelRatio || 1;
    this.canvas.width = Math.round(width * scale);
    this.canvas.height = Math.round(height * scale);
    const brush = this.canvas.getContext("2d");
    if (!brush) return;
    brush.scale(scale, scale);
    this.drawWay(brush, now, width, height);
  }

  /** @param {CanvasRenderingContext2D} brush @param {number} now @param {number} width @param {number} height */
  drawWay(brush, now, width, height) {
    const motion = /** @type {import("./lead.js").Motion} */ (this.motion);
    const [low, high] = range(motion.theta);
    const air = 24;
    const across = (/** @type {number} */ theta) =>
      high > low ? air + ((theta - low) / (high - low)) * (width - 2 * air) : width / 2;
    const line = height - 42; // where it is now
    const up = (/** @type {number} */ t) => line - ((t - now) / AHEAD) * (line - 10);
    const colour = (/** @type {string} */ name) => styleValue(name, this.canvas);

    brush.strokeStyle = colour("--line");
    brush.lineWidth = 1;
    for (const end of [low, high]) stroke(brush, [[across(end), 6], [across(end), line + 12]]);
    stroke(brush, [[6, line], [width - 6, line]]);
    brush.fillStyle = colour("--soft");
    brush.font = "13px system-ui, 'DejaVu Sans', sans-serif";
    brush.textAlign = "center";
    for (const end of high > low ? [low, high] : [low]) {
      brush.fillText(`${number(Number((end * this.unit.factor).toFixed(1)))}${this.unit.name}`, across(end), height - 10);
    }

    const points = Array.from({ length: 241 }, (_, n) => now - BEHIND + (n / 240) * (AHEAD + BEHIND));
    brush.strokeStyle = colour("--signature");
    brush.lineWidth = 3;
    stroke(brush, points.map((t) => [across(angleAt(motion, t)), up(t)]));
    for (const beat of [...this.beats.filter(({ turn }) => !turn), ...this.turnings]) {
      if (beat.at < now || beat.at > now + AHEAD) continue;
      dot(brush, across(beat.theta), up(beat.at), beat.turn ? 5 : 3, colour(beat.turn ? "--chosen" : "--soft"));
    }
    dot(brush, across(angleAt(motion, now)), line, 11, colour("--modelled"));
    const where = this.where();
    if (where !== null) dot(brush, Math.min(width, Math.max(0, across(where))), line, 6, colour("--wrong"));
  }

  /** What to do, and how long it still takes. @param {number} now */
  tell(now) {
    const left = Math.max(0, this.length - Math.max(0, now));
    byId("lead-left").textContent = now < 0 && this.start !== null ? `${Math.ceil(-now)}` : `${left.toFixed(1)} s`;
    byId("lead-left").classList.toggle("soon", now < 0 && this.start !== null);
    const at = stepAt(this.steps, now);
    byId("lead-now").textContent = this.steps[at]?.words ?? "";
    byId("lead-then").textContent = this.steps[at + 1] ? `then ${this.steps[at + 1].words}` : "then it is done";
  }
}

/** @param {CanvasRenderingContext2D} brush @param {number[][]} points */
function stroke(brush, points) {
  brush.beginPath();
  for (const [x, y] of points) brush.lineTo(x, y);
  brush.stroke();
}

/** @param {CanvasRenderingContext2D} brush @param {number} x @param {number} y @param {number} size @param {string} colour */
function dot(brush, x, y, size, colour) {
  brush.beginPath();
  brush.arc(x, y, size, 0, 2 * Math.PI);
  brush.fillStyle = colour;
  brush.fill();
}
