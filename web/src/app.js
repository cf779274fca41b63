/** The workbench's page: what the server tells is shown, what the person does is asked of the server. */

import { download, fetchState, listen, post, wordsOf } from "./api.js";
import { capturesOf, comparable, showBranches } from "./branches.js";
import { samplesOf, showCaptures, showFindings } from "./captures.js";
import { Candidates } from "./candidates.js";
import { byId, shown } from "./dom.js";
import { AnyEffect, about } from "./effects.js";
import { ofLimits } from "./evidence.js";
import { opening, saving } from "./files.js";
import { showHidden, unhiding } from "./hidden.js";
import { jobButtons, showJob } from "./job.js";
import { keys } from "./keys.js";
import { showLadder } from "./ladder.js";
import { latest } from "./latest.js";
import { leaving } from "./leaving.js";
import { showLegend } from "./legend.js";
import { Laws } from "./laws.js";
import { USUAL, columnsOf } from "./contents.js";
import { Looking, showLeft } from "./going.js";
import { known } from "./names.js";
import { Linked } from "./linked.js";
import { Live } from "./live.js";
import { showMoment } from "./moment.js";
import { Next } from "./next.js";
import { Overlay } from "./overlay.js";
import { Params } from "./params.js";
import { preparing, sources } from "./sources.js";
import { Store } from "./store.js";
import { aboutOf, sentence } from "./said.js";
import { themed } from "./theme.js";
import { timed, times } from "./timing.js";
import { showVerdict } from "./verdict.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Job} Job */

class App {
  constructor() {
    this.store = new Store();
    /** @type {State | null} */
    this.state = null;
    /** @type {Job | null} what the server is busy with */
    this.job = null;
    /** @type {import("./types.js").Seen} */
    this.view = { axes: USUAL, isolated: false, band: false, held: true };
    /** @type {(() => void) | null} what is marked once it is drawn */
    this.then = null;
    this.drawn = "";
    /** @type {string | null} the branch that is shown beside the current one */
    this.beside = null;
    /** @type {{what: string, start: number} | null} what the person did that is not painted yet */
    this.deed = { what: "first picture", start: 0 };
    this.looks = new Looking(() => ({ view: this.view, beside: this.beside, brush: this.linked.brushed }));
    /** @type {import("./types.js").Brush | null} what was brushed when the session was left */
    this.brushedThen = null;
    this.linked = new Linked(
      (words) => {
        byId("chosen").textContent = words ?? BRUSH_HINT;
        this.leavable?.();
        this.looks.changed();
      },
      (axes) => this.see({ axes }),
      { fetched: true, pointed: showMoment },
    );
    byId("plots").append(this.linked.element);
    /** @type {(() => void) | undefined} */
    this.leavable = leaving(this.linked, () => this.state, async (runs) => {
      if (await this.ask("leave-out", { runs }, "data")) this.linked.clear();
    });
    this.overlay = new Overlay(this.store, this.linked, () => this.state, (reason) => this.failed(reason));
    this.refresh = latest((/** @type {number} */ revision) => this.load(revision));
    this.drag = latest(async (/** @type {Record<string, number>} */ values) => {
      await this.ask("params", values, "drag");
    });
    this.params = new Params(byId("params"), {
      drag: (values) => this.drag(values),
      drop: (effect) => this.ask("drop", { effect }, "drop"),
    });
    const deeds = {
      look: (/** @type {string | null} */ effect) => this.overlay.look(effect, "signature", { effect: effect ?? "" }),
      take: (/** @type {string} */ effect) => this.ask("add", { effect }, "add"),
      ask: () => this.ask("diagnose"),
      about: (/** @type {import("./types.js").Effect} */ effect) => this.about(effect),
      apart: (/** @type {string[]} */ effects) => void this.next.design(effects),
      bounds: (/** @type {string[]} */ effects) => this.next.bounds(effects),
    };
    this.candidates = new Candidates(byId("candidates"), deeds, "Add");
    this.laws = new Laws(byId("laws"), {
      ask: () => this.ask("propose"),
      look: (number) => this.overlay.look(number === null ? null : `law ${number}`, "law", { number: String(number) }),
      take: (number, name) => this.ask("accept", { number, name }, "add"),
      add: async (formula) => (await this.ask("formula", formula, "add")) !== null,
      attempt: (formula, told) => this.overlay.attempt(formula, told),
    });
    this.any = new AnyEffect((effect) => this.ask("add", { effect }, "add"), (effect) => this.about(effect));
    /** @type {Live | null} */
    this.live = null;
    this.next = new Next({
      store: this.store,
      design: async (body) => {
        await post("design", body);
        this.say("");
        await this.load(Infinity);
      },
      recording: () => this.live?.follow(),
      where: () => this.live?.angle ?? null,
      ...{ made: () => this.refresh(Infinity), drop: (/** @type {string} */ effect) => void this.ask("drop", { effect }, "drop") },
      failed: (reason) => this.failed(reason),
    });
  }

  start() {
    const heard = {
      done: () => this.refresh(Infinity),
      failed: (/** @type {unknown} */ reason) => this.failed(reason),
      say: (/** @type {string} */ words) => this.say(words),
    };
    this.askOf = opening(heard);
    saving(heard);
    unhiding(heard);
    this.live = new Live({ ...heard, open: (path) => this.ask("open", { path }, "data") });
    sources({
      ...{ made: heard.done, say: heard.say, recording: () => this.live?.follow() },
      open: () => this.state?.captures.length ?? 0,
    });
    themed(() => {
      this.linked.redraw();
      this.next.draw();
    });
    this.buttons();
    showMoment(null, null);
    keys({
      stop: () => this.live?.following && this.live.stop(true), // Escape is what a hand finds without looking
      clear: () => this.linked.clear(),
      closer: () => this.linked.lookCloser(),
    });
    listen({
      state: (revision) => this.refresh(revision),
      progress: (job) => (job.recording ? this.showRecording(job) : this.showJob(job)),
      connected: (well) => byId("lost").toggleAttribute("hidden", well),
    });
    this.refresh(0);
  }

  buttons() {
    for (const verb of ["undo", "redo", "snap", "search"]) {
      byId(verb).addEventListener("click", () => this.ask(verb, {}, verb));
    }
    jobButtons((verb) => this.ask(verb), (words) => this.say(words));
    byId("new-branch").addEventListener("click", () => this.ask("branch"));
    byId("clear").addEventListener("click", () => this.linked.clear());
    byId("closer").addEventListener("click", () => this.linked.lookCloser());
    for (const option of /** @type {const} */ (["isolated", "band", "held"])) {
      const box = /** @type {HTMLInputElement} */ (byId(option));
      box.addEventListener("change", () => this.see({ [option]: box.checked }));
    }
  }

  /** See the samples in another way. @param {Partial<App["view"]>} change */
  see(change) {
    this.view = { ...this.view, ...change };
    this.looks.changed();
    this.refresh(Infinity);
  }

  /**
   * Go where a verdict says that the model fails: the axis comes into the first row where no row has it.
   * @param {import("./types.js").Stretch} place
   */
  go(place) {
    const { axes } = this.view;
    if (axes.includes(place.axis)) {
      this.linked.mark(place);
    } else {
      this.then = () => this.linked.mark(place);
      this.see({ axes: [place.axis, ...axes.slice(1)] });
    }
  }

  /** Show the samples of a finding, over time among others. @param {string} capture @param {string} finding */
  async find(capture, finding) {
    const { axes } = this.view;
    const chosen = this.state && (await samplesOf(capture, finding, this.state).catch((reason) => this.failed(reason)));
    if (!chosen) return undefined;
    if (axes.includes("time")) return this.linked.find(chosen);
    this.then = () => this.linked.find(chosen);
    return this.see({ axes: [...axes.slice(0, -1), "time"] });
  }

  /**
   * Ask the server to do something; how long it takes until it is painted is noted under `deed`.
   * @param {string} verb
   * @param {object} [body]
   * @param {string} [deed]
   */
  async ask(verb, body = {}, deed) {
    if (deed) this.deed = { what: deed, start: performance.now() };
    try {
      const answer = await post(verb, body);
      this.say(answer.cut && this.state ? sentence(answer.cut, aboutOf(this.state)) : "");
      if (verb === "search") shown(byId("verdict")); // what was found is said there, however far down it was asked for
      // While the state is on its way; of what was read just now no page knows the captures yet.
      if (answer.node && this.state?.node && deed !== "data") this.expect(answer.node, capturesOf(answer.node, this.state));
      if (answer.revision !== undefined) this.refresh(answer.revision);
      return answer;
    } catch (reason) {
      this.failed(reason);
      return null;
    }
  }

  /** Fetch the samples of a node that is about to be shown. @param {string} node @param {string[]} captures */
  expect(node, captures) {
    this.store.columns(node, captures, columnsOf(this.view)).catch(() => {}); // who draws it is told
  }

  /**
   * Show the newest state, unless what is shown is as new as `revision` and no job can have ended since.
   * @param {number} revision
   */
  async load(revision) {
    if (this.state && this.state.revision >= revision && !this.job) return;
    try {
      const state = await fetchState();
      if (state.node) this.expect(state.node, state.active);
      this.show(state);
      await this.draw(state);
    } catch (reason) {
      this.failed(reason);
    }
  }

  /** @param {State} state */
  show(state) {
    if (this.state?.node !== state.node) this.overlay.look(null); // what was weighed there is not weighed here
    if (!this.state?.node && state.node !== null && state.looked) this.lookAgain(state.looked);
    if (!this.state && state.unread.length > 0) this.askOf?.(state.unread);
    this.state = state;
    known(state);
    const about = aboutOf(state);
    byId("welcome").toggleAttribute("hidden", state.node !== null);
    document.body.classList.toggle("empty", state.node === null);
    showVerdict(byId("verdict"), state, about, {
      place: (place) => this.go(place),
      effect: (effect) => this.candidates.go(effect),
      add: (effect) => this.ask("add", { effect }, "add"),
      apart: (effects) => this.next.design(effects),
      every: () => this.ask("search", {}, "search"),
      ...{ error: () => shown(byId("ladder")), findings: () => shown(byId("findings")), laws: () => shown(byId("laws")) },
    });
    if (state.recording) this.live?.follow();
    showHidden(state);
    showLeft(state.left, {
      go: (session) => this.ask("continue", { session }, "data"),
      anew: async () => {
        await this.ask("anew");
        this.state = null; // at the same revision there is less to offer
        this.refresh(0);
      },
    });
    showCaptures(byId("captures"), state, {
      use: (captures) => this.ask("use", { captures }, "captures"),
      close: (capture) => this.ask("close", { capture }, "captures"),
    });
    showFindings(byId("findings"), state, about, {
      see: (capture, finding) => this.find(capture, finding),
      overrule: (capture, finding, on) => this.ask("overrule", { capture, finding, on }, "data"),
      sharpen: (param) => void this.next.design([], param),
    });
    byId("open-together").hidden = state.captures.length === 0;
    showLadder(byId("ladder"), state);
    if (!comparable(state, this.beside)) this.beside = null;
    this.showBranches(state);
    this.params.show(state.params, state.together, about);
    this.candidates.show(state, about);
    this.laws.show(state);
    this.any.show(state.absent);
    this.next.show(state);
    this.showJob(state.job);
    const branch = state.branches.find(({ id }) => id === state.branch);
    enable("undo", (branch?.at ?? 0) > 0);
    enable("redo", branch !== undefined && branch.at < branch.steps.length - 1);
    enable("snap", state.params.some(({ dragged }) => dragged));
    enable("new-branch", state.node !== null);
    enable("search", state.node !== null && !state.searched);
  }

  /** Look at a session as it was looked at. @param {import("./types.js").Looked} looked */
  lookAgain({ view, beside, brush }) {
    this.view = { ...this.view, ...view };
    for (const option of /** @type {const} */ (["isolated", "band", "held"])) {
      /** @type {HTMLInputElement} */ (byId(option)).checked = view[option];
    }
    this.beside = beside;
    this.brushedThen = brush;
  }

  /** @param {State} state */
  async draw(state) {
    const { node, active } = state;
    const other = state.branches.find(({ id }) => id === this.beside);
    const otherNode = other?.steps[other.at]?.node;
    const wanted = JSON.stringify([node, active, this.view, otherNode, other?.name]);
    if (node === null) this.deed = null; // there is nothing to paint
    if (node === null || wanted === this.drawn) return;
    const columns = await this.store.columns(node, active, columnsOf(this.view));
    const rest = otherNode ? await this.store.columns(otherNode, active, ["residual"]) : null;
    if (this.state && this.state.node !== node) return;
    this.drawn = wanted;
    const { view } = this;
    const { what, start } = this.deed ?? { what: "data", start: performance.now() };
    this.deed = null;
    const fitted = !state.params.some(({ dragged }) => dragged);
    const name = state.branches.find(({ id }) => id === state.branch)?.name;
    const beside = other && rest ? { name: other.name, residual: rest.residual } : null;
    showLegend(state, columns, beside?.name ?? null);
    const splits = fitted ? this.store.splits.get(node) : []; // where nothing is fitted, nothing is told of chance
    const noise = state.noise_floor;
    const of = String(state.captures.filter(({ id }) => active.includes(id)).map((one) => one.name));
    const data = { several: active.length > 1, of, below_hz: state.below_hz, columns, ...aboutOf(state), noise, fitted, name, beside, splits };
    timed(what, () => {
      this.linked.show(data, view);
      if (this.brushedThen) this.linked.brushAgain(this.brushedThen);
      this.then?.();
      [this.brushedThen, this.then] = [null, null];
    }, start);
    if (splits) return;
    const found = await this.store.splitsOf(node).catch(() => []); // without them all else is there
    if (this.state?.node === node) timed("bins", () => this.linked.lay(found));
  }

  /** @param {State} state */
  showBranches(state) {
    showBranches(byId("branches"), state, this.beside, {
      choose: (branch) => this.ask("switch", { branch }, "switch"),
      beside: (branch) => {
        this.beside = branch;
        this.looks.changed();
        this.deed = { what: "beside", start: performance.now() };
        this.showBranches(state);
        this.refresh(Infinity);
      },
    });
  }

  /** Show what an effect is, moved as the capture moved. @param {import("./types.js").Effect} effect */
  about(effect) {
    const { state } = this;
    const { data } = this.linked;
    const node = state?.node;
    const added = async () => {
      if (!state || !node || !state.candidates.rows.some((row) => row.effect === effect.effect)) return null;
      const how = { verb: "signature", asked: { effect: effect.effect, own: "" } };
      return this.store.explained(node, state.active, `${effect.effect} alone`, how);
    };
    about(effect, data && node ? { data, at: this.linked.torques[0].marked, added } : null, state?.unit ?? "N m");
  }

  /** @param {Job | null} job */
  showJob(job) {
    this.job = job;
    showJob(job, this.state ? aboutOf(this.state) : null);
  }

  /** @param {Job} job */
  showRecording({ what, done }) {
    preparing(what.join(""));
    this.live?.phase(what.join(""));
    if (done !== null && !this.live?.following) this.live?.follow(); // one that another page has begun
  }

  /** @param {string} words */
  say(words) {
    byId("said").textContent = words;
    byId("said").classList.remove("wrong");
  }

  /** @param {unknown} reason */
  failed(reason) {
    this.deed = null;
    this.say(this.state ? ofLimits(wordsOf(reason), aboutOf(this.state)) : wordsOf(reason));
    byId("said").classList.add("wrong");
  }
}

const BRUSH_HINT = "Drag a rectangle in any plot: its samples light up in all of them.";

/** @param {string} id @param {boolean} possible */
function enable(id, possible) {
  /** @type {HTMLButtonElement} */ (byId(id)).disabled = !possible;
}

const app = new App();
// For those who measure: how long deeds took, and what the plots show.
Object.assign(globalThis, { knobcam: { times, app, download } });
app.start();
