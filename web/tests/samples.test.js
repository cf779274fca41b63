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

test("what is not fitted is drawn over time alone, in a colour of its own, and sets no axis", async () => {
  const { rowsOf } = await import("../src/contents.js");
  const columns = {
    t: Float32Array.of(0, 1, 2, 3),
    omega: Float32Array.of(5, 6, 0, 7),
    tau: Float32Array.of(1, 2, 3, NaN),
    residual: Float32Array.of(0.1, 0.1, NaN, NaN),
    masked: Float32Array.of(NaN, NaN, NaN, 9),
  };
  const data = /** @type {any} */ ({ columns, unit: "N", peak: 9, coordinate: "linear", noise: null, fitted: true, below_hz: 100 });
  const view = /** @type {any} */ ({ axes: ["velocity", "time"], isolated: false, band: false, held: false });
  const [velocity, time] = rowsOf(data, view, 1).map(({ torque }) => torque);
  assert.ok(velocity && time);
  assert.ok(velocity.xAxis.low > 4 && velocity.xAxis.high < 6.1);
  assert.deepEqual(velocity.series.map(({ colour }) => colour), ["--measured", "--modelled"]);
  assert.deepEqual([...velocity.series[0].y], [1, 2, NaN, NaN]);
  assert.deepEqual([...time.series[0].y], [NaN, NaN, 3, 9]);
  assert.equal(time.series[0].colour, "--masked");
  assert.ok(time.xAxis.high >= 3 && time.yAxis.high < 3);
  assert.equal(velocity.yAxis.label.split(",")[0], "force below 100 Hz");
});

test("a stretch of time is left out whole, samples that are chosen otherwise in runs of each capture", async () => {
  const { runsOf } = await import("../src/leaving.js");
  const state = /** @type {any} */ ({ captures: [{ id: "b", samples: 3 }, { id: "a", samples: 4 }], active: ["a", "b"] });
  const t = Float32Array.of(0, 1, 2, 3, 3, 4, 5);
  assert.deepEqual(runsOf(Uint32Array.of(2), t, [1.5, 4.2], state), { a: [[2, 3]], b: [[0, 1]] });
  assert.deepEqual(runsOf(Uint32Array.of(0, 1, 3, 6), t, null, state), { a: [[0, 1], [3, 3]], b: [[2, 2]] });
});
