import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

const SERIES = ["measured", "masked", "modelled", "wrong", "chosen", "signature", "beside", "band"];
const LEAST = 15; // of the distance in CIE Lab; about 2 is just seen where two colours touch

/** What eyes see of linear red, green and blue: all of it, and without one kind of cones (Machado et al. 2009, Table 1). */
const EYES = {
  ordinary: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
};
const XYZ = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]];
const WHITE = [0.95047, 1, 1.08883];

const times = (matrix, vector) => matrix.map((row) => row.reduce((sum, one, at) => sum + one * vector[at], 0));

/** @param {string} hex @param {number[][]} eyes */
function lab(hex, eyes) {
  const shown = [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255);
  const linear = shown.map((one) => (one <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4));
  const seen = times(eyes, linear).map((one) => Math.min(1, Math.max(0, one)));
  const [x, y, z] = times(XYZ, seen).map((one, at) => {
    const share = one / WHITE[at];
    return share > 216 / 24389 ? Math.cbrt(share) : (24389 / 27 * share + 16) / 116;
  });
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

const css = readFileSync(new URL("../src/plots.css", import.meta.url), "utf8");
const themes = [...css.matchAll(/color-scheme: (light|dark);([^}]*)\}/g)].map(([, theme, body]) => ({
  theme,
  colours: Object.fromEntries([...body.matchAll(/--(\w+): (#[0-9a-f]{6})/g)].map(([, name, hex]) => [name, hex])),
}));

test("the series are told apart by people of any colour vision, light and dark", () => {
  assert.deepEqual(themes.map(({ theme }) => theme), ["light", "dark", "dark"]);
  const close = [];
  for (const { theme, colours } of themes) {
    for (const [name, eyes] of Object.entries(EYES)) {
      for (const [at, one] of SERIES.entries()) {
        for (const other of SERIES.slice(at + 1)) {
          const [a, b] = [lab(colours[one], eyes), lab(colours[other], eyes)];
          const apart = Math.hypot(...a.map((value, k) => value - b[k]));
          if (!(apart >= LEAST)) close.push(`${theme}, ${name}: ${one} and ${other}, ${apart.toFixed(1)}`);
        }
      }
    }
  }
  assert.deepEqual(close, []);
});
