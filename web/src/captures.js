/** The captures that are open, and which of them the model is fitted to. */

import { ask } from "./api.js";
import { make } from "./dom.js";
import { named, paramOf } from "./names.js";
import { thousands } from "./numbers.js";
import { aboutOf, adviceOf, nodes, sentence } from "./said.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").CaptureInfo} CaptureInfo */
/** @typedef {import("./types.js").Finding} Finding */
/** @typedef {import("./said.js").About} About */

const FEW = 2; // findings that are seen at once
const SHORT = 5; // letters that are no use to leave out
/** @type {Record<string, string>} */
const PLURAL = { note: "notes", warning: "warnings" };

/**
 * @param {HTMLElement} place
 * @param {State} state
 * @param {{use: (captures: string[]) => void, close: (capture: string) => void}} deeds `use`: these ids to fit to
 */
export function showCaptures(place, state, { use, close }) {
  const { captures, active } = state;
  const about = aboutOf(state);
  const key = JSON.stringify([captures, active, about]);
  if (place.dataset.shown === key) return; // a button that is being pressed stays
  place.dataset.shown = key;
  if (captures.length === 1) {
    const [only] = captures;
    place.replaceChildren(make("span", { class: "capture", title: `${only.name}:${facts(only)}` }, ...words(only, about, only.name), make("span", { class: "facts", text: facts(only) })));
    return;
  }
  const short = shortNames(captures.map(({ name }) => name));
  const toggled = (/** @type {string} */ id) =>
    active.includes(id) ? active.filter((one) => one !== id) : [...active, id];
  const buttons = captures.map((capture, at) => {
    const alone = active.length === 1 && active[0] === capture.id; // without it there would be nothing to fit to
    const chosen = make(
      "button",
      {
        ...{ type: "button", class: "capture", title: `fit to ${capture.name} too, or not:${facts(capture)}` },
        "aria-pressed": String(active.includes(capture.id)),
        disabled: alone,
        on: { click: () => use(toggled(capture.id)) },
      },
      ...words(capture, about, short[at]), // beside others there is no room for more
    );
    const away = make("button", {
      ...{ type: "button", class: "away", text: "×", "aria-label": `close ${capture.name}`, disabled: alone },
      ...{ title: alone ? "the model is fitted to it alone" : `close ${capture.name}`, on: { click: () => close(capture.id) } },
    });
    return make("span", { class: "held-capture" }, chosen, away);
  });
  place.replaceChildren(...buttons);
  // Of more than fit beside one another, what is shown is seen.
  buttons[captures.findIndex(({ id }) => active.includes(id))]?.scrollIntoView({ block: "nearest", inline: "nearest" });
}

/**
 * How many letters names begin alike with, whole words of them: dates, mostly, which would be all that is seen of each.
 * @param {string[]} names
 */
function sharedHead(names) {
  const [first = "", ...others] = names;
  let alike = 0;
  while (alike < first.length && others.every((name) => name[alike] === first[alike])) alike++;
  const word = /^.*[-_ .]/.exec(first.slice(0, alike))?.[0].length ?? 0;
  return alike < first.length && names.every((name) => name.length > word) && word > SHORT ? word : 0;
}

/**
 * Names without what all of them begin with, and then without the kind of file that all of them are.
 * @param {string[]} names
 */
export function shortNames(names) {
  const shared = sharedHead(names);
  if (shared === 0) return names;
  const kind = /\.\w+$/.exec(names[0])?.[0] ?? "";
  const alike = names.every((name) => name.endsWith(kind) && name.length > shared + kind.length);
  return names.map((name) => `…${name.slice(shared, alike ? name.length - kind.length : name.length)}`);
}

/** How long a capture is. @param {CaptureInfo} capture */
function facts({ samples, rate_hz }) {
  return ` ${thousands(samples)} samples, ${Math.round(rate_hz)} Hz`;
}

/** @param {CaptureInfo} capture @param {About} about @param {string} name as it is called beside others */
function words({ findings }, about, name) {
  const doubtful = findings.filter((one) => !isNote(one));
  const doubt = make("span", { class: "doubt", text: "⚠ ", title: doubtful.map((one) => textOf(one, about)).join("\n") });
  return [...(doubtful.length > 0 ? [doubt] : []), make("strong", { text: name })];
}

/** Whether a finding changes nothing, and no person changed that. @param {Finding} finding */
const isNote = ({ severity, overruled }) => severity === "note" && !overruled;

/** A finding as a sentence: how grave it is, what was found, and what can be done about it here. @param {Finding} found @param {About} about */
export function textOf({ severity, said, advice }, about) {
  const way = advice && adviceOf(advice);
  return `${severity}: ${sentence(said, about)}${way ? `; ${way}` : ""}`;
}

/**
 * Say what is doubtful about the captures that are fitted, and what they cannot tell. Each finding is seen at its
 * samples, and has a switch by which a person overrules it.
 * @param {HTMLElement} place
 * @param {State} state
 * @param {About} about
 * @param {{see: (capture: string, finding: string) => void,
 *   overrule: (capture: string, finding: string, on: boolean) => void, sharpen: (param: string) => void}} deeds
 */
export function showFindings(place, { captures, active, limitations, disagreements, notes, job }, about, deeds) {
  const key = JSON.stringify([captures, active, limitations, disagreements, notes, about, job === null]);
  if (place.dataset.shown === key) return; // a switch that has the focus keeps it
  place.dataset.shown = key;
  const focused = document.activeElement?.getAttribute("data-finding");
  const fitted = captures.filter(({ id }) => active.includes(id));
  const every = alikeInAll(fitted);
  const short = new Map(shortNames(fitted.map(({ name }) => name)).map((name, at) => [fitted[at].id, name]));
  const [several, all] = [fitted.length > 1, { id: "", name: "all: ", job }];
  const apart = fitted.map((one) => ({ ...one, findings: one.findings.filter((found) => !isNote(found) || !every.has(keyOf(found))) }));
  const told = [...apart.flatMap(({ findings }) => findings), ...every.values()];
  const found = apart.flatMap(({ id, findings }) => {
    const own = [...findings.filter((one) => !isNote(one)), ...findings.filter(isNote)];
    return own.map((one) => finding(one, { id, name: several ? `${short.get(id)}: ` : "", job }, about, deeds));
  });
  found.push(...[...every.values()].map((one) => finding(one, all, about, deeds)));
  const openOnes = new Set([...place.querySelectorAll("details[data-at][open]")].map((one) => one.getAttribute("data-at")));
  const missing = limitations.map(({ said, sharpen }) => make("li", { class: "soft" }, "Cannot be told: ", ...nodes(said, about), ...sharpening(sharpen, deeds.sharpen)));
  const apartFrom = disagreements.map((one, at) => disagreement(one, about, at, openOnes.has(String(at))));
  const noted = notes.map((text) => make("li", { class: "doubt", text: `⚠ ${text}` }));
  const open = place.querySelector("details:not([data-at])")?.hasAttribute("open") ?? false;
  const own = waits(told) ? [folded(found, told, open)] : found;
  place.replaceChildren(...noted, ...apartFrom, ...missing, ...own); // what to record next is not to be looked for
  const again = focused && place.querySelector(`[data-finding="${CSS.escape(focused)}"]`);
  if (again instanceof HTMLElement) again.focus();
}

/**
 * The button that designs the motion which tells a parameter that is known together with another alone.
 * @param {string | null} param
 * @param {(param: string) => void} sharpen
 */
function sharpening(param, sharpen) {
  if (param === null) return [];
  const title = `the motion that makes it known best: ${paramOf(param)}`;
  return [". ", make("button", { type: "button", text: "Design that motion…", title, on: { click: () => sharpen(param) } })];
}

/**
 * That captures ask for different values of a parameter, and by how much for who asks: it is long, and what could be
 * missing, of which it mostly comes, stands on the screen too.
 * @param {import("./types.js").Disagreement} disagreement
 * @param {About} about
 * @param {number} at
 * @param {boolean} open
 */
function disagreement({ param, said }, about, at, open) {
  const summary = make("summary", { class: "doubt" }, "⚠ The captures disagree: ", named(paramOf(param), param));
  return make("li", {}, make("details", { open, "data-at": String(at) }, summary, make("p", { class: "doubt" }, ...nodes(said, about), ".")));
}

/**
 * Notes that name no samples and are the same of all of several captures, by what they say: they are said once.
 * @param {CaptureInfo[]} fitted
 * @returns {Map<string, Finding>}
 */
export function alikeInAll([first, ...others]) {
  if (!first || others.length === 0) return new Map();
  const alike = first.findings.filter(
    (note) => isNote(note) && !note.seen && others.every(({ findings }) => findings.some((one) => isNote(one) && keyOf(one) === keyOf(note))),
  );
  return new Map(alike.map((one) => [keyOf(one), one]));
}

/** What a finding says. @param {Finding} finding */
const keyOf = ({ said }) => JSON.stringify(said);

/** Whether findings wait for who asks: where there are many, and notes alone, about which nothing is to be done. @param {Finding[]} told */
export function waits(told) {
  return told.length > FEW || (told.length > 0 && told.every(isNote));
}

/** How many findings there are of which kind. @param {Finding[]} told */
export function countedWords(told) {
  const kinds = told.map(({ severity, overruled }) => (overruled ? "overruled" : severity));
  const counted = [...new Set(kinds)].map((kind) => /** @type {const} */ ([kind, kinds.filter((one) => one === kind).length]));
  const words = counted.map(([kind, many]) => `${many} ${many > 1 ? (PLURAL[kind] ?? kind) : kind}`).join(", ");
  return told.every(isNote) ? `${words} on the log` : `${isDoubtful(told) ? "⚠ " : ""}${told.length} findings: ${words}`;
}

/** @param {Finding[]} told */
const isDoubtful = (told) => told.some((one) => !isNote(one) && !one.overruled);

/**
 * Findings behind a line that says how many of which kind there are: what could be missing stands on the screen too.
 * @param {HTMLElement[]} items
 * @param {Finding[]} told
 * @param {boolean} open
 */
function folded(items, told, open) {
  const summary = make("summary", { class: isDoubtful(told) ? "doubt" : "soft", text: countedWords(told) });
  return make("li", {}, make("details", { open }, summary, make("ul", {}, ...items)));
}

/**
 * @param {Finding} found
 * @param {{id: string, name: string, job: import("./types.js").Job | null}} capture
 * @param {About} about
 * @param {Parameters<typeof showFindings>[3]} deeds
 */
function finding(found, { id, name, job }, about, { see, overrule }) {
  const { key, overruled, stands, seen } = found;
  const [text, note] = [textOf(found, about), isNote(found)];
  const said = `${note || overruled ? "" : "⚠ "}${name}${text}`;
  const words = seen
    ? make("button", { type: "button", class: "leads", title: "show its samples", text: said, on: { click: () => see(id, key) } })
    : make("span", { text: said });
  const box = make("input", {
    ...{ type: "checkbox", role: "switch", checked: !overruled, disabled: stands !== "", "data-finding": `${name}${key}` },
    "aria-label": `applied: ${name}${text}`,
    // While something is done it waits, but keeps the focus.
    ...{ "aria-disabled": job !== null ? "true" : null },
    on: { click: (event) => job !== null && event.preventDefault(), change: () => overrule(id, key, !overruled) },
  });
  const why = stands || "off: nothing is done about it, the samples are taken as they were recorded, and the model is fitted anew";
  const own = note ? null : make("label", { title: why }, box, overruled ? "overruled" : "applied");
  return make("li", { class: `finding ${note || overruled ? "soft" : "doubt"}` }, words, own);
}

/**
 * The samples that a finding of a capture names, among those of all that are fitted.
 * @param {string} capture
 * @param {string} finding
 * @param {State} state
 */
export async function samplesOf(capture, finding, { captures, active }) {
  const before = active.slice(0, active.indexOf(capture));
  const start = before.reduce((sum, one) => sum + (captures.find(({ id }) => id === one)?.samples ?? 0), 0);
  /** @type {import("./types.js").Found} */
  const { runs } = await ask("finding", { capture, finding });
  return Uint32Array.from(runs.flatMap(([first, last]) => Array.from({ length: last - first + 1 }, (_, at) => start + first + at)));
}
