/** A motion recorded from a rig on a port, which is asked for. */

import { Refusal, ask, wordsOf } from "./api.js";
import { byId, make } from "./dom.js";

export class Port {
  /**
   * @param {(how: Record<string, unknown>) => Promise<unknown>} attempt to record the motion from there
   * @param {() => void} begun where a hand is to be led meanwhile
   */
  constructor(attempt, begun) {
    this.attempt = attempt;
    this.begun = begun;
    /** @type {number | null} the fault that a rig has told */
    this.fault = null;
    this.by_hand = false;
    byId("rig-close").addEventListener("click", () => dialog().close());
    byId("rig-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.record({});
    });
    byId("rig-clear").addEventListener("click", () => this.record({ clear_fault: this.fault }));
  }

  /** Ask for the port of a rig. @param {boolean} by_hand */
  async ask(by_hand) {
    this.by_hand = by_hand;
    byId("rig-said").textContent = "";
    byId("rig-fault").hidden = true;
    byId("rig-warning").hidden = by_hand;
    try {
      // Known before the dialog is there: what is suggested must not come into what is typed meanwhile.
      /** @type {import("./types.js").Sources} */
      const known = await ask("sources");
      byId("rig-ports").replaceChildren(...known.ports.map(({ port, words }) => make("option", { value: port, text: words })));
      const [port, folder] = ["port", "folder"].map(field);
      if (!port.value && known.ports.length === 1) port.value = known.ports[0].port;
      if (!folder.value) folder.value = known.folder;
    } catch (reason) {
      byId("rig-said").textContent = wordsOf(reason);
    }
    dialog().showModal();
  }

  /** @param {Record<string, unknown>} more */
  async record(more) {
    const [port, folder] = ["port", "folder"].map((name) => field(name).value);
    byId("rig-said").textContent = "";
    byId("rig-fault").hidden = true;
    try {
      await this.attempt({ port: port || " ", folder, by_hand: this.by_hand, ...more });
      dialog().close();
      if (this.by_hand) this.begun();
    } catch (reason) {
      const fault = reason instanceof Refusal ? reason.fault : null;
      this.fault = fault?.code ?? null;
      byId("rig-said").textContent = fault?.told ?? wordsOf(reason);
      byId("rig-fault").hidden = fault === null;
    }
  }
}

function dialog() {
  return /** @type {HTMLDialogElement} */ (byId("rig-dialog"));
}

/** @param {string} name */
function field(name) {
  const { elements } = /** @type {HTMLFormElement} */ (byId("rig-form"));
  return /** @type {HTMLInputElement} */ (elements.namedItem(name));
}
