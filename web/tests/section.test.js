import assert from "node:assert/strict";
import { test } from "node:test";

import { Motion, SEEN, drawSection, hillsOf, kindOf } from "../src/section.js";

const effect = (/** @type {object} */ more) => /** @type {any} */ ({ place: "load", friction: false, over: "position", ...more });

test("a cross-section is that of where an effect acts and what it follows", () => {
  assert.equal(kindOf(effect({ place: "coupling" })), "joint");
  assert.equal(kindOf(effect({ place: "sensor", over: "time" })), "gauge");
  assert.equal(kindOf(effect({ friction: true, over: "velocity" })), "bristles");
  assert.equal(kindOf(effect({ over: "acceleration" })), "mass");
  assert.equal(kindOf(effect({})), "hills");
  for (const kind of Object.keys(SEEN)) assert.equal(kindOf(effect({ place: "coupling", section: kind })), kind);
  assert.equal(kindOf(effect({ section: "of another version" })), "hills");
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

/** What is drawn of an effect at a sample, as the calls that a canvas gets. */
function drawn(/** @type {string} */ section, /** @type {number} */ at) {
  const calls = /** @type {unknown[]} */ ([]);
  const brush = new Proxy({}, {
    get: (_, name) => (...rest) => calls.push([name, ...rest]),
    set: () => true,
  });
  const theta = Float32Array.from({ length: 100 }, (_, i) => Math.sin(i / 16));
  const columns = { theta, omega: theta.map((_, i) => Math.cos(i / 16)), tau: theta };
  const canvas = /** @type {any} */ ({ getContext: () => brush });
  drawSection(canvas, effect({ section }), new Motion(columns, theta.map((angle) => -angle)), at, { ink: "", soft: "", shade: "", colour: "" });
  return calls;
}

test("every cross-section moves with the capture, and is whole at each of its samples", () => {
  for (const section of Object.keys(SEEN)) {
    assert.notDeepEqual(drawn(section, 10), drawn(section, 70), section);
    assert.deepEqual(drawn(section, 10), drawn(section, 10), section);
    for (let at = 0; at < 100; at++) {
      const numbers = drawn(section, at).flat().filter((one) => typeof one === "number");
      assert.ok(numbers.every(Number.isFinite), `${section} at ${at}`);
    }
  }
});

test("within its play backlash carries nothing, and beyond it the side that pushes touches", () => {
  const theta = Float32Array.of(0, 1, 2);
  const columns = { theta, omega: Float32Array.of(1, 1, -1), tau: theta };
  const filled = (/** @type {number} */ torque) => {
    const sides = /** @type {number[]} */ ([]);
    const brush = new Proxy({}, { get: (_, name) => (...rest) => name === "fillRect" && sides.push(rest[0]), set: () => true });
    const motion = new Motion(columns, Float32Array.of(torque, 1, 1));
    drawSection(/** @type {any} */ ({ getContext: () => brush }), effect({ section: "gap" }), motion, 0, { ink: "", soft: "", shade: "", colour: "" });
    return sides.slice(0, -3); // the last are of the bar beside it
  };
  assert.equal(filled(0).length, 1, "the tongue alone");
  assert.ok(filled(0.5)[1] > filled(0.5)[0], "what touches is ahead of it");
  assert.ok(filled(-0.5)[1] < filled(-0.5)[0]);
});
