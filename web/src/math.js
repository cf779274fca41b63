/** Laws as they are printed: the LaTeX of the catalogue as MathML, which browsers draw by themselves. */

import { make } from "./dom.js";
import { latexOf } from "./formula.js";

/** Letters and signs by their names. @type {Record<string, string>} */
const SIGNS = {
  ...{ alpha: "α", delta: "δ", theta: "θ", mu: "μ", sigma: "σ", tau: "τ", varphi: "φ", psi: "ψ", omega: "ω", pi: "π" },
  ...{ Delta: "Δ", infty: "∞" },
};
/** @type {Record<string, string>} */
const OPERATORS = { mp: "∓", pm: "±", le: "≤", ge: "≥", neq: "≠", in: "∈", cdot: "⋅", times: "×", sum: "∑", int: "∫" };
/** Widths in em. @type {Record<string, number>} */
const SPACES = { quad: 1, ",": 0.17, ";": 0.28, " ": 0.25, "!": -0.17 };
const NAMES = ["sin", "cos", "tan", "exp", "log", "max", "min"];
const FENCES = ["left", "right", "bigl", "bigr", "Bigl", "Bigr", "big", "Big"];
const IGNORED = ["textstyle", "displaystyle", "limits"];
const LARGE = ["sum", "int"];

/**
 * A law as an element; null where its LaTeX is not understood, for then its plain text says more.
 * @param {string} latex
 * @returns {Element | null}
 */
function typeset(latex) {
  const tree = latex.trim() === "" ? null : parsed(latex);
  return tree && element(["math", { displaystyle: "true" }, ["mrow", {}, ...tree]]);
}

/**
 * The law of an effect, typeset where its LaTeX is known, or it is one that was typed.
 * @param {{latex: string, law: string}} effect
 */
export function lawOf({ latex, law }) {
  const typed = typeset(latex || (latexOf(law) ?? ""));
  return typed ? make("div", { class: "formula" }, typed) : make("code", { class: "formula", text: law });
}

/** How a parameter is written in laws whose name is none of their letters. @type {Record<string, string>} */
const WRITTEN = {
  ...{ rise: "r", vs: "v_s", dv: "\\Delta v", gap: "g", lag: "T", tau: "T", delay: "t_d", limit: "\\tau_{\\max}", noise: "\\sigma" },
  ...{ lo: "\\theta_{\\text{lo}}", hi: "\\theta_{\\text{hi}}", k_lo: "k_{\\text{lo}}", k_hi: "k_{\\text{hi}}", D_neg: "D_{-}", D_pos: "D_{+}" },
};

/**
 * A parameter as its law has it, in LaTeX: theta0 with its index, phi as a letter; a word where laws have none of it.
 * @param {string} name
 * @param {string} latex of the law; of what slides it has x and F for the angle and the torque
 */
export function letterOf(name, latex) {
  const written = letter(name);
  const [turns] = /^\\(theta|tau)/.exec(written) ?? [];
  return turns && !latex.includes(turns) ? written.replace(turns, turns === "\\tau" ? "F" : "x") : written;
}

/** @param {string} name */
function letter(name) {
  if (name in WRITTEN) return WRITTEN[name];
  const [, base, index] = /^([A-Za-z]|alpha|delta|theta|mu|tau|phi)(?:_?(\d+|theta|alpha))?$/.exec(name) ?? [];
  if (!base) return `\\text{${name}}`;
  const sign = (/** @type {string} */ word) => (word === "phi" ? "\\varphi" : word in SIGNS ? `\\${word}` : word);
  return index ? `${sign(base)}_{${sign(index)}}` : sign(base);
}

/** What else stands in laws, by its LaTeX. @type {[RegExp, string, string][]} */
const OTHERS = [
  [/C_\{\\pm\}/, "C_{\\pm}", "dry friction of each direction"],
  [/\\theta(?!_|\s*_)/, "\\theta", "angle"],
  [/^(?!.*\\theta).*(?<![A-Za-z\\])x(?!_)/, "x", "position"],
  [/\\omega/, "\\omega", "velocity"],
  [/(?<![A-Za-z\\])v(?!_)/, "v", "velocity"],
  [/\\alpha/, "\\alpha", "acceleration"],
  [/\\delta(?!\})/, "\\delta", "twist of the joint"],
];

/**
 * What stands in a law beside its parameters, with what it means: the friction that it changes, what moves.
 * @param {string} latex
 * @param {string[]} own names of its parameters
 */
export function othersIn(latex, own) {
  const letters = new Set(own.map((name) => letterOf(name, latex)));
  return OTHERS.filter(([there, tex]) => there.test(latex) && !letters.has(tex)).map(([, tex, meaning]) => /** @type {const} */ ([tex, meaning]));
}

/** A letter as it is printed. @param {string} tex */
export function printed(tex) {
  return typeset(tex) ?? tex;
}

/**
 * Parameters that mean the same, as they stand in a law: one, or from the first to the last.
 * @param {string[]} names
 * @param {string} latex
 */
export function lettersOf(names, latex) {
  const [first, last] = [names[0], names[names.length - 1]].map((name) => letterOf(name, latex));
  return make("span", {}, typeset(first) ?? names[0], ...(names.length > 1 ? [" … ", typeset(last) ?? last] : []));
}

/** @typedef {[string, Record<string, string>, ...(Node_ | string)[]]} Node_ */

/**
 * What LaTeX stands for, as a tree; null where something of it is unknown.
 * @param {string} latex
 * @returns {Node_[] | null}
 */
export function parsed(latex) {
  const tokens = latex.match(/\\[A-Za-z]+|\\.|[0-9.]+|\s+|[^\s]/g) ?? [];
  try {
    return new Reader(tokens).row(() => false);
  } catch {
    return null;
  }
}

class Reader {
  /** @param {string[]} tokens */
  constructor(tokens) {
    this.tokens = tokens;
    this.at = 0;
  }

  /** The next token that is no space. */
  get next() {
    while (/^\s+$/.test(this.tokens[this.at] ?? "")) this.at++;
    return this.tokens[this.at];
  }

  /** @param {string} [wanted] @returns {string} */
  take(wanted) {
    const token = this.next;
    if (token === undefined || (wanted !== undefined && token !== wanted)) throw new Error(`${wanted} is missing`);
    this.at++;
    return token;
  }

  /** All up to where `ends` holds. @param {(token: string) => boolean} ends */
  row(ends) {
    /** @type {Node_[]} */
    const found = [];
    while (this.next !== undefined && !ends(this.next)) {
      const one = this.scripted();
      if (one) found.push(one);
    }
    return found;
  }

  /** In braces as they are, without their structure. */
  words() {
    this.take("{");
    let text = "";
    while (this.tokens[this.at] !== "}") {
      if (this.at >= this.tokens.length) throw new Error("} is missing");
      text += this.tokens[this.at++];
    }
    this.at++;
    return text;
  }

  /** One thing with what stands above and below it. @returns {Node_ | null} */
  scripted() {
    const large = LARGE.includes(this.next.slice(1));
    const base = this.one();
    /** @type {Record<string, Node_>} */
    const scripts = {};
    while (base && (this.next === "_" || this.next === "^")) scripts[this.take()] = this.argument();
    const { _: low, "^": high } = scripts;
    if (!base || (!low && !high)) return base;
    const kind = large ? ["munderover", "munder", "mover"] : ["msubsup", "msub", "msup"];
    if (low && high) return [kind[0], {}, base, low, high];
    return low ? [kind[1], {}, base, low] : [kind[2], {}, base, high];
  }

  /** What a command or a script takes: one thing, or a row in braces. @returns {Node_} */
  argument() {
    if (this.next === "{") return this.braced();
    const one = this.one();
    if (!one) throw new Error("an argument is missing");
    return one;
  }

  /** @returns {Node_} */
  braced() {
    this.take("{");
    const row = this.row((token) => token === "}");
    this.take("}");
    return ["mrow", {}, ...row];
  }

  /** @returns {Node_ | null} */
  one() {
    const token = this.next;
    if (token === "{") return this.braced();
    this.at++;
    if (!token.startsWith("\\")) return plain(token);
    const name = token.slice(1);
    if (name in SIGNS) return ["mi", {}, SIGNS[name]];
    if (name in OPERATORS) return ["mo", {}, OPERATORS[name]];
    if (name in SPACES) return space(name);
    if (NAMES.includes(name)) return this.named(name);
    if (IGNORED.includes(name)) return null;
    if (FENCES.includes(name)) return fence(this.take());
    if (name === "frac" || name === "tfrac") return ["mfrac", {}, this.argument(), this.argument()];
    if (name === "dot") return ["mover", { accent: "true" }, this.argument(), ["mo", {}, "˙"]];
    if (name === "text") return ["mtext", {}, this.words()];
    if (name === "operatorname") return this.named(this.words());
    if (name === "mathbb") return ["mi", {}, this.words().replace("N", "ℕ")];
    if (name === "begin") return this.cases();
    throw new Error(`${token} is unknown`);
  }

  /** A function by its name, at a distance from what it is of. @param {string} name @returns {Node_} */
  named(name) {
    const of = ["(", "^", "_", "\\!", "\\left"].includes(this.next) ? [] : [space(",")];
    return ["mrow", {}, ["mi", { mathvariant: "normal" }, name], ...of];
  }

  /** @returns {Node_} */
  cases() {
    if (this.words() !== "cases") throw new Error("an environment is unknown");
    /** @type {Node_[]} */
    const rows = [];
    /** @type {Node_[]} */
    let cells = [];
    for (;;) {
      cells.push(["mtd", {}, ...this.row((token) => ["&", "\\\\", "\\end"].includes(token))]);
      const end = this.take();
      if (end === "&") continue;
      rows.push(["mtr", {}, ...cells]);
      cells = [];
      if (end === "\\end") break;
    }
    this.words();
    return ["mrow", {}, ["mo", { stretchy: "true", form: "prefix" }, "{"], ["mtable", {}, ...rows]];
  }
}

const SMALLEST = 0.62; // of the size of a formula: what needs less is no longer read, and scrolls

/** Let every formula in a place be seen whole: one that is wider than its column is written smaller. @param {HTMLElement} place */
export function fitFormulas(place) {
  const every = [...place.querySelectorAll(".formula")].filter((one) => one instanceof HTMLElement);
  for (const one of every) one.style.fontSize = "";
  const shares = every.map((one) => (one.clientWidth > 0 ? one.clientWidth / one.scrollWidth : 1));
  for (const [at, share] of shares.entries()) {
    if (share < 1) every[at].style.fontSize = `${Math.max(SMALLEST, 0.98 * share).toFixed(3)}em`;
  }
}

/** A bracket as high as what it holds. @param {string} token @returns {Node_ | null} */
function fence(token) {
  return token === "." ? null : ["mo", { stretchy: "true" }, token];
}

/** @param {string} name @returns {Node_} */
function space(name) {
  return ["mspace", { width: `${SPACES[name]}em` }];
}

/** @param {string} token @returns {Node_} */
function plain(token) {
  if (/^[0-9.]+$/.test(token)) return ["mn", {}, token];
  if (/^[A-Za-z]$/.test(token)) return ["mi", {}, token];
  if (/^[()[\]|]$/.test(token)) return ["mo", { stretchy: "false" }, token];
  if (/^[-+=<>,/]$/.test(token)) return ["mo", {}, token === "-" ? "−" : token];
  throw new Error(`${token} is unknown`);
}

/** The namespace of MathML, as the browser has it: in a report stands no address at all. */
const namespace = once(() => new DOMParser().parseFromString("<math>", "text/html").querySelector("math")?.namespaceURI ?? null);

/** @template T @param {() => T} make @returns {() => T} */
function once(make) {
  /** @type {{made: T} | null} */
  let known = null;
  return () => (known ??= { made: make() }).made;
}

/** @param {Node_} node */
function element([tag, attributes, ...children]) {
  const made = document.createElementNS(namespace(), tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children.map((child) => (typeof child === "string" ? child : element(child))));
  return made;
}
