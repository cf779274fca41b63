/** Which column of a file is which of a capture, by eye: each is drawn small, with its range. */

import { make } from "./dom.js";
import { number } from "./numbers.js";

/** @typedef {import("./types.js").FileColumn} FileColumn */

/** What a column can be, and the units that it often has; without one the numbers are SI. */
const TARGETS = {
  t: ["s", "ms", "us", "min"],
  theta: ["rad", "deg", "turn", "m", "mm", "um"],
  tau: ["N m", "mNm", "N", "mN", "A", "mA", "V", "duty"],
  omega: ["rad/s", "deg/s", "rpm", "m/s", "mm/s"],
  alpha: ["rad/s^2", "deg/s^2", "m/s^2", "mm/s^2"],
};
/** How loggers write some of them.
 * @type {Record<string, string>} */
const SPELT = { "°": "deg", "°/s": "deg/s", "°/s²": "deg/s^2", "rad/s²": "rad/s^2", Nm: "N m", "1/min": "rpm", "U/min": "rpm",
  "mN m": "mNm", "µs": "us", "µm": "um" };
const SIZE = { width: 110, height: 34 }; // CSS pixels of an outline

export class Mapping {
  /** @param {HTMLElement} place of the fields @param {HTMLElement} found place of the file's columns */
  constructor(place, found) {
    this.found = found;
    this.fields = Object.entries(TARGETS).map(([name, units]) => {
      const text = make("input", { name, type: "text", autocomplete: "off", spellcheck: "false", "aria-label": name });
      const unit = make(
        "select",
        { "aria-label": `unit of ${name}`, name: `${name}-unit` },
        make("option", { value: "", text: "SI" }),
        ...units.map((one) => make("option", { value: one, text: one })),
      );
      text.addEventListener("focus", () => (this.at = text));
      place.append(make("div", {}, make("span", { text: name }), text, unit));
      return { name, text, unit };
    });
    /** @type {HTMLInputElement} where a column goes that is pressed */
    this.at = this.fields[0].text;
  }

  /** What the import is to be told; nothing where nothing is filled in. */
  options() {
    const filled = this.fields.filter(({ text }) => text.value.trim());
    const map = filled.map(({ name, text, unit }) => {
      const written = text.value.trim();
      return `${name}=${written}${unit.value && !written.endsWith("]") ? ` [${unit.value}]` : ""}`;
    });
    /** @type {Record<string, string>} */
    const options = map.length > 0 ? { map: map.join(", ") } : {};
    return options;
  }

  clear() {
    for (const { text, unit } of this.fields) text.value = unit.value = "";
    this.found.replaceChildren();
  }

  /**
   * Show the columns of a file; those that are named as in a capture are filled in.
   * @param {FileColumn[]} columns
   */
  show(columns) {
    this.found.replaceChildren(...columns.map((column) => this.tile(column)));
    for (const { name, text } of this.fields) {
      if (!text.value && columns.some((column) => column.name === name)) text.value = name;
    }
    this.at = this.fields.find(({ text }) => !text.value)?.text ?? this.at;
  }

  /** @param {FileColumn} column */
  tile({ name, rows, low, high, outline }) {
    const range = `${number(low)} … ${number(high)}`;
    const canvas = make("canvas", { "aria-hidden": "true", ...SIZE });
    draw(canvas, outline);
    return make(
      "button",
      {
        ...{ type: "button", "aria-label": `${name}: ${range}, ${rows} rows`, title: "put into the chosen field" },
        on: { click: () => this.put(name) },
      },
      make("strong", { text: name }),
      canvas,
      make("span", { class: "soft", text: range }),
    );
  }

  /** @param {string} column name that goes into the field, of which the next free one is then chosen */
  put(column) {
    // A name that is no plain word has to be quoted, or it would be a sum of others.
    const field = this.fields.find(({ text }) => text === this.at);
    const written = /[[(]([^\])]+)[\])]\s*$/.exec(column)?.[1] ?? "";
    if (field) field.unit.value = SPELT[written] ?? written; // none, where it is no unit of the list
    if (field && !field.unit.value) field.unit.value = "";
    this.at.value = /^[A-Za-z_]\w*$/.test(column) ? column : `\`${column}\``;
    this.at = this.fields.find(({ text }) => !text.value)?.text ?? this.at;
    this.at.focus();
  }
}

/** @param {HTMLCanvasElement} canvas @param {[number, number][]} outline */
function draw(canvas, outline) {
  const brush = canvas.getContext("2d");
  if (!brush) return;
  const step = SIZE.width / Math.max(1, outline.length);
  brush.fillStyle = "#0072b2";
  for (const [at, [low, high]] of outline.entries()) {
    const top = (1 - high) * (SIZE.height - 3);
    brush.fillRect(at * step, top, Math.max(1, step), Math.max(2, (high - low) * (SIZE.height - 3)));
  }
}
