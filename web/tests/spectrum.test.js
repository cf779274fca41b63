import assert from "node:assert/strict";
import { test } from "node:test";

import { samplesIn } from "../src/contents.js";
import { spectrumOf } from "../src/spectrum.js";

const SPLIT = {
  ...{ axis: /** @type {const} */ ("frequency"), direction: [0, 0, 0, 0] },
  ...{ low: [0, 5, 15, 25], high: [0, 15, 25, 35], mean: [9, 0.01, 0.1, 1e-9], band: [0.02, 0.02, 0.02, 1e-9] },
};

test("a spectrum leaves out the constant and what the filter has taken away", () => {
  assert.deepEqual(spectrumOf(SPLIT)?.x, [10, 20].map(Math.log10));
  assert.deepEqual(spectrumOf(SPLIT)?.y, [0.01, 0.1].map(Math.log10));
  assert.equal(spectrumOf(undefined), null);
});

test("along frequency no sample has a place", () => {
  const columns = { t: new Float32Array(2), tau: new Float32Array(2), omega: new Float32Array(2), residual: new Float32Array(2) };
  const data = { columns, unit: "N m", peak: 1, coordinate: /** @type {const} */ ("rotary"), noise: null, fitted: true };
  assert.equal(samplesIn(data, { axis: "frequency", low: 1, high: 2, direction: 0 }), null);
});
