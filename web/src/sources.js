/** The dialog for a capture without a file: a simulated knob, an emulated rig, a rig on a port. */

import { Refusal, ask, post, wordsOf } from "./api.js";
import { byId, make } from "./dom.js";

/** @typedef {import("./types.js").Sources} Sources */

const LEVELS = new Set(["easy", "middling", "hard"]); // of a knob that is simulated
const NUMBERS = new Set(["duration_s", "speed", "seed", "baud"]);

/**
 * @param {{made: () => void, recording: () => void, say: (words: string) => void, open: () => number}} heard
 * `made`: a capture was taken in; `recording`: one began; `open`: how many captures there are
 */
export function sources(heard) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("new-dialog"));
  const form = /** @type {HTMLFormElement} */ (byId("new-form"));
  const go = /** @type {HTMLButtonElement} */ (byId("new-go"));
  const told = byId("new-said");
  /** @type {Sources | null} */
  let known = null;
  let busy = false;

  const shown = () => {
    const source = valueOf(form, "source");
    for (const part of form.querySelectorAll("[data-for]")) {
      part.toggleAttribute("hidden", !part.getAttribute("data-for")?.split(" ").includes(source));
    }
    byId("new-together").hidden = heard.open() === 0;
    byId("new-effects").hidden = valueOf(form, "hides") !== "chosen";
    go.textContent = source === "simulated" ? "Simulate" : "Record";
    if (!known) return;
    fill(form, "motion", Object.entries(known.motions[source]).map(([name, words]) => [name, `${name}: ${words}`]));
    byId("new-warning").hidden ||= valueOf(form, "motion") === "hand" && !valueOf(form, "model").trim();
    const level = levelOf(form);
    for (const name of ["knob", "motion", "duration_s", "seed"]) field(form, name).disabled = level !== ""; // chosen by the level
    const hideable = known.knobs.find(({ name }) => name === valueOf(form, "knob"))?.hideable ?? [];
    for (const box of byId("new-effects").querySelectorAll("input")) box.disabled = !hideable.includes(box.value);
  };
  const opened = async () => {
    shown();
    dialog.showModal();
    told.textContent = "";
    byId("new-fault").hidden = true;
    if (!known) byId("new-doing").textContent = "looking for knobs and rigs …"; // its lists are empty for a second
    try {
      known = /** @type {Sources} */ (await ask("sources"));
    } catch (reason) {
      told.textContent = wordsOf(reason);
      return;
    } finally {
      byId("new-doing").textContent = "";
    }
    fill(form, "knob", known.knobs.map(({ name, words }) => [name, words]), "knob3");
    const { hideable } = known.knobs[0];
    const every = [...new Set([...hideable, ...known.knobs.flatMap((knob) => knob.hideable)])];
    if (!byId("new-effects").querySelector("input")) byId("new-effects").append(...every.map(effectBox(known)));
    byId("new-ports").replaceChildren(...known.ports.map(({ port, words }) => make("option", { value: port, text: words })));
    byId("new-found").textContent = found(known.ports);
    const port = field(form, "port");
    const typing = document.activeElement === port;
    if (!port.value && !typing && known.ports.length === 1) port.value = known.ports[0].port;
    if (!field(form, "folder").value) field(form, "folder").value = known.folder;
    const emulated = /** @type {HTMLInputElement} */ (form.querySelector("[value=emulated]"));
    emulated.disabled = known.no_emulated_rig !== null;
    byId("new-absent").textContent = known.no_emulated_rig && `No emulated rig here: ${known.no_emulated_rig}.`;
    byId("new-absent").hidden = known.no_emulated_rig === null;
    shown();
  };
  const wait = (/** @type {boolean} */ waiting) => {
    busy = waiting;
    go.disabled = waiting;
    byId("new-doing").textContent = "";
  };

  byId("new").addEventListener("click", opened);
  byId("new-first").addEventListener("click", opened);
  form.addEventListener("change", shown);
  byId("new-close").addEventListener("click", () => dialog.close());
  dialog.addEventListener("close", () => {
    // Whoever closes it while the rig is looked for does not want the recording.
    if (busy) post("stop", { keep: false }).catch(() => {});
  });
  /** @type {number | null} the fault that the rig has told */
  let fault = null;
  byId("new-clear").addEventListener("click", () => begin({ ...wanted(form), clear_fault: fault }));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    return begin(wanted(form));
  });
  const begin = async (/** @type {Record<string, any>} */ asked) => {
    told.textContent = "";
    byId("new-fault").hidden = true;
    wait(true);
    try {
      if (asked.source === "simulated") {
        await post("simulate", asked);
        heard.say("made a capture");
      } else {
        await post("record", asked);
      }
      wait(false);
      dialog.close();
      (asked.source === "simulated" ? heard.made : heard.recording)();
    } catch (reason) {
      wait(false);
      fault = reason instanceof Refusal && reason.fault ? reason.fault.code : null;
      told.textContent = reason instanceof Refusal && reason.fault ? reason.fault.told : asCalled(form, wordsOf(reason));
      byId("new-fault").hidden = fault === null;
    }
  };
}

/** Say in the dialog what goes on before the first sample. @param {string} what */
export function preparing(what) {
  const { open } = /** @type {HTMLDialogElement} */ (byId("new-dialog"));
  byId("new-doing").textContent = open ? `${what} …` : "";
}

/**
 * A refusal of what stands in a field, which has its name, with what the field is called here.
 * @param {HTMLFormElement} form
 * @param {string} words
 */
function asCalled(form, words) {
  const [, name = "", value, rest] = /^(\w+)=(.*?): (.*)$/s.exec(words) ?? [];
  const label = form.querySelector(`[name="${name}"]`)?.closest("label")?.querySelector("span")?.textContent;
  return label ? `${label}${value === "''" ? "" : ` = ${value}`}: ${rest}` : words;
}

/**
 * What the form asks for, as a body.
 * @param {HTMLFormElement} form
 * @returns {Record<string, any>}
 */
function wanted(form) {
  /** @type {Record<string, any>} */
  const body = {};
  for (const [name, value] of new FormData(form)) {
    if (typeof value === "string" && name !== "effects") body[name] = NUMBERS.has(name) ? numeric(value) : value;
  }
  const chosen = [...form.querySelectorAll("#new-effects input:checked:not(:disabled)")];
  body.level = levelOf(form);
  body.surprise = body.hides === "surprise";
  body.effects = body.hides === "chosen" ? chosen.map((box) => /** @type {HTMLInputElement} */ (box).value) : [];
  body.together = "together" in body;
  return body;
}

/** Of which level a challenge is asked for; empty for none. @param {HTMLFormElement} form */
function levelOf(form) {
  const hides = valueOf(form, "hides");
  return valueOf(form, "source") === "simulated" && LEVELS.has(hides) ? hides : "";
}

/** A number as it was typed; what is none goes on as it is, and the server says so. @param {string} value */
function numeric(value) {
  const number = Number(value);
  return value.trim() && Number.isFinite(number) ? number : value;
}

/** @param {Sources} known where each effect shows, and what it is called */
function effectBox({ effects: shows, titles }) {
  return (/** @type {string} */ name) =>
    make(
      "label",
      { title: `${name}: ${shows[name] ?? ""}` },
      make("input", { type: "checkbox", name: "effects", value: name }),
      ` ${titles[name] ?? name}`,
    );
}

/** @param {Sources["ports"]} ports */
function found(ports) {
  if (ports.length === 0) return "This computer has no serial port now; a path can be typed all the same.";
  return ports.map(({ port, words }) => (words && words !== "n/a" ? `${port} (${words})` : port)).join(", ");
}

/**
 * Fill a list of choices, and keep the choice if it is still there.
 * @param {HTMLFormElement} form
 * @param {string} name
 * @param {string[][]} choices value and words
 * @param {string} [first] chosen at first
 */
function fill(form, name, choices, first) {
  const list = /** @type {HTMLSelectElement} */ (form.elements.namedItem(name));
  const before = list.value || first;
  list.replaceChildren(...choices.map(([value, text]) => make("option", { value, text })));
  if (choices.some(([value]) => value === before)) list.value = before ?? "";
}

/** @param {HTMLFormElement} form @param {string} name */
function field(form, name) {
  return /** @type {HTMLInputElement} */ (form.elements.namedItem(name));
}

/** @param {HTMLFormElement} form @param {string} name */
function valueOf(form, name) {
  return String(new FormData(form).get(name) ?? "");
}
