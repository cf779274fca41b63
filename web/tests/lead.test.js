/** What leads a hand: turnings are beats, slow passes are counted, words follow the clock. */

import assert from "node:assert/strict";
import { test } from "node:test";

import { angleAt, beats, range, stepAt, turnings } from "../src/lead.js";

/** A motion through points, straight from one to the next. */
function through(points, every = 0.01) {
  const [t, theta] = [[], []];
  for (let n = 1; n < points.length; n++) {
    const [[t0, x0], [t1, x1]] = [points[n - 1], points[n]];
    for (let s = t0; s < t1 - 1e-9; s += every) {
      t.push(s);
      theta.push(x0 + ((x1 - x0) * (s - t0)) / (t1 - t0));
    }
  }
  t.push(points.at(-1)[0]);
  theta.push(points.at(-1)[1]);
  return { t: Float32Array.from(t), theta: Float32Array.from(theta) };
}

const near = (value, wanted, by = 0.02) => assert.ok(Math.abs(value - wanted) < by, `${value} is not ${wanted}`);

test("every turning is marked, and so are the beginning and the end", () => {
  const found = turnings(through([[0, 0], [0.8, 0.05], [1.6, -0.05], [2.4, 0.05]]));
  assert.deepEqual(found.map(({ turn }) => turn), [true, true, true, true]);
  found.forEach(({ at }, n) => near(at, 0.8 * n));
  near(found[1].theta, 0.05, 0.002);
});

test("a rest begins and ends with a mark", () => {
  const found = turnings(through([[0, 0], [1, 1], [1.5, 1], [2.5, 2]]));
  assert.equal(found.length, 4);
  near(found[1].at, 1);
  near(found[2].at, 1.5);
});

test("the beats are those that the words of each step have: a slow pass has several, a quick there and back one", () => {
  const slow = through([[0, 0], [4.2, 1], [8.4, 0]]);
  const found = beats(slow, [{ seconds: 8.4, beats: 60 / 1.05 }]);
  assert.deepEqual(found.map(({ turn }) => turn), [true, false, false, false, true, false, false, false, true]);
  near(found[1].at, 1.05);
  near(found[2].theta, 0.5);
  const quick = through([[0, 0], [0.3, 1], [0.6, 0], [0.9, 1], [1.2, 0], [3.2, 0]]);
  const clicks = beats(quick, [{ seconds: 1.2, beats: 100 }, { seconds: 2, beats: 0 }]);
  [0, 0.6, 1.2, 3.2].forEach((at, n) => near(clicks[n].at, at));
  assert.equal(clicks.length, 4);
});

test("before and after a motion the hand is where that begins and ends", () => {
  const motion = through([[0, 0.3], [1, 0.7]]);
  near(angleAt(motion, -2), 0.3, 1e-6);
  near(angleAt(motion, 0.5), 0.5, 1e-3);
  near(angleAt(motion, 9), 0.7, 1e-6);
  assert.deepEqual(range(Float32Array.from([3, -1, 2])), [-1, 3]);
});

test("words follow the clock", () => {
  const steps = [{ seconds: 1 }, { seconds: 2 }, { seconds: 0.5 }];
  assert.deepEqual([-1, 0.5, 1.5, 3.2, 9].map((at) => stepAt(steps, at)), [0, 0, 1, 2, 2]);
});
