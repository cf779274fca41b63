/** Which column of a file is which of a capture, by eye: each is drawn small, with its range. */

import { byId, make } from "./dom.js";
import { number } from "./numbers.js";

/** @typedef {import("./types.js").FileColumn} FileColumn */
/** @typedef {"rotary" | "linear"} Kind of axis */
/** @typedef {{words: string, units: Record<Kind, string[]>, needed: boolean}} Target */

const MOTOR = ["A", "mA", "V", "duty"]; // of what a motor is given, on either axis
const COUNTS = "counts"; // of an encoder: how many a turn (a millimetre) has, no file says
/** What counts are divided into, and how the unit of that is written. @type {Record<Kind, {words: string, unit: string}>} */
const PER = { rotary: { words: "turn", unit: "turn" }, linear: { words: "millimetre", unit: "mm" } };
const ROWS = "rows/s"; // of a log without a clock: what is typed is how many rows a second has
const RATE = 20; // rows a unit of time, from which on the unit is taken for the second

/** What a column can be, in words, and the units that it often has; the first is SI. @type {Record<string, Target>} */
const TARGETS = {
  t: { words: "Time", units: { rotary: ["s", "ms", "us", "min", ROWS], linear: ["s", "ms", "us", "min", ROWS] }, needed: true },
  theta: {
    words: "Angle or position",
    ...{ units: { rotary: ["rad", "deg", "turn", COUNTS], linear: ["m", "mm", "um", COUNTS] }, needed: true },
  },
  tau: {
    words: "Torque or force, or motor current",
    ...{ units: { rotary: ["N m", "mNm", ...MOTOR], linear: ["N", "mN", ...MOTOR] }, needed: true },
  },
  omega: {
    words: "Velocity, if there is one",
    ...{ units: { rotary: ["rad/s", "deg/s", "rpm"], linear: ["m/s", "mm/s"] }, needed: false },
  },
  alpha: {
    words: "Acceleration, if there is one",
    ...{ units: { rotary: ["rad/s^2", "deg/s^2"], linear: ["m/s^2", "mm/s^2"] }, needed: false },
  },
};
const KINDS = /** @type {Kind[]} */ (["rotary", "linear"]);
/** Of a unit of angle, how many degrees it has: for one sees at once whether a range is one of degrees.
 * @type {Record<string, number>} */
const DEGREES = { rad: 180 / Math.PI, turn: 360 };
const TURNS = 3; // from which on nobody counts degrees
/** How loggers write some of them.
 * @type {Record<string, string>} */
const SPELT = { "°": "deg", "°/s": "deg/s", "°/s²": "deg/s^2", "rad/s²": "rad/s^2", Nm: "N m", "1/min": "rpm", "U/min": "rpm",
  "mN m": "mNm", "µs": "us", "µm": "um" };
const SIZE = { width: 110, height: 34 }; // CSS pixels of an outline

export class Mapping {
  /** @param {HTMLElement} place of the fields @param {HTMLElement} found place of the file's columns */
  constructor(place, found) {
    this.found = found;
    /** @type {FileColumn[]} */
    this.columns = [];
    this.counts = make("input", { ...{ name: "counts", type: "number", min: 0, step: "any", inputmode: "decimal" }, list: "counts-usual" });
    this.counts.addEventListener("input", () => this.tell());
    this.perWhat = make("span", {});
    this.per = make("label", { class: "per", hidden: true }, this.perWhat, this.counts);
    this.fields = Object.entries(TARGETS).map(([name, target]) => {
      const text = make("input", { name, type: "text", autocomplete: "off", spellcheck: "false", "aria-label": target.words });
      const unit = make("select", { "aria-label": `unit of ${target.words}`, name: `${name}-unit` });
      const range = make("span", { class: "range soft" });
      const field = { name, target, text, unit, range };
      text.addEventListener("focus", () => (this.at = text));
      text.addEventListener("input", () => this.tell());
      unit.addEventListener("change", () => {
        if (name === "theta") this.follow(unit.value);
        this.chose(unit.value);
      });
      place.append(make("div", {}, make("span", { text: target.words }), text, unit, name === "theta" ? this.per : null, range));
      return field;
    });
    /** @type {HTMLInputElement} where a column goes that is pressed */
    this.at = this.fields[0].text;
    this.kinds = KINDS.map((kind) => /** @type {HTMLInputElement} */ (byId(`open-${kind}`)));
    for (const box of this.kinds) box.addEventListener("change", () => this.tell());
    this.tell();
  }

  /** Rotary or linear; null until it is said. @returns {Kind | null} */
  get kind() {
    return KINDS.find((_, at) => this.kinds[at].checked) ?? null;
  }

  /** What the import is to be told; nothing where nothing is filled in. */
  options() {
    const filled = this.fields.filter(({ text }) => text.value.trim());
    const rate = filled.find(({ unit }) => unit.value === ROWS);
    const map = filled.filter((one) => one !== rate).map(({ name, text, unit }) => {
      const written = text.value.trim();
      if (saysUnit(written) || !unit.value) return `${name}=${written}`;
      if (unit.value !== COUNTS) return `${name}=${written} [${unit.value}]`;
      return `${name}=(${written})/${this.counts.value.trim()} [${PER[this.kind ?? "rotary"].unit}]`;
    });
    /** @type {Record<string, string>} */
    const options = map.length > 0 ? { map: map.join(", ") } : {};
    if (map.length > 0 && this.kind) options.coordinate = this.kind;
    if (rate) options.rate_hz = rate.text.value.trim();
    return options;
  }

  /**
   * What has still to be said; the first field of it has the focus then. Nothing where nothing is filled in.
   * @returns {string}
   */
  lacking() {
    const filled = this.fields.filter(({ text }) => text.value.trim());
    if (filled.length === 0) return "";
    if (!this.kind) {
      this.kinds[0].focus();
      return "Does it turn or slide? Metres must not be taken for radians.";
    }
    const without = filled.find(({ text, unit }) => !unit.value && !saysUnit(text.value.trim()));
    if (without) {
      without.unit.focus();
      return `In which unit is ${without.text.value}? (${without.target.words.toLowerCase()})`;
    }
    const absent = this.fields.find(({ target, text }) => target.needed && !text.value.trim());
    if (absent) {
      absent.text.focus();
      if (absent.name !== "t") return `Which column is it? (${absent.target.words.toLowerCase()})`;
      return `Which column is the time? Where there is none, type how many rows a second has, in ${ROWS}.`;
    }
    if (this.per.hidden || Number(this.counts.value) > 0) return "";
    this.counts.focus();
    return `How many counts has a ${PER[this.kind].words}? The data sheet of the encoder says; often it is four times its lines.`;
  }

  clear() {
    for (const { text } of this.fields) text.value = "";
    for (const box of this.kinds) box.checked = false;
    for (const { unit } of this.fields) unit.value = "";
    this.counts.value = "";
    this.columns = [];
    this.found.replaceChildren();
    this.tell();
  }

  /**
   * Show the columns of a file; what they are taken for is filled in where nothing is yet.
   * @param {FileColumn[]} columns
   * @param {Record<string, import("./types.js").Guess>} guess
   */
  show(columns, guess) {
    this.columns = columns;
    this.found.replaceChildren(...columns.map((column) => this.tile(column)));
    for (const field of this.fields) {
      const known = guess[field.name];
      const same = columns.some(({ name }) => name === field.name) ? field.name : "";
      if (field.text.value) continue;
      field.text.value = known ? plain(known.expression.replace(/^`([^`]*)`$/, "$1")) : same;
      const unit = known?.unit ?? (field.name === "t" && known ? this.seconds(field.text.value) : "");
      if (unit) this.measure(field, unit);
    }
    this.at = this.fields.find(({ text }) => !text.value)?.text ?? this.at;
    this.tell();
  }

  /** The second, where a time without a unit can hardly be in another one. @param {string} written */
  seconds(written) {
    const column = this.columns.find(({ name }) => plain(name) === written);
    return column && rateOf(column) >= RATE ? "s" : "";
  }

  /** @param {FileColumn} column */
  tile({ name, low, high, outline }) {
    const range = `${number(low)} … ${number(high)}`;
    const canvas = make("canvas", { "aria-hidden": "true", ...SIZE });
    draw(canvas, outline);
    return make(
      "button",
      {
        ...{ type: "button", title: "put into the chosen field" },
        on: { click: () => this.put(name) },
      },
      make("strong", { text: name }), " ",
      canvas,
      make("span", { class: "soft", text: range }),
    );
  }

  /** @param {string} column name that goes into the field, of which the next free one is then chosen */
  put(column) {
    // A name that is no plain word has to be quoted, or it would be a sum of others.
    const field = this.fields.find(({ text }) => text === this.at);
    this.at.value = plain(column);
    if (field) this.measure(field, /[[(]([^\])]+)[\])]\s*$/.exec(column)?.[1] ?? "");
    this.at = this.fields.find(({ text }) => !text.value)?.text ?? this.at;
    this.at.focus();
    this.tell();
  }

  /** @param {Mapping["fields"][number]} field @param {string} written a unit, or what is none of the list */
  measure(field, written) {
    const unit = SPELT[written] ?? written;
    const known = KINDS.some((kind) => field.target.units[kind].includes(unit));
    field.unit.value = known ? unit : "";
    this.chose(field.unit.value);
  }

  /** What a position is in is most often what its velocity is in a second: filled in where nothing is yet. @param {string} unit */
  follow(unit) {
    for (const [name, following] of [["omega", `${unit}/s`], ["alpha", `${unit}/s^2`]]) {
      const field = this.fields.find((one) => one.name === name);
      if (field && field.text.value.trim() && !field.unit.value) this.measure(field, following);
    }
  }

  /** A unit was chosen: one of a length says that the axis slides. @param {string} unit */
  chose(unit) {
    for (const [at, kind] of KINDS.entries()) {
      const only = (/** @type {Kind} */ one) => Object.values(TARGETS).some(({ units }) => units[one].includes(unit));
      if (unit && only(kind) && !only(KINDS[1 - at])) this.kinds[at].checked = true;
    }
    this.tell();
  }

  /** Offer the units of the kind of axis, and say what each column would be in them. */
  tell() {
    const kind = this.kind;
    const counted = this.fields.find(({ name }) => name === "theta");
    this.per.hidden = counted?.unit.value !== COUNTS || saysUnit(counted.text.value.trim());
    this.perWhat.textContent = `counts in a ${PER[kind ?? "rotary"].words}${kind ? "" : " (or a millimetre)"}`;
    for (const { target, text, unit, range } of this.fields) {
      const offered = [...new Set(kind ? target.units[kind] : KINDS.flatMap((one) => target.units[one]))];
      const chosen = unit.value;
      const options = [make("option", { value: "", text: "unit?" }), ...offered.map((one) => make("option", { value: one, text: one }))];
      if (unit.options.length !== options.length || unit.options[1].value !== offered[0]) unit.replaceChildren(...options);
      unit.value = offered.includes(chosen) ? chosen : "";
      const column = this.columns.find(({ name }) => plain(name) === text.value.trim());
      range.textContent = column ? spread(column, unit.value, Number(this.counts.value), kind) : "";
    }
  }
}

/**
 * From where to where a column goes, in a unit and in one that is easily felt.
 * @param {FileColumn} column
 * @param {string} unit
 * @param {number} counts in a turn or a millimetre
 * @param {Kind | null} kind of axis
 */
function spread(column, unit, counts, kind) {
  const { low, high } = column;
  if (low === null || high === null) return "no value at all";
  const ends = `${number(low)} … ${number(high)}`;
  if (unit === COUNTS) {
    const way = (high - low) / counts;
    const felt = kind === "linear" ? `${number(way)} mm` : `${number(360 * way)} degrees`;
    return `${ends} counts${counts > 0 ? `, over ${felt}` : ""}`;
  }
  if (unit === "s") return `${ends} s, ${number(rateOf(column))} rows a second`;
  const degrees = (high - low) * DEGREES[unit];
  const felt = degrees > TURNS * 360 ? `${number(degrees / 360)} turns` : `${number(degrees)} degrees`;
  return `${ends} ${unit}${unit in DEGREES ? `, over ${felt}` : ""}`;
}

/** Rows for each unit of a column that is a time. @param {FileColumn} column */
function rateOf({ rows, low, high }) {
  return (rows - 1) / ((high ?? 0) - (low ?? 0));
}

/** A column's name as a map has it. @param {string} column */
function plain(column) {
  return /^[A-Za-z_]\w*$/.test(column) ? column : `\`${column}\``;
}

/** Whether what is written has its unit in brackets. @param {string} written */
function saysUnit(written) {
  return written.endsWith("]");
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
