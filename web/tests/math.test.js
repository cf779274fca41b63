import assert from "node:assert/strict";
import { test } from "node:test";

import { letterOf, othersIn, parsed } from "../src/math.js";

/** The text of a law, in the order in which it is read. */
function words(node) {
  const [, , ...children] = node;
  return children.map((child) => (typeof child === "string" ? child : words(child))).join("");
}

test("a law is typeset as it is written", () => {
  const found = parsed("A \\sin\\!\\left(\\frac{\\theta}{P} + S\\right)");
  assert.equal(found?.map(words).join(""), "Asin(θP+S)");
  assert.deepEqual(found?.find(([tag]) => tag === "mfrac"), [
    ...["mfrac", {}, ["mrow", {}, ["mi", {}, "θ"]], ["mrow", {}, ["mi", {}, "P"]]],
  ]);
});

test("what stands above and below a sum or a letter is placed so", () => {
  assert.equal(parsed("\\sum_{n=1}^{4} a_n")?.[0][0], "munderover");
  assert.equal(parsed("a_n")?.[0][0], "msub");
  assert.equal(parsed("C_{\\pm}^2")?.[0][0], "msubsup");
});

test("cases have a row for each", () => {
  const [, , [, , , table]] = parsed("\\tau = \\begin{cases} a & \\omega > 0 \\\\ -b & \\text{else where} \\end{cases}") ?? [];
  assert.equal(table?.[0], "mtable");
  assert.deepEqual(table?.slice(2).map(words), ["aω>0", "−belse where"]);
});

test("what is not understood is left to the plain text", () => {
  for (const latex of ["\\unknown x", "\\frac{a", "a_", "\\begin{matrix} a \\end{matrix}", "a ; b"]) {
    assert.equal(parsed(latex), null, latex);
  }
});

test("what stands in a law beside its parameters is said too, and a parameter of that letter is not taken for it", () => {
  const words = (/** @type {string} */ latex, /** @type {string[]} */ own) => othersIn(latex, own).map(([, meaning]) => meaning);
  const stribeck = String.raw`C_{\pm} \left(1 + r\,e^{-(|\omega|/v_s)^{\delta}}\right) \operatorname{sgn}\omega`;
  assert.deepEqual(words(stribeck, ["rise", "vs", "delta"]), ["dry friction of each direction", "velocity"]);
  assert.deepEqual(words(String.raw`k\,(x - x_0)`, ["k", "theta0"]), ["position"]);
  assert.deepEqual(words(String.raw`\max(0, k\,x),\quad x = \theta - \theta_{\text{hi}}`, ["k"]), ["angle"]);
  assert.equal(letterOf("theta0", String.raw`k\,(x - x_0)`), "x_{0}");
});
