/** Laws as they are typed, as LaTeX: `a*tanh(v/w)`, and what else the program reads as a law. */

/**
 * A part of a law. `sum`: a bracket around it is needed where it is multiplied; `bare`: what stands in such a bracket.
 * @typedef {{tex: string, kind: "atom" | "product" | "sum", bare?: string}} Part
 */

const LETTERS = new Set(["alpha", "delta", "theta", "mu", "sigma", "tau", "psi", "omega", "pi"]);
/** What is written in another way than its name and a bracket. @type {Record<string, (of: string) => string>} */
const WRITTEN = {
  abs: (of) => `\\left|${of}\\right|`,
  exp: (of) => `e^{${of}}`,
  sign: (of) => `\\operatorname{sgn}${bracketed(of)}`,
};
const FUNCTIONS = new Set(["sin", "cos", "tan", "log", "tanh", "min", "max"]);

/**
 * A law as LaTeX; null for what is none, or is better read as it is typed.
 * @param {string} law
 */
export function latexOf(law) {
  const tokens = law.match(/dv\/dt\b|[A-Za-z_]\w*|\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+|\S/g) ?? [];
  try {
    const reader = new Reader(tokens);
    const { tex } = reader.sum();
    return reader.at === tokens.length ? tex : null;
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

  /** Whether a token is next, which is taken then. @param {string} wanted */
  took(wanted) {
    if (this.tokens[this.at] !== wanted) return false;
    this.at++;
    return true;
  }

  /** @param {string} wanted */
  take(wanted) {
    if (!this.took(wanted)) throw new Error(`${wanted} is missing`);
  }

  /** @returns {Part} */
  sum() {
    let found = this.product();
    for (;;) {
      const sign = this.took("+") ? "+" : this.took("-") ? "-" : "";
      if (!sign) return found;
      found = { tex: `${found.tex} ${sign} ${factor(this.product())}`, kind: "sum" };
    }
  }

  /** @returns {Part} */
  product() {
    if (this.took("-")) return { tex: `-${factor(this.product())}`, kind: "sum" };
    let found = this.power();
    for (;;) {
      if (this.took("/")) {
        const below = this.power();
        found = { tex: `\\frac{${found.bare ?? found.tex}}{${below.bare ?? below.tex}}`, kind: "product" };
      } else if (this.took("*") || /^[\w.(]/.test(this.tokens[this.at] ?? "")) {
        const more = this.power();
        const between = /^[\d.]/.test(more.tex) ? "\\cdot " : "\\,";
        found = { tex: `${factor(found)}${between}${factor(more)}`, kind: "product" };
      } else {
        return found;
      }
    }
  }

  /** @returns {Part} */
  power() {
    const base = this.atom();
    if (!this.took("^")) return base;
    const high = this.tokens[this.at] === "-" ? this.product() : this.power();
    return { tex: `${base.kind === "atom" ? base.tex : bracketed(base.bare ?? base.tex)}^{${high.bare ?? high.tex}}`, kind: "product" };
  }

  /** @returns {Part} */
  atom() {
    const token = this.tokens[this.at++] ?? "";
    if (token === "(") {
      const within = this.sum();
      this.take(")");
      return { ...within, bare: within.tex };
    }
    if (token === "|") {
      const within = this.sum();
      this.take("|");
      return { tex: `\\left|${within.tex}\\right|`, kind: "atom" };
    }
    if (/^[\d.]/.test(token)) return number(token);
    if (!/^[A-Za-z_]/.test(token)) throw new Error(`${token} has nothing to stand for`);
    if (this.tokens[this.at] !== "(" || !(token in WRITTEN || FUNCTIONS.has(token))) return name(token);
    const of = this.list();
    const tex = token in WRITTEN ? WRITTEN[token](of) : `\\operatorname{${token}}${bracketed(of)}`;
    return { tex, kind: token === "exp" || FUNCTIONS.has(token) || token === "sign" ? "product" : "atom" };
  }

  /** What stands in the brackets of a function. */
  list() {
    this.take("(");
    const found = [this.sum().tex];
    while (this.took(",")) found.push(this.sum().tex);
    this.take(")");
    return found.join(",\\ ");
  }
}

/** A part where it is multiplied. @param {Part} part */
function factor({ tex, kind, bare }) {
  return kind === "sum" ? bracketed(bare ?? tex) : tex;
}

/** @param {string} tex */
function bracketed(tex) {
  return `{\\left(${tex}\\right)}`; // as high as that, whatever stands beside it
}

/** @param {string} token @returns {Part} */
function number(token) {
  const [digits, power] = token.toLowerCase().split("e");
  return power === undefined ? { tex: digits, kind: "atom" } : { tex: `${digits}\\cdot 10^{${Number(power)}}`, kind: "product" };
}

/** A name, with the number that it ends in below it. @param {string} token @returns {Part} */
function name(token) {
  if (token === "dv/dt") return { tex: "\\dot v", kind: "atom" };
  if (["spline", "sqrt"].includes(token)) throw new Error(`${token} is read as it is typed`);
  const [, letters, digits] = /^([A-Za-z]+)_?(\d*)$/.exec(token) ?? [];
  if (letters === undefined) throw new Error(`${token} is read as it is typed`);
  const tex = LETTERS.has(letters) ? `\\${letters}` : letters.length > 1 ? `\\text{${letters}}` : letters;
  return { tex: digits ? `${tex}_{${digits}}` : tex, kind: "atom" };
}
