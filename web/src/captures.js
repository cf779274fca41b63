/** The captures that are open, and which of them the model is fitted to. */

import { make } from "./dom.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").CaptureInfo} CaptureInfo */

/**
 * @param {HTMLElement} place
 * @param {State} state
 * @param {{use: (captures: string[]) => void, close: (capture: string) => void}} deeds `use`: these ids to fit to
 */
export function showCaptures(place, { captures, active }, { use, close }) {
  if (captures.length === 1) {
    const [only] = captures;
    place.replaceChildren(make("span", { class: "capture", title: only.name }, ...words(only)));
    return;
  }
  const toggled = (/** @type {string} */ id) =>
    active.includes(id) ? active.filter((one) => one !== id) : [...active, id];
  const buttons = captures.map((capture) => {
    const alone = active.length === 1 && active[0] === capture.id; // without it there would be nothing to fit to
    const chosen = make(
      "button",
      {
        ...{ type: "button", class: "capture", title: `fit to ${capture.name} too, or not` },
        "aria-pressed": String(active.includes(capture.id)),
        disabled: alone,
        on: { click: () => use(toggled(capture.id)) },
      },
      ...words(capture),
    );
    const away = make("button", {
      ...{ type: "button", class: "away", text: "×", "aria-label": `close ${capture.name}`, disabled: alone },
      ...{ title: alone ? "the model is fitted to it alone" : `close ${capture.name}`, on: { click: () => close(capture.id) } },
    });
    return make("span", { class: "held-capture" }, chosen, away);
  });
  place.replaceChildren(...buttons);
}

/** @param {CaptureInfo} capture */
function words({ name, samples, rate_hz, findings }) {
  const facts = ` ${samples.toLocaleString("en")} samples, ${Math.round(rate_hz)} Hz`;
  const doubt = make("span", { class: "doubt", text: "⚠ ", title: findings.join("\n") });
  return [...(findings.length > 0 ? [doubt] : []), make("strong", { text: name }), facts];
}

/**
 * Say what is doubtful about the captures that are fitted, and what they cannot tell.
 * @param {HTMLElement} place
 * @param {State} state
 */
export function showFindings(place, { captures, active, limitations, notes }) {
  const fitted = captures.filter(({ id }) => active.includes(id));
  const found = fitted.flatMap(({ name, findings }) =>
    findings.map((text) => make("li", { class: "doubt", text: `⚠ ${fitted.length > 1 ? `${name}: ` : ""}${text}` })),
  );
  const missing = limitations.map((text) => make("li", { class: "soft", text: `Cannot be told: ${text}` }));
  const noted = notes.map((text) => make("li", { class: "doubt", text: `⚠ ${text}` }));
  place.replaceChildren(...noted, ...found, ...missing);
}
