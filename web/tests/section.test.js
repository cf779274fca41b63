import assert from "node:assert/strict";
import { test } from "node:test";

import { Motion, SEEN, hillsOf, kindOf } from "../src/section.js";

const effect = (/** @type {object} */ more) => /** @type {any} */ ({ place: "load", friction: false, over: "position", ...more });

test("a cross-section is that of where an effect acts and what it follows", () => {
  assert.equal(kindOf(effect({ place: "coupling" })), "joint");
  assert.equal(kindOf(effect({ place: "sensor", over: "time" })), "gauge");
  assert.equal(kindOf(effect({ friction: true, over: "velocity" })), "bristles");
  assert.equal(kindOf(effect({ over: "acceleration" })), "mass");
  assert.equal(kindOf(effect({})), "hills");
  assert.deepEqual(Object.keys(SEEN).sort(), ["bristles", "gauge", "hills", "joint", "mass"]);
});

test("a spring makes a valley whose bottom is where it rests, whichever way it is passed", () => {
  const theta = Float32Array.from({ length: 4000 }, (_, i) => Math.sin(i / 300));
  const found = hillsOf(theta, theta.map((angle) => 3 * (angle - 0.25)), -1, 2);
  const lowest = found.indexOf(Math.min(...found));
  assert.ok(Math.abs(-1 + (2 * lowest) / found.length - 0.25) < 0.05);
  assert.equal(Math.max(...found), 1);
  assert.equal(found.indexOf(1), 0);
});

test("a masked sample moves no cross-section out of its frame", () => {
  const columns = { theta: Float32Array.of(0, 1, 2), omega: Float32Array.of(1, NaN, -2), tau: Float32Array.of(1, NaN, 4) };
  const now = new Motion(columns, Float32Array.of(0.5, NaN, 1)).at(1);
  assert.deepEqual([now.omega, now.torque, now.level, now.bare, now.along], [0, 0, 0, 0, 0.5]);
  assert.equal(new Motion(columns, Float32Array.of(0.5, NaN, 1)).at(2).bare, 0.75);
});
