import assert from "node:assert/strict";
import { test } from "node:test";

import { Pick } from "../src/pick.js";
import { cloudOf, drawCloud, drawPoints, pixelColour, place } from "../src/raster.js";

/** Numbers from 0 to 1 that look random and are the same every time. */
function* numbers(seed) {
  for (let state = seed; ; ) {
    state = (state * 1664525 + 1013904223) >>> 0;
    yield state / 2 ** 32;
  }
}

function cloud(count, seed) {
  const next = numbers(seed);
  return Float32Array.from({ length: count }, () => next.next().value);
}

const frame = { width: 203, height: 117, x: [0, 1], y: [0, 1], dot: 2 };

test("a rectangle picks the same points as looking at each of them", () => {
  const pixels = place(cloud(5000, 1), cloud(5000, 2), frame);
  const pick = new Pick(pixels, frame.width, frame.height);
  const next = numbers(3);
  for (let round = 0; round < 60; round++) {
    const [a, b, c, d] = Array.from({ length: 4 }, () => next.next().value);
    const [left, right] = [a, b].sort().map((share) => Math.floor(share * (frame.width - 1)));
    const [top, bottom] = [c, d].sort().map((share) => Math.floor(share * (frame.height - 1)));
    const expected = [];
    pixels.forEach((pixel, i) => {
      const [x, y] = [pixel % frame.width, Math.floor(pixel / frame.width)];
      if (x >= left && x <= right && y >= top && y <= bottom) expected.push(i);
    });
    const found = Array.from(pick.inside({ left, right, top, bottom })).sort((one, other) => one - other);
    assert.deepEqual(found, expected);
  }
});

test("the whole plot picks every point that is finite and no other", () => {
  const ys = cloud(100, 4);
  ys[17] = NaN;
  const pixels = place(cloud(100, 5), ys, frame);
  const pick = new Pick(pixels, frame.width, frame.height);
  const all = pick.inside({ left: 0, right: frame.width - 1, top: 0, bottom: frame.height - 1 });
  assert.equal(all.length, 99);
  assert.ok(!all.includes(17));
});

test("points beyond the frame stand on its edge, the corners included", () => {
  const last = (frame.height - frame.dot) * frame.width + frame.width - frame.dot;
  assert.deepEqual(Array.from(place(Float32Array.of(-5, 5, NaN), Float32Array.of(5, -5, 0), frame)), [0, last, -1]);
});

test("where more points meet the colour is fuller, and what is chosen is drawn in its own", () => {
  const small = { width: 8, height: 8, x: [0, 1], y: [0, 1], dot: 1 };
  const [white, blue] = [pixelColour("#ffffff"), pixelColour("#0072b2")];
  const image = new Uint32Array(64).fill(white);
  const across = Float32Array.of(3, 5, 5, 5, NaN).map((column) => column / 7);
  drawCloud(image, cloudOf(across, new Float32Array(5).fill(1), small), blue, 0.4);
  const red = (pixel) => pixel & 0xff;
  assert.ok(red(image[5]) < red(image[3]));
  assert.ok(red(image[3]) < 0xff);
  assert.equal(image[4], white);
  drawPoints(image, Int32Array.of(3, 5, -1), Uint32Array.of(1, 2), small, blue);
  assert.equal(image[5], blue);
  assert.notEqual(image[3], blue);
});

test("a dot has as many counts on each of its pixels as points are there", () => {
  const small = { width: 6, height: 6, x: [0, 1], y: [0, 1], dot: 2 };
  const { counts } = cloudOf(Float32Array.of(0, 0, 1, 0.5), Float32Array.of(1, 1, 0, NaN), small);
  assert.deepEqual([0, 1, 6, 7].map((at) => counts[at]), [2, 2, 2, 2]);
  assert.deepEqual([28, 29, 34, 35].map((at) => counts[at]), [1, 1, 1, 1]);
  assert.equal(counts.reduce((sum, one) => sum + one, 0), 12);
});

test("many points are drawn as each of them alone would be", () => {
  const pixels = place(cloud(20_000, 8), cloud(20_000, 9), frame);
  const odd = Uint32Array.from({ length: 10_000 }, (_, n) => 2 * n + 1);
  for (const chosen of [null, odd]) {
    const [together, alone] = [new Uint32Array(frame.width * frame.height), new Uint32Array(frame.width * frame.height)];
    drawPoints(together, pixels, chosen, frame, 7);
    for (const one of chosen ?? pixels.keys()) drawPoints(alone, pixels, Uint32Array.of(one), frame, 7);
    assert.deepEqual(together, alone);
  }
});

test("of many points every sixth makes the same picture in a fraction of the counts", () => {
  const [xs, ys] = [cloud(60_000, 21), cloud(60_000, 22)];
  const every = 6;
  const some = cloudOf(xs, ys, frame, every);
  const of = (/** @type {Float32Array} */ all) => all.filter((_, i) => i % every === 0);
  assert.deepEqual(some, { ...cloudOf(of(xs), of(ys), frame), every });
});

test("of many points that are chosen those that are nowhere draw nothing, and the first pixel is one like others", () => {
  const many = 4 * frame.width * frame.height;
  const pixels = Int32Array.from({ length: many }, (_, at) => (at % 3 === 0 ? -1 : at % 3 === 1 ? 0 : 500));
  const drawn = (/** @type {Uint32Array | null} */ chosen) => {
    const image = new Uint32Array(frame.width * frame.height);
    drawPoints(image, pixels, chosen, frame, 7);
    return [...image.keys()].filter((at) => image[at] === 7);
  };
  const image = new Uint32Array(frame.width * frame.height);
  drawPoints(image, pixels, null, frame, 7, 3); // of three one, and that is nowhere
  assert.ok(image.every((pixel) => pixel === 0));
  const corners = [0, 1, frame.width, frame.width + 1];
  const nowhere = Uint32Array.from({ length: many / 3 }, (_, at) => 3 * at);
  assert.deepEqual(drawn(nowhere), []);
  assert.deepEqual(drawn(null), [...corners, ...corners.map((at) => 500 + at)].sort((one, other) => one - other));
});
