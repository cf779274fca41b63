/** What an effect or a law would explain, laid over the residuals while a person looks at it. */

import { post, wordsOf } from "./api.js";
import { byId } from "./dom.js";
import { titleOf } from "./names.js";
import { timed } from "./timing.js";

/** @typedef {import("./types.js").State} State */

const TYPED = "the formula that is typed";
const LOOK_MS = 60; // a pointer that only passes over a candidate asks for nothing

export class Overlay {
  /**
   * @param {import("./store.js").Store} store
   * @param {import("./linked.js").Linked} linked
   * @param {() => State | null} state
   * @param {(reason: unknown) => void} failed
   */
  constructor(store, linked, state, failed) {
    this.store = store;
    this.linked = linked;
    this.state = state;
    this.failed = failed;
    this.looking = new AbortController();
    /** @type {string | null} */
    this.looked = null;
  }

  /**
   * Show what something would explain: an effect or a law, by what it is called and how it is asked for.
   * @param {string | null} what
   * @param {string} [verb]
   * @param {Record<string, string>} [asked]
   */
  async look(what, verb = "", asked = {}) {
    if (what === this.looked) return;
    this.looked = what;
    this.looking.abort();
    this.looking = new AbortController();
    const { signal } = this.looking;
    byId("looked").textContent = what ? `what ${titleOf(what)} would explain` : "";
    byId("looked").toggleAttribute("hidden", what === null);
    const state = this.state();
    const node = state?.node;
    if (!what || !state || !node) return timed("look away", () => this.linked.overlay(null));
    const start = performance.now();
    await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
    if (signal.aborted || this.state()?.node !== node) return;
    try {
      const column = await this.store.explained(node, state.active, what, { verb, asked }, signal);
      if (!signal.aborted) timed("look", () => this.linked.overlay(column), start);
    } catch (reason) {
      if (!signal.aborted) this.failed(reason);
    }
  }

  /**
   * Fit a formula that is still typed, and show what it would explain.
   * @param {object} formula
   * @param {(tried: import("./types.js").Law) => void} told
   * @returns {Promise<string>} what is wrong with it; empty for nothing
   */
  async attempt(formula, told) {
    try {
      // Two requests may arrive the other way round: the older one would give up the newer.
      const { tried, unfinished } = await post("typed", { ...formula, typed_ms: Date.now() });
      if (unfinished !== undefined) this.look(null);
      if (!tried) return unfinished ?? "";
      told(tried);
    } catch (reason) {
      this.look(null);
      return wordsOf(reason);
    }
    this.looked = null; // the one before was another
    this.store.forget(TYPED);
    await this.look(TYPED, "law", { number: "typed" });
    return "";
  }
}
