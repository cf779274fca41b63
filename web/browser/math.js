/**
 * Whether laws can be typeset, and whose letters do not stand in them: `node math.js - FILE`, FILE a JSON object of LaTeX
 * and the names of parameters by effects. Prints those that cannot, and the letters.
 */

import { readFileSync } from "node:fs";

import { letterOf, parsed } from "../src/math.js";

const laws = Object.entries(JSON.parse(readFileSync(process.argv[3], "utf8")));
const plain = laws.filter(([, { latex }]) => !parsed(latex)).map(([name]) => name);
/** A letter without its index, which may be any in a sum. @param {string} name @param {string} latex */
const base = (name, latex) => letterOf(name, latex).replace(/_\{?(\d+|\\\w+|\\text\{\w+\})\}?$/, "");
const elsewhere = laws.flatMap(([effect, { latex, names }]) => names.filter((name) => !latex.includes(base(name, latex))).map((name) => `${effect}.${name}`));
console.log(JSON.stringify({ laws: laws.length, plain, elsewhere }));
