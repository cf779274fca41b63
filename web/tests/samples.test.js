import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateSync } from "node:zlib";

import { bitsOf, indicesOf } from "../src/bits.js";
import { unpacked } from "../src/packed.js";

test("a column is unpacked from the differences of its steps", async () => {
  const differences = [1, 4, -5, 70_001]; // steps 1, 5, 0, 70001
  const bytes = new Uint8Array(16);
  for (const [i, difference] of differences.entries()) {
    const folded = (difference << 1) ^ (difference >> 31);
    for (let plane = 0; plane < 4; plane++) bytes[4 * plane + i] = (folded >>> (8 * plane)) & 0xff;
  }
  const deflated = deflateSync(bytes).toString("base64");
  assert.deepEqual([...(await unpacked({ low: -2, step: 0.5, deflated }, 4))], [-2, 0, NaN, 34_998]);
});

test("chosen samples go to and fro as bits", () => {
  const bits = bitsOf(Uint32Array.of(9, 1), 11);
  assert.deepEqual([...bits], [0b10, 0b10]);
  assert.deepEqual(indicesOf(bits), Uint32Array.of(1, 9));
  assert.deepEqual(indicesOf(bitsOf(null, 11)), null);
});
