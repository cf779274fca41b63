import assert from "node:assert/strict";
import { test } from "node:test";

import { limits } from "../src/axes.js";
import { inWords, limitWords } from "../src/evidence.js";
import { latest } from "../src/latest.js";
import { plusMinus } from "../src/params.js";
import { forTheEye, parted } from "../src/verdict.js";
import { number, percent, ticks, torqueScale, torqueWord } from "../src/numbers.js";

test("numbers have a true minus and as many digits as they need", () => {
  assert.equal(number(-0.00012345), "−1.23e−4");
  assert.equal(number(1234.5678, 6), "1234.57");
  assert.equal(number(NaN), "–");
  assert.equal(number(0), "0");
  assert.equal(percent(0.046), "4.6 %");
  assert.equal(percent(-0.5), "−50 %");
});

test("ticks are round and inside the limits", () => {
  assert.deepEqual(ticks(-1, 1, 4), [-1, -0.5, 0, 0.5, 1]);
  assert.deepEqual(ticks(0, 0, 4), []);
  for (const value of ticks(0.13, 7.7, 6)) assert.ok(value >= 0.13 && value <= 7.7);
});

test("small torques are told in mNm, forces in N", () => {
  assert.deepEqual(torqueScale({ unit: "N m", peak: 0.1 }), { factor: 1000, unit: "mNm" });
  assert.deepEqual(torqueScale({ unit: "N m", peak: 5 }), { factor: 1, unit: "N m" });
  assert.deepEqual(torqueScale({ unit: "N", peak: 0.1 }), { factor: 1, unit: "N" });
});

test("what stands for a torque is called by its unit", () => {
  assert.deepEqual(torqueScale({ unit: "A", peak: 0.1 }), { factor: 1, unit: "A" });
  assert.deepEqual(["N m", "N", "A", "duty"].map(torqueWord), ["torque", "force", "current", "duty cycle"]);
});

test("a next experiment says what a parameter is, and the limits of a slide are in metres", () => {
  const params = /** @type {any[]} */ ([{ name: "detent.S", meaning: "phase" }, { name: "law.a", meaning: "" }]);
  assert.equal(inWords("detent.S would be known twice as well.", params), "detent.S (phase) would be known twice as well.");
  assert.equal(inWords("law.a would be known.", params), "law.a would be known.");
  assert.equal(limitWords(true, "V").torque_Nm, "voltage, V");
  assert.ok(Object.values(limitWords(true, "N")).every((words) => !/rad|angle|torque/.test(words)));
  assert.equal(limitWords(false, "N m").alpha_rad_s2, "acceleration, rad/s²");
});

test("limits leave out what is not finite and are never empty", () => {
  const [low, high] = limits([Float32Array.of(NaN, 1, 3)], { air: 0 });
  assert.deepEqual([low, high], [1, 3]);
  assert.deepEqual(limits([Float32Array.of(NaN)]), [-1, 1]);
  const [below, above] = limits([Float32Array.of(2, 2)]);
  assert.ok(below < 2 && above > 2);
});

test("of requests that pile up only the newest is made", async () => {
  const made = [];
  const ask = latest(async (value) => {
    made.push(value);
    await new Promise((resolve) => setTimeout(resolve, 5));
  });
  for (const value of [1, 2, 3, 4]) ask(value);
  await new Promise((resolve) => setTimeout(resolve, 40));
  assert.deepEqual(made, [1, 4]);
});

test("a verdict is parted into the places that it names and what stands between", () => {
  const place = { words: "1 to 2 rad forward", axis: /** @type {const} */ ("position"), low: 1, high: 2, direction: 1 };
  const gone = { ...place, words: "nowhere in it" };
  assert.deepEqual(parted("worst at 1 to 2 rad forward.", [gone, place]), ["worst at ", place, "."]);
  assert.deepEqual(parted("1 to 2 rad forward", [place]), [place]);
  assert.deepEqual(parted("nothing", []), ["nothing"]);
  assert.deepEqual(parted("", [place]), []);
  const effect = { words: "detent" };
  assert.deepEqual(parted("second_detent, or detent.", [effect]), ["second_detent, or ", effect, "."]);
  assert.deepEqual(parted("second_detent", [effect]), ["second_detent"]);
});

test("a verdict has the unit of the plots, and a true minus", () => {
  const said = "RMS error 0.001621 N m: 2.61 times the noise floor of 6.21e-04 N m, worst at -0.9667 to -0.9 rad, 2 N m s/rad, 3 N m/rad";
  assert.equal(
    forTheEye(said, { unit: "N m", peak: 0.02 }),
    "RMS error 1.62 mNm: 2.61 times the noise floor of 0.621 mNm, worst at −0.9667 to −0.9 rad, 2 N m s/rad, 3 N m/rad",
  );
  assert.equal(forTheEye("59.0 % at 10.35 rad/s^2", { unit: "A", peak: 1 }), "59.0\u00a0% at 10.35 rad/s²");
  assert.equal(forTheEye("0.3564 N m (-1)", { unit: "N m", peak: 2.2 }), "0.3564 N m (−1)");
});

test("a parameter says half its interval, that it is fixed, or that nothing determines it", () => {
  assert.equal(plusMinus({ ci95: [0.9, 1.1], role: "free" }), "± 0.1");
  assert.equal(plusMinus({ ci95: null, role: "fixed" }), "fixed");
  assert.equal(plusMinus({ ci95: null, role: "free" }), "± ?");
  assert.equal(plusMinus({ ci95: [1, 1], role: "free" }), "");
});
