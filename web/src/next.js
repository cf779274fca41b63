/** The next experiment: the motion that would tell candidates apart, over what was recorded; recorded, told. */

import { Refusal, fetchBytes, post, wordsOf } from "./api.js";
import { limits } from "./axes.js";
import { byId, make } from "./dom.js";
import { bars, inFormWords, ofLimits } from "./evidence.js";
import { Metronome } from "./metronome.js";
import { listed } from "./names.js";
import { motionWords, number, torqueScale, torqueWord } from "./numbers.js";
import { Plot } from "./plot.js";
import { Port } from "./port.js";
import { aboutOf, nodes, sentence } from "./said.js";
import { decode } from "./store.js";
import { timed } from "./timing.js";
import { alikeOf, insteadOf, purposeOf, showUntold, tellsNext, waitsFor } from "./untold.js";
import { Within } from "./within.js";

/** @typedef {import("./types.js").Experiment} Experiment */
/** @typedef {import("./types.js").State} State */
/** @typedef {Record<string, Float32Array>} Columns */

const COLOURS = ["--modelled", "--wrong", "--signature", "--beside", "--chosen", "--ink", "--band", "--measured"];
const MOTION = ["t", "theta", "omega"];
const FLAT = 0.2; // of what was recorded: a motion that is smaller is seen from near

export class Next {
  /**
   * @param {{store: import("./store.js").Store, design: (body: object) => Promise<unknown>,
   *   recording: () => void, where: () => number | null, made: () => void, drop: (effect: string) => void, failed: (reason: unknown) => void}} deeds
   */
  constructor(deeds) {
    this.deeds = deeds;
    this.metronome = new Metronome(deeds.where);
    this.within = new Within(() => this.again());
    this.port = new Port((how) => this.attempt(how), () => this.metronome.begin());
    this.plots = ["angle over time", "velocity over angle", "torques of the rivals"].map(
      (name) => new Plot(`${name} of the next experiment`, () => {}),
    );
    byId("next-plots").append(...this.plots.map(({ element }) => element));
    /** @type {State | null} */
    this.state = null;
    /** @type {Columns | null} */
    this.motion = null;
    /** @type {Promise<unknown> | null} what brings it */
    this.loading = null;
    this.drawn = "";
    /** @type {string[] | undefined} the effects that a motion was asked for last */
    this.effects = undefined;
    this.sharpen = ""; // the parameter that it was asked for instead
    this.buttons();
    new ResizeObserver(() => this.draw()).observe(byId("next-plots"));
  }

  buttons() {
    byId("next-show").addEventListener("click", () => (this.told ? this.open() : this.design([])));
    byId("next-close").addEventListener("click", () => this.close());
    byId("next-record").addEventListener("click", () => this.attempt({}));
    byId("next-port").addEventListener("click", () => this.port.ask(false));
    byId("next-hand").addEventListener("click", () => this.lead());
    byId("next-file").addEventListener("click", () => this.save());
    byId("lead-record").addEventListener("click", () => this.recordHand());
    byId("next-bounds").addEventListener("click", () => this.bounds());
  }

  /** @returns {Experiment | null} */
  get told() {
    return this.state?.experiment ?? null;
  }

  /** The effects that the motion which is shown is for; none where it is for a parameter. @returns {string[]} */
  get rivals() {
    const rivals = this.told?.rivals ?? [];
    return rivals.length > 1 ? rivals.map((rival) => effectsOf(rival).at(-1) ?? "") : [];
  }

  /** Which effects a motion would be for that is designed within other limits. @returns {string[]} */
  get asked() {
    return this.effects ?? (this.told || !this.state ? this.rivals : alikeOf(this.state));
  }

  /** Show the limits, before there is a motion as well. @param {string[]} [effects] that it would be for */
  bounds(effects) {
    if (effects) this.effects = effects;
    this.open();
    /** @type {HTMLDetailsElement} */ (byId("next-within")).open = true;
  }

  /** Design within the limits as they are now; where a motion waits for what is missing, they are kept for it. */
  again() {
    return this.waits ? this.close() : this.design(this.asked, this.sharpen);
  }

  /** Whether there is nothing yet that a motion could be designed for. */
  get waits() {
    return this.state !== null && this.told === null && !this.sharpen && this.asked.length === 0 && waitsFor(this.state);
  }

  /**
   * Design a motion for effects, and show it; for none: for what is known least. Where none is within the limits, they
   * are shown in its place.
   * @param {string[]} effects
   * @param {string} [sharpen] the parameter that it is to make known best
   * @returns {Promise<boolean>} whether there is one
   */
  async design(effects, sharpen = "") {
    [this.effects, this.sharpen] = [effects, sharpen];
    const by_hand = /** @type {HTMLInputElement} */ (byId("next-only-hand")).checked;
    this.enable(false);
    this.refuse("");
    try {
      await this.deeds.design({ effects, sharpen, limits: this.within.wanted, by_hand });
      this.open();
      return true;
    } catch (reason) {
      const words = this.state ? ofLimits(wordsOf(reason), aboutOf(this.state)) : "";
      if (!words.startsWith("limits")) {
        this.deeds.failed(reason);
        return false;
      }
      this.open();
      this.refuse(words, reason instanceof Refusal ? reason.enough : null);
      return false;
    } finally {
      this.enable(true);
    }
  }

  /**
   * Say why there is no motion, and with which limit there would be one; nothing where there is.
   * @param {string} words
   * @param {import("./types.js").Enough | null} [enough]
   */
  refuse(words, enough = this.told?.change ?? null) {
    byId("next-refused").textContent = words;
    if (words) /** @type {HTMLDetailsElement} */ (byId("next-within")).open = true;
    if (this.state) this.within.offer(enough, this.state);
  }

  /** What makes another one waits for this one. @param {boolean} free */
  enable(free) {
    for (const id of ["next-record", "next-port", "next-again", "next-hand", "next-show", "next-enough"]) {
      /** @type {HTMLButtonElement} */ (byId(id)).disabled = !free;
    }
  }

  open() {
    byId("next").hidden = false;
    this.drawn = "";
    if (this.state) this.show(this.state);
    byId("next-close").focus();
  }

  close() {
    this.metronome.close();
    byId("next").hidden = true;
  }

  /** @param {State} state */
  show(state) {
    if (this.state?.node !== state.node) [this.effects, this.sharpen] = [undefined, ""]; // what was asked of another model
    this.state = state;
    showUntold(byId("untold"), state, (effects) => this.design(effects), this.deeds.drop);
    const { experiment, node, recording } = state;
    byId("next-line").hidden = experiment === null && !tellsNext(state);
    const instead = experiment === null ? insteadOf(state) : "";
    byId("next-show").textContent = experiment ? "Next experiment…" : instead ? "Design that motion…" : "What to record next…";
    byId("next-show").hidden = experiment === null && waitsFor(state);
    // Of what a motion does not show its limits are no help.
    byId("next-bounds").hidden = experiment === null && state.record !== null && waitsFor(state);
    byId("next").classList.toggle("without", experiment === null);
    if (node === null) byId("next").hidden = true;
    this.within.show(state);
    if (experiment === null) {
      byId("next-said").textContent = instead;
      for (const id of ["next-time", "next-verdict"]) byId(id).textContent = "";
      const { asked } = this;
      byId("next-headline").replaceChildren(...(asked.length > 1 ? ["For a motion that tells apart ", ...allOf(asked), "."] : [purposeOf(state)]));
      byId("next-again").textContent = this.waits ? "Keep" : "Design";
      return;
    }
    // How it moves is told where it is shown.
    byId("next-said").replaceChildren(...nodes(experiment.verdict ?? experiment.promises, aboutOf(state)));
    if (byId("next").hidden) return;
    this.enable(!recording);
    const shown = JSON.stringify([experiment, node, state.active]);
    if (shown === this.drawn) return;
    this.drawn = shown;
    this.tell(experiment, state);
    this.loading = this.load(experiment, state).catch(this.deeds.failed);
  }

  /** @param {Experiment} experiment @param {State} state */
  tell(experiment, state) {
    const { headline, verdict, source, pairs, steps, by_hand, seconds } = experiment;
    const about = aboutOf(state);
    if (experiment.capture === null) this.within.adopt(experiment.limits);
    this.within.show(state);
    this.refuse("");
    byId("next-again").textContent = "Design again";
    byId("next-time").textContent = `${number(seconds)} s`;
    const called = headline.map((part) => (typeof part === "string" ? inFormWords(part, about) : part));
    byId("next-headline").replaceChildren(...nodes(called, about));
    byId("next-verdict").replaceChildren(...nodes(verdict ?? [], about));
    byId("next-record").hidden = source === null;
    byId("next-record").textContent = experiment.capture ? "Record it again" : "Record it";
    byId("next-record").title = source ? `from ${source}` : "";
    byId("next-source").textContent = source ? `from ${source}` : "";
    byId("next-keys").replaceChildren(...experiment.rivals.map((rival, at) => key(nodes(rival, about), at)));
    byId("next-evidence").hidden = pairs.length === 0;
    byId("next-pairs").replaceChildren(...pairs.flatMap((pair) => bars(pair, about, experiment.told)));
    const tempi = new Set(steps.map(({ beats }) => Math.round(beats)).filter(Boolean));
    const led = tempi.size === 1 ? ` at ${[...tempi][0]} beats a minute` : "";
    byId("next-can").textContent = by_hand ? `By hand, led by a metronome${led}` : "For a motor";
    byId("next-no-hand").hidden = by_hand;
    byId("next-steps").replaceChildren(...(by_hand ? steps : []).map(({ words }) => make("li", {}, sentence([words], about))));
  }

  /** @param {Experiment} experiment @param {State} state */
  async load(experiment, { node, active }) {
    if (node === null) return;
    const { store } = this.deeds;
    const [motion, ...parts] = await Promise.all([
      fetchBytes("/api/motion", { experiment: experiment.id }).then(decode),
      ...active.map((capture) => store.ofCapture(node, capture, MOTION)),
    ]);
    this.motion = motion;
    this.recorded = parts;
    timed("experiment", () => this.draw());
  }

  /** Draw the motion over what was recorded, and by what the rivals part on it. */
  draw() {
    const { motion, recorded = [], state } = this;
    if (!motion || !state?.experiment || byId("next").hidden) return;
    const words = motionWords(aboutOf(state));
    const both = (/** @type {string} */ name) => [...recorded.map((part) => part[name]), motion[name]];
    const since = recorded.map(({ t }) => t.map((value) => value - (t[0] ?? 0)));
    const [over, across] = ["theta", "omega"].map((name) => ({ y: both(name), name }));
    for (const [at, { y, name }] of [over, across].entries()) {
      const x = at === 0 ? [...since, motion.t] : both("theta");
      const label = (/** @type {"theta" | "omega"} */ one) => `${words[one].name}, ${words[one].unit}`;
      this.plots[at].show({
        title: at === 0 ? `${words.theta.name} over time` : `velocity over ${words.theta.name}`,
        ...clouds(x, y, ["--measured", "--signature"]),
        xAxis: at === 0 ? axis(limits(x), "time, s") : seen(x, label("theta")),
        yAxis: seen(y, label(/** @type {"theta" | "omega"} */ (name))),
        ...{ picked: 0, noise: null },
      });
    }
    const apart = state.experiment.rivals.map((_, at) => motion[`rival ${at}`]);
    const [low, high] = limits(apart);
    const scale = torqueScale(state);
    this.plots[2].show({
      title: apart.length > 1 ? `how the ${torqueWord(state.unit)} of each rival parts from the others` : `${torqueWord(state.unit)} that it takes`,
      x: motion.t,
      series: apart.map((y, at) => ({ colour: COLOURS[at % COLOURS.length], chosen: null, y, strength: 1 })),
      xAxis: axis(limits([motion.t]), "time, s"),
      yAxis: { low, high, factor: scale.factor, label: apart.length > 1 ? `less their mean, ${scale.unit}` : scale.unit },
      ...{ picked: 0, noise: null },
    });
  }

  /** Record the motion. @param {Record<string, unknown>} how @returns {Promise<boolean>} whether it began */
  async attempt(how) {
    if (!this.told) return false;
    const live = !this.told.source?.startsWith("the simulated") || "port" in how;
    this.enable(false);
    try {
      await post("try", { experiment: this.told.id, ...how });
    } catch (reason) {
      if ("port" in how) throw reason;
      this.deeds.failed(reason);
      return false;
    } finally {
      this.enable(true);
    }
    if (live) this.deeds.recording();
    else this.deeds.made();
    return true;
  }

  /** Lead a hand through the motion; where it is for a motor, through one that a hand can make. */
  async lead() {
    if (this.told && !this.told.by_hand) {
      /** @type {HTMLInputElement} */ (byId("next-only-hand")).checked = true;
      this.within.read();
      if (!(await this.design(this.asked))) return;
    }
    await this.loading;
    const { told, motion, state } = this;
    if (!told || !motion) return;
    if (state) this.metronome.open({ t: motion.t, theta: motion.theta }, told.steps, aboutOf(state).coordinate);
  }

  /** Record while the hand is led: from the rig of before, or from one that is asked for. */
  async recordHand() {
    const source = this.told?.source ?? "";
    if (!source.startsWith("the rig") && !source.startsWith("an emulated")) return this.port.ask(true);
    if (await this.attempt({ by_hand: true })) this.metronome.begin();
  }

  async save() {
    if (!this.told) return;
    try {
      const content = await fetchBytes("/api/motion-file", { experiment: this.told.id });
      const place = URL.createObjectURL(new Blob([content]));
      make("a", { href: place, download: "motion.toml" }).click();
      setTimeout(() => URL.revokeObjectURL(place), 10_000);
    } catch (reason) {
      this.deeds.failed(reason);
    }
  }
}

/** @param {[number, number]} ends @param {string} label */
function axis([low, high], label) {
  return { low, high, factor: 1, label };
}

/** An axis of all of it, or of the motion, which comes last, where that would be a line beside it. @param {Float32Array[]} every @param {string} label */
function seen(every, label) {
  const [whole, own] = [limits(every), limits(every.slice(-1))];
  const flat = own[1] - own[0] < FLAT * (whole[1] - whole[0]);
  return { ...axis(flat ? own : whole, label), part: flat };
}

/**
 * Columns of different things as series of one plot: each is no number where another one is.
 * @param {Float32Array[]} x the last of which is the motion
 * @param {Float32Array[]} y
 * @param {[string, string]} colours of what was recorded, and of the motion
 */
function clouds(x, y, [before, motion]) {
  const whole = x.reduce((total, column) => total + column.length, 0);
  const first = whole - x[x.length - 1].length;
  const along = new Float32Array(whole);
  const [old, fresh] = [new Float32Array(whole).fill(NaN), new Float32Array(whole).fill(NaN)];
  let at = 0;
  for (const [n, column] of x.entries()) {
    along.set(column, at);
    (at < first ? old : fresh).set(y[n], at);
    at += column.length;
  }
  return {
    x: along,
    series: [
      { colour: before, chosen: null, y: old, strength: 0.5 },
      { colour: motion, chosen: null, y: fresh, strength: 1 },
    ],
  };
}

/** @param {string[]} effects at least two of them */
function allOf(effects) {
  return [...listed(effects.slice(0, -1), ", "), " and ", ...listed(effects.slice(-1), "")];
}

/** @param {(Node | string)[]} name @param {number} at */
function key(name, at) {
  const mark = make("i", {});
  mark.style.background = `var(${COLOURS[at % COLOURS.length]})`;
  return make("span", { class: "key" }, mark, ...name);
}

/** The effects that make a rival, by their ids. @param {Experiment["rivals"][0]} rival */
function effectsOf(rival) {
  return rival.flatMap((part) => (typeof part === "object" && "effect" in part ? [part.effect] : []));
}
