import assert from "node:assert/strict";
import { test } from "node:test";

import { place } from "../src/raster.js";
import { panned, zoomed } from "../src/zoom.js";

const whole = [-2, 6];

test("what is under the pointer stays there", () => {
  const [low, high] = zoomed(whole, whole, 0.25, 0.5);
  assert.deepEqual([low, high], [-1, 3]);
  assert.equal(low + 0.25 * (high - low), 0);
});

test("nothing beyond the data is seen, and everything is all that can be", () => {
  assert.equal(zoomed([-2, 2], whole, 1, 2.5), null);
  assert.deepEqual(zoomed([4, 6], whole, 0, 2), [2, 6]);
  assert.deepEqual(panned([-1, 1], whole, -5), [-2, 0]);
  assert.deepEqual(panned([-1, 1], whole, 50), [4, 6]);
  const [low, high] = zoomed([0, 1e-9], whole, 0.5, 0.1);
  assert.ok(high - low >= 7e-4);
});

test("points beyond a frame land on its edge unless only a part is meant to be seen", () => {
  const [xs, ys] = [Float32Array.of(-1, 0.5, 2), Float32Array.of(0.5, 5, 0.5)];
  const frame = { width: 11, height: 11, x: [0, 1], y: [0, 1], dot: 1 };
  assert.deepEqual(Array.from(place(xs, ys, frame)), [5 * 11, 5, 5 * 11 + 10]);
  assert.deepEqual(Array.from(place(xs, ys, { ...frame, part: { x: true, y: false } })), [-1, 5, -1]);
  assert.deepEqual(Array.from(place(xs, ys, { ...frame, part: { x: false, y: true } })), [55, -1, 65]);
});
