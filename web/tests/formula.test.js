import assert from "node:assert/strict";
import { test } from "node:test";

import { latexOf } from "../src/formula.js";
import { parsed } from "../src/math.js";

test("a law that is typed is typeset: products, fractions, powers and functions", () => {
  /** @type {Record<string, string>} */
  const laws = {
    "a*tanh(v/w)": "a\\,\\operatorname{tanh}{\\left(\\frac{v}{w}\\right)}",
    "2 a (omega/w) / (1 + (omega/w)^2)": "\\frac{2\\,a\\,\\frac{\\omega}{w}}{1 + {\\left(\\frac{\\omega}{w}\\right)}^{2}}",
    "a2*s*sign(v)": "a_{2}\\,s\\,\\operatorname{sgn}{\\left(v\\right)}",
    "a*(theta - c)": "a\\,{\\left(\\theta - c\\right)}",
    "b*exp(-t/T)": "b\\,e^{-\\frac{t}{T}}",
    "-a*v^2": "-a\\,v^{2}",
    "m*dv/dt + k*abs(x)": "m\\,\\dot v + k\\,\\left|x\\right|",
    "a/b*c": "\\frac{a}{b}\\,c",
    "a - (b + c)": "a - {\\left(b + c\\right)}",
    "1e-3*a": "1\\cdot 10^{-3}\\,a",
    "a*max(0, x - c)": "a\\,\\operatorname{max}{\\left(0,\\ x - c\\right)}",
  };
  for (const [law, latex] of Object.entries(laws)) {
    assert.equal(latexOf(law), latex, law);
    assert.ok(parsed(latex), `${latex} is not drawn`);
  }
});

test("what is no law, or a spline, is left as it is typed", () => {
  for (const law of ["", "a * (v", "a*spline(x, 0, 1, 2, 3)", "a +", "a ? b", "|a", "a)"]) assert.equal(latexOf(law), null, law);
});
