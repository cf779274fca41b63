import assert from "node:assert/strict";
import { test } from "node:test";

import { between, movesFrom, settle } from "../src/settling.js";

test("residuals begin where they were and end where they are to be", () => {
  const [from, to] = [Float32Array.of(1, NaN, -2), Float32Array.of(0, 3, NaN)];
  const shown = [];
  const waiting = [];
  globalThis.requestAnimationFrame = (frame) => waiting.push(frame);
  settle(from, to, (residual) => shown.push([...residual]) > 0);
  for (let clock = 0; waiting.length > 0; clock += 100) waiting.shift()(clock);
  assert.deepEqual(shown[0].slice(0, 2), [1, 3]);
  assert.deepEqual(shown.at(-1), [...to]);
  assert.ok(shown.length > 5 && shown.every(([one], at) => at === 0 || one <= shown[at - 1][0]));
});

test("what is no longer wanted stops, and nothing moves for who wants that", () => {
  let frames = 0;
  const waiting = [];
  globalThis.requestAnimationFrame = (frame) => waiting.push(frame);
  settle(Float32Array.of(1), Float32Array.of(0), () => ++frames < 2);
  for (let clock = 0; waiting.length > 0; clock += 100) waiting.shift()(clock);
  assert.equal(frames, 2);
  const t = Float32Array.of(0);
  const data = (value) => ({ columns: { t, residual: Float32Array.of(value) }, fitted: true });
  globalThis.matchMedia = (query) => ({ matches: query.includes("reduce") });
  assert.equal(movesFrom(data(1), data(0)), null);
  globalThis.matchMedia = () => ({ matches: false });
  assert.equal(movesFrom(data(1), data(0))[0], 1);
  assert.equal(movesFrom(null, data(0)), null);
  assert.equal(movesFrom({ ...data(1), fitted: false }, data(0)), null);
  assert.equal(between(Float32Array.of(2), Float32Array.of(0), 0.5)[0], 1);
});
