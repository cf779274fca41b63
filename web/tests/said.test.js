import assert from "node:assert/strict";
import { test } from "node:test";

import { changeOf, known } from "../src/names.js";
import { aboutOf, adviceOf, sentence } from "../src/said.js";

globalThis.location = /** @type {any} */ ({ search: "" });
const KNOB = /** @type {const} */ ({ unit: "N m", peak: 0.02, coordinate: "rotary" });
const SLIDE = /** @type {const} */ ({ unit: "N", peak: 40, coordinate: "linear" });

test("a number of a sentence is in the unit of the plots, and has a true minus", () => {
  const error = { value: 0.001621, unit: "N m", text: "0.001621" };
  assert.equal(sentence(["RMS error ", error], KNOB), "RMS error 1.62\u00a0mNm");
  assert.equal(sentence([error], { ...KNOB, peak: 5 }), "0.001621\u00a0N\u00a0m");
  assert.equal(sentence([{ value: -3, unit: "rad/s^2", text: "-3" }], KNOB), "−3\u00a0rad/s²");
  assert.equal(sentence([{ value: 59, unit: "%", text: "59.0" }], KNOB), "59.0\u00a0%");
});

test("a stretch of an axis is in words, along the load in the unit of the torques", () => {
  const place = /** @type {any} */ ({ axis: "position", low: -0.9667, high: -0.9, ends: [-0.9667, -0.9], unit: "rad", direction: 1, words: "" });
  assert.equal(sentence(["worst at ", place, "."], KNOB), "worst at −0.9667 to −0.9\u00a0rad forward.");
  assert.equal(sentence([{ ...place, axis: "load", unit: "N m", ends: [0.001, 0.002], direction: 0 }], KNOB), "1 to 2\u00a0mNm");
  assert.equal(sentence([{ along: "history" }], KNOB), "distance since reversal");
  const drag = /** @type {const} */ ({ value: 0.00123, unit: "N m s/rad", text: "0.00123" });
  assert.equal(sentence([drag], KNOB), "1.23\u00a0mNm\u00a0s/rad");
  assert.equal(sentence([{ ...drag, unit: "N m s^2/rad" }], KNOB), "0.00123\u00a0kg\u00a0m²");
});

test("a stretch is written by the ends that the server gives it", () => {
  const place = /** @type {any} */ ({ axis: "position", low: -5.049e-8, high: 0.4, ends: [0, 0.4], unit: "rad", direction: 1, words: "" });
  assert.equal(sentence([place], KNOB), "0 to 0.4\u00a0rad forward");
});

test("a stretch that has words of its own is told by them", () => {
  const line = /** @type {any} */ ({ axis: "frequency", low: 10.7, high: 20.5, ends: [10.7, 20.5], unit: "Hz", direction: 0, words: "a line at 15.6 Hz" });
  assert.equal(sentence(["along time (", line, ")"], KNOB), "along time (a line at 15.6 Hz)");
});

test("what is said is of the captures that are shown, whatever else is open", () => {
  const captures = /** @type {any[]} */ ([{ id: "c1", coordinate: "rotary" }, { id: "c2", coordinate: "linear" }]);
  const state = { unit: "N", peak: 40, captures };
  assert.deepEqual(aboutOf({ ...state, active: ["c2"] }), SLIDE);
  assert.equal(aboutOf({ ...state, active: ["c1"] }).coordinate, "rotary");
});

test("columns are called by what they are of a knob, of a slide and of a motor", () => {
  const late = [{ column: "theta" }, ": late against ", { column: "tau" }];
  assert.equal(sentence(late, KNOB), "angle: late against torque");
  assert.equal(sentence(late, SLIDE), "position: late against force");
  assert.equal(sentence(late, { ...KNOB, unit: "A" }), "angle: late against current");
});

test("effects and parameters are called by their titles, and one that has none by its id", () => {
  known({ titles: { torque_lag: "torque lag", detent: "detent" }, params: /** @type {any[]} */ ([{ name: "detent.S", meaning: "phase" }]) });
  assert.equal(sentence([{ effect: "torque_lag" }, " or ", { effect: "hum" }], KNOB), "torque lag or hum");
  assert.equal(sentence([{ param: "detent.S" }, " and ", { param: "hum.a" }], KNOB), "phase (detent) and a (hum)");
});

test("advice has no words of the command line where the page has a way of its own", () => {
  assert.equal(adviceOf({ advice: "log faster", way: "" }), "log faster");
  assert.equal(adviceOf({ advice: "torque_edge_hz= sets another", way: "command" }), "");
  assert.match(adviceOf({ advice: "map tau=... [mNm]", way: "unit" }), /open the file once more/);
});

test("what came in by itself stands beside what it came in with", () => {
  known({ titles: { torque_drift: "torque drift", detent: "detent", offset: "torque offset" } });
  assert.equal(changeOf({ added: "torque_drift", along: ["detent"], dropped: ["offset"] }), "+ torque drift with detent − torque offset");
  assert.equal(changeOf({ added: null, along: [], dropped: ["offset"] }), "− torque offset");
});
