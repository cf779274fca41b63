import assert from "node:assert/strict";
import { test } from "node:test";

import { limits, tickWords } from "../src/axes.js";
import { factorOf, lettered } from "../src/curve.js";
import { enoughWords, limitWords, ofLimits } from "../src/evidence.js";
import { latest } from "../src/latest.js";
import { firstFitted, momentWords } from "../src/acting.js";
import { restWords } from "../src/candidates.js";
import { apart, plusMinus, withoutName } from "../src/params.js";
import { shownLimit, wider } from "../src/within.js";
import { asKnown, figure, number, percent, thousands, ticks, torqueScale, torqueWord, unitOf } from "../src/numbers.js";

test("a tick has no more digits than it needs, and a curve is over what a person calls a variable", () => {
  assert.deepEqual([5e-5, -1e-4, 1.25e-7, 0, 0.25, 150].map(tickWords), ["5e−5", "−1e−4", "1.25e−7", "0", "0.25", "150"]);
  assert.equal(factorOf("alpha"), "acceleration");
  assert.equal(factorOf("sign(omega)"), "(sign(omega))");
});

test("a value has as many digits as half its interval, which has two", () => {
  const told = [[-0.01956, 0.47], [2.417, 1.4], [0.1189, 0.0623], [12345.6, 230], [5.512e-5, 1.4e-6], [0.4, 230], [2.2e-6, 3e-5], [0.075969, 5.4e-5]];
  assert.deepEqual(told.map(([value, half]) => asKnown(value, half)), ["−0.02", "2.4", "0.119", "12350", "5.51e−5", "0", "2e−6", "0.075969"]);
  assert.deepEqual([asKnown(0.123456, 0), asKnown(0.123456, NaN), asKnown(0.3, 0.3)], ["0.1235", "0.1235", "0.30"]);
});

test("what a law is of has its letter, of what slides another", () => {
  assert.equal(lettered(["omega", "theta"], { coordinate: "rotary" }), "velocity ω, position θ");
  assert.equal(lettered(["omega", "load"], { coordinate: "linear" }), "velocity v, modelled torque");
});

test("numbers have a true minus and as many digits as they need", () => {
  assert.equal(number(-0.00012345), "−1.23e−4");
  assert.equal(number(1234.5678, 6), "1234.57");
  assert.equal(number(NaN), "–");
  assert.equal(number(0), "0");
  assert.equal(percent(0.046), "4.6\u00a0%");
  assert.equal(percent(-0.5), "−50\u00a0%");
  assert.deepEqual([0, 999, 1000, 250_000, 1_234_567].map(thousands), ["0", "999", "1,000", "250,000", "1,234,567"]);
});

test("figures of a column have as many digits as each other", () => {
  assert.deepEqual([0.11, 0.101, -1.2, 9.996, 999.7, 0.0012].map((value) => figure(value)), ["0.110", "0.101", "−1.20", "10.0", "1000", "0.00120"]);
  assert.deepEqual([null, NaN, 0, 1e-5, 4321].map((value) => figure(value)), ["–", "–", "0", "1.00e−5", "4320"]);
});

test("a doubt that is of two parameters names both, one of its own does not repeat its name", () => {
  const own = { param: "viscous.neg" };
  assert.deepEqual(withoutName([own, " is negative"], "viscous.neg"), [" is negative"]);
  for (const beside of [[own, " and ", { param: "viscous.pos" }, " hold it"], [own, ", both"], [{ param: "viscous.pos" }, " is"]]) {
    assert.deepEqual(withoutName(beside, "viscous.neg"), beside);
  }
});

test("at a moment to which nothing is fitted an effect adds nothing that is known", () => {
  const scale = { factor: 1000, unit: "mNm" };
  assert.equal(momentWords(Math.fround(0.0002), 0.0012, scale), "0.0002 s: adds 1.2 mNm");
  assert.equal(momentWords(0, NaN, scale), "0 s: nothing is fitted to this moment");
  assert.equal(momentWords(12.34567, null, scale), "12.35 s: what it adds is not weighed here");
  // So its picture begins where there is something to see.
  assert.deepEqual([[NaN, NaN, 0, 1], [2, NaN], [NaN]].map((one) => firstFitted(Float32Array.from(one))), [2, 0, 0]);
});

test("what comes after nothing is not counted as more", () => {
  assert.deepEqual([restWords(3, 5), restWords(3, 3)], ["3 more", "3 weighed"]);
});

test("a letter of a law has the unit of what was recorded", () => {
  const units = ["N m", "N m s^2/rad", "N m/rad", "rad", "1", "N m s/rad"].map((unit) => unitOf(unit, "V"));
  assert.deepEqual(units, ["V", "V s^2/rad", "V/rad", "rad", "1", "V s/rad"]);
  assert.deepEqual(["N", "N s/m", "m"].map((unit) => unitOf(unit, "A")), ["A", "A s/m", "m"]);
  assert.equal(unitOf("N m/rad", "N m"), "N m/rad");
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

test("what is wrong with a limit is said in the words of its field", () => {
  const about = /** @type {const} */ ({ coordinate: "rotary", unit: "N m", peak: 0.1 });
  assert.equal(ofLimits("limits, torque_Nm: is -0.0012; give a number above 0", about), "limits, “torque, mNm”: is -1.2; give a number above 0");
  assert.equal(ofLimits("limits, torque_Nm: 0.001 is too little; give more", { ...about, unit: "A" }), "limits, “current, A”: 0.001 is too little; give more");
  assert.equal(ofLimits("limits, omega_rad_s: is -1; give a number above 0", about), "limits, “velocity, rad/s”: is -1; give a number above 0");
  assert.equal(ofLimits("no file omega_rad_s", about), "no file omega_rad_s");
});

test("a wider limit is offered in words, a range by both of its ends", () => {
  const about = /** @type {const} */ ({ coordinate: "rotary", unit: "A", peak: 0.1 });
  const within = { theta_min_rad: 1, theta_max_rad: 2 };
  assert.equal(enoughWords(wider({ limit: "torque_Nm", to: 0.35352 }, within), about), "current up to 0.3535 A");
  assert.deepEqual(wider({ limit: "theta_max_rad", to: 2.5 }, within), { theta_min_rad: 0.5, theta_max_rad: 2.5 });
  assert.equal(enoughWords(wider({ limit: "theta_max_rad", to: 2.5 }, within), about), "angle from 0.5 to 2.5 rad");
  assert.equal(enoughWords({ duration_s: 20 }, about), "at most 20 s");
  assert.equal(enoughWords({ torque_Nm: 0.0353 }, { coordinate: "rotary", unit: "N m", peak: 0.1 }), "torque up to 35.3 mNm", "as in the plots");
});

test("an end of a range has no more decimals than the range", () => {
  const slide = { theta_min_rad: -2.1971e-5, theta_max_rad: 0.24638 };
  const shown = Object.entries(slide).map(([name, value]) => shownLimit(name, value, slide));
  assert.deepEqual(shown, [0, 0.2464]);
  assert.ok(Object.is(shown[0], 0), "and no minus before nothing");
  assert.equal(shownLimit("omega_rad_s", 0.0123456, slide), 0.01235);
  assert.equal(shownLimit("theta_max_rad", 1234.56, { theta_min_rad: 0, theta_max_rad: 1234.56 }), 1235);
  assert.equal(shownLimit("theta_min_rad", 0.012345, { theta_min_rad: NaN, theta_max_rad: NaN }), 0.01235);
});

test("a period says how often it returns", () => {
  assert.equal(apart({ name: "detent.P", unit: "rad", value: 0.05 }), ": 20 a turn, 18° apart");
  assert.equal(apart({ name: "position_friction.P", unit: "m", value: 0.002 / (2 * Math.PI) }), ": every 2 mm");
  assert.equal(apart({ name: "detent.A", unit: "rad", value: 0.05 }), "");
  assert.equal(apart({ name: "detent.P", unit: "rad", value: NaN }), "");
});

test("the limits of a slide's motion are in metres", () => {
  assert.equal(limitWords({ coordinate: "linear", unit: "V", peak: 5 }).torque_Nm, "voltage, V");
  assert.ok(Object.values(limitWords({ coordinate: "linear", unit: "N", peak: 5 })).every((words) => !/rad|angle|torque/.test(words)));
  assert.equal(limitWords({ coordinate: "rotary", unit: "N m", peak: 5 }).alpha_rad_s2, "acceleration, rad/s²");
  assert.deepEqual([0.1, 5].map((peak) => limitWords({ coordinate: "rotary", unit: "N m", peak }).torque_Nm), ["torque, mNm", "torque, N m"]);
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

test("a parameter says half its interval, that it is fixed, or that nothing determines it", () => {
  assert.equal(plusMinus({ ci95: [0.9, 1.1], role: "free" }), "± 0.10");
  assert.equal(plusMinus({ ci95: [0.9, 1.1], role: "free" }, 1000), "± 100");
  for (const ci95 of /** @type {const} */ ([null, [0, 0]])) assert.equal(plusMinus({ ci95: /** @type {any} */ (ci95), role: "fixed" }), "fixed");
  assert.equal(plusMinus({ ci95: null, role: "free" }), "± ?");
  assert.equal(plusMinus({ ci95: [1, 1], role: "free" }), "");
});

test("what is doubted alike of several values of an effect is said once", async () => {
  const { sharedDoubts } = await import("../src/params.js");
  const own = ["presliding.s", "presliding.w1", "presliding.w2"].map((name) => ({ name }));
  assert.deepEqual([...sharedDoubts(own, ["may be nothing", "", "may be nothing"])], [["may be nothing", ["s", "w2"]]]);
  assert.deepEqual([...sharedDoubts(own, ["at its bound", "", "may be nothing"])], []);
});

test("the variables of a law are words", async () => {
  const { variableOf } = await import("../src/curve.js");
  assert.deepEqual(["theta", "omega", "s", "load"].map(variableOf), ["position", "velocity", "distance since reversal", "modelled torque"]);
});

test("a floor that falls with what the model explains says what it was thought to be", async () => {
  const { floorWords } = await import("../src/ladder.js");
  const steps = [{ noise_floor: 0.202 }, { noise_floor: 0.2 }, { noise_floor: 0.08 }];
  assert.equal(floorWords(steps, 2, String), "0.08 (0.202 seen by the first model)");
  assert.deepEqual([0, 1].map((at) => floorWords(steps, at, String)), ["0.202", "0.2"]);
  assert.equal(floorWords([{ noise_floor: null }, { noise_floor: 1 }], 1, String), "1");
});

test("after a search the ladder has its steps alone, from the first model on", async () => {
  const { sameCaptures } = await import("../src/ladder.js");
  const [one, other] = [["c1"], ["c2"]];
  const step = (/** @type {string[]} */ captures, anew = false) => /** @type {any} */ ({ captures, anew });
  const steps = [step(one, true), step(one), step(one, true), step(one), step(one)];
  assert.deepEqual(sameCaptures(steps, 4), { steps: steps.slice(2), at: 2 });
  assert.deepEqual(sameCaptures(steps, 1), { steps: steps.slice(0, 2), at: 1 }, "and before it those that came in by hand");
  assert.deepEqual(sameCaptures([step(other, true), step(one), step(one)], 2).steps.length, 2, "errors of other captures are no steps");
});

test("of what is ruled out that is named which would take something off", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { outWords } = await import("../src/candidates.js");
  const rows = (/** @type {number[]} */ ...falls) => /** @type {any[]} */ (falls.map((error_fall, at) => ({ effect: `e${at}`, error_fall })));
  assert.equal(outWords(rows(0.18, 0.002, 0)), "e0 (−18\u00a0%), 2 that would take off less than 1\u00a0%");
  assert.equal(outWords(rows(0.001)), "e0 (−0.1\u00a0%)", "a list of none would be no list");
});

test("a surprise has no points, and says whether it is found", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { surpriseWords } = await import("../src/hidden.js");
  assert.equal(surpriseWords({ found: 0, hidden: 1, solved: false }), "In this knob one effect is hidden: see whether it is found.");
  assert.equal(surpriseWords({ found: 1, hidden: 2, solved: false }), "In this knob 2 effects are hidden, 1 of them found: see whether it is found.");
  assert.match(surpriseWords({ found: 1, hidden: 1, solved: true }), /is in the model, and nothing that was not\.$/);
  assert.match(surpriseWords({ found: 1, hidden: 1, solved: false }), /but so is something that was not\.$/);
});

test("a fall has the digits that it has where it is told without its sign", () => {
  for (const share of [0.088, 0.0973, 0.31, 0.002]) assert.equal(percent(-share), `−${percent(share)}`);
  assert.deepEqual([0, -0.0001, -0.097].map(percent), ["0\u00a0%", "0\u00a0%", "−9.7\u00a0%"]);
});

test("work that goes on says for how long, and how long it usually takes", async () => {
  const { timeWords } = await import("../src/job.js");
  assert.equal(timeWords(1.2, null), "");
  assert.equal(timeWords(12.9, null), "12\u00a0s");
  assert.equal(timeWords(3.1, [7.6, 28.5]), "3\u00a0s, usually 8 to 30\u00a0s");
});
