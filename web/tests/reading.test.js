import assert from "node:assert/strict";
import { test } from "node:test";

import { beyondWords, mostLimits, mostReach } from "../src/outliers.js";
import { labelWithin } from "../src/axes.js";
import { ticks, unitWords } from "../src/numbers.js";
import { known, paramOf } from "../src/names.js";
import { sentence } from "../src/said.js";
import { beside, further, plainly } from "../src/verdict.js";

const KNOB = /** @type {const} */ ({ unit: "N m", peak: 0.02, coordinate: "rotary" });

test("an axis always has two ticks at least, for one is no scale", () => {
  for (let span = 1; span < 10; span += 0.01) {
    for (const count of [2, 2.5, 3, 3.75]) {
      const marks = ticks(-span, span, count);
      assert.ok(marks.length >= 2 && marks.length <= 2 * count + 2, `${marks} from ${-span} to ${span}`);
    }
  }
});

test("a few outliers do not flatten all other residuals, and are said to be beyond", () => {
  const values = Float32Array.from({ length: 5000 }, (_, at) => Math.sin(at));
  assert.ok(Math.abs(mostReach(values.slice()) - 1) < 1e-3);
  values[7] = -50;
  values[4000] = 9;
  assert.ok(Math.abs(mostReach(values.slice()) - 1) < 1e-3);
  assert.match(beyondWords(values, -1.04, 1.04), /2 samples beyond/);
  assert.equal(beyondWords(values, -60, 60), "");
});

test("what is there at every reversal is no outlier, and nothing at all has no reach", () => {
  const peaks = Float32Array.from({ length: 5000 }, (_, at) => (at % 100 === 0 ? 10 : Math.sin(at)));
  assert.equal(mostReach(peaks.slice()), 10);
  assert.equal(mostReach(new Float32Array(9)), 0);
  assert.equal(mostReach(Float32Array.from([NaN, NaN])), 0);
});

test("a verdict begins with what is missing in plain words, and with what to do next", () => {
  const row = { could_be: true, said: ["missing"], name: "there are detents", effect: "detent", error_fall: 0.6, equivalent: [] };
  known({ titles: { position_polynomial: "smooth torque over position" } });
  /** @type {string[]} */
  const led = [];
  const to = /** @type {any} */ ({ add: (/** @type {string} */ one) => led.push(one), apart: (/** @type {string[]} */ all) => led.push(all.join()) });
  const said = (/** @type {any} */ candidates) => plainly(candidates, KNOB, to).map((part) => (typeof part === "string" ? part : part.words)).join("");
  assert.equal(said({ ready: true, rows: [row] }), "Missing: there are detents (detent), which takes 60\u00a0% off the error. Add it, and see what is left; or find everything at once.");
  const unsettled = { ready: true, rows: [{ ...row, unsettled: "none of its values is determined: each may be nothing as well" }] };
  assert.match(said(unsettled), /off the error\. But none of its values is determined: .*\. Add it to see what is left, not for its values; or find everything at once\.$/);
  const tied = { ready: true, rows: [{ ...row, equivalent: ["position_polynomial"] }] };
  assert.match(said(tied), /looks the same with smooth torque over position: .* Tell apart designs what to record next/);
  const beside = { ready: true, rows: [{ ...row, word: "part", equivalent: ["a", "b", "position_polynomial"] }] };
  assert.match(said(beside), / Instead of it, or beside it, it could be a, b or smooth torque over position: once nothing else is missing/);
  for (const part of plainly(/** @type {any} */ (tied), KNOB, to)) if (typeof part === "object" && /Add|Tell/.test(part.words)) part.go();
  assert.deepEqual(led, ["detent", "detent,position_polynomial"]);
  assert.equal(said({ ready: false, rows: [row] }), "");
  assert.equal(said({ ready: true, rows: [{ ...row, could_be: false }] }), "");
});

test("a headline says what was added to the model that it is of", () => {
  known({ titles: { torque_drift: "torque drift" } });
  assert.deepEqual(beside(["detent", "torque_drift", "law"], ["What is left", " is chance."]), ["With detent, torque drift and law added, ", "what is left", " is chance."]);
  assert.deepEqual(beside(["torque_drift"], ["Missing: there are detents"]), ["With torque drift added, ", "missing: there are detents"]);
  assert.deepEqual(beside([], ["Missing"]), ["Missing"]);
  assert.deepEqual(beside(["detent"], []), []);
});

test("what to record next waits for what is missing, and says in words what shows more of what has no name", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { insteadOf, purposeOf } = await import("../src/untold.js");
  const state = (/** @type {boolean} */ could, /** @type {string | null} */ record, /** @type {string[][]} */ untold = []) =>
    insteadOf(/** @type {any} */ ({ candidates: { rows: [{ could_be: could }] }, record, shown_along: record && !untold.length ? "position" : null, untold }));
  assert.match(state(true, null), /once what is missing is in the model/);
  assert.equal(state(false, "slow passes"), "What to record next, to see what it is: slow passes.");
  assert.equal(state(false, null), "", "where nothing is missing a motion is designed");
  assert.equal(state(true, null, [["detent", "return_spring"]]), "", "and where effects look alike");
  // Within limits that are looked at before one is designed it is said what for.
  const purpose = (/** @type {string[][]} */ untold) => purposeOf(/** @type {any} */ ({ candidates: { rows: [] }, record: null, shown_along: null, untold }));
  assert.match(purpose([]), /known least/);
  assert.match(purpose([["detent", "return_spring"]]), /tells apart/);
});

test("what to record next is said as soon as it is concluded, and not when all the rest is weighed as well", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { tellsNext } = await import("../src/untold.js");
  const tells = (/** @type {boolean} */ ready, /** @type {string[]} */ concluded, node = /** @type {string | null} */ ("n1")) =>
    tellsNext(/** @type {any} */ ({ candidates: { ready }, concluded, node }));
  assert.deepEqual([tells(false, []), tells(true, []), tells(false, ["Cogging found"]), tells(true, [], null)], [false, true, true, false]);
});

test("a motion is offered for what has no name where one shows more of it, and none while something is missing", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { waitsFor } = await import("../src/untold.js");
  const waits = (/** @type {boolean} */ could, /** @type {string | null} */ record, /** @type {string | null} */ along) =>
    waitsFor(/** @type {any} */ ({ candidates: { rows: [{ could_be: could }] }, record, shown_along: along, untold: [] }));
  assert.equal(waits(false, "slow passes", "position"), false);
  assert.equal(waits(false, "another load", null), true, "no motion is another load");
  assert.equal(waits(true, null, null), true);
  assert.equal(waits(false, null, null), false, "nothing is left: what is known least is sharpened");
});

test("limits that are typed while something is missing are for what cannot be told from it", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { alikeOf } = await import("../src/untold.js");
  const of = (/** @type {string[]} */ equivalent, /** @type {string[][]} */ untold = []) =>
    alikeOf(/** @type {any} */ ({ candidates: { rows: [{ could_be: false }, { could_be: true, effect: "detent", equivalent }] }, untold }));
  assert.deepEqual(of(["return_spring"]), ["detent", "return_spring"]);
  assert.deepEqual(of([]), [], "nothing looks like it");
  assert.deepEqual(of(["return_spring"], [["backlash", "hysteresis"]]), [], "what came in and was not told is asked for first");
});

test("the label of an axis gives way to the title of a narrow plot, and keeps its unit", () => {
  const letters = (/** @type {string} */ text) => text.length;
  assert.equal(labelWithin("velocity, m/s", 20, letters), "velocity, m/s");
  assert.equal(labelWithin("velocity, m/s", 9, letters), "m/s");
  assert.equal(labelWithin("N m", 2, letters), "N m");
});

test("units and numbers of sentences are written as people write them", () => {
  assert.deepEqual(["N s^2/m", "N m s^2/rad", "1", "N m s^2/rad^2"].map(unitWords), ["kg", "kg m²", "", "N m s²/rad²"]);
  known({ titles: { coulomb: "dry friction", inertia: "inertia" }, params: /** @type {any} */ ([
    { name: "coulomb.neg", meaning: "dry friction moving backward, a magnitude" }, { name: "inertia.M", meaning: "mass" }]) });
  assert.equal(paramOf("coulomb.neg"), "dry friction moving backward", "an effect is not named twice");
  assert.equal(paramOf("inertia.M"), "mass (inertia)");
  assert.equal(sentence([{ param: "inertia.M" }, " = -0.1 of -3-fold"], KNOB), "mass (inertia) = −0.1 of −3-fold");
});

test("what a model makes of a capture is called as what was measured", () => {
  assert.equal(sentence([{ along: "load" }], KNOB), "modelled torque");
  assert.equal(sentence([{ along: "load" }], { ...KNOB, unit: "V" }), "modelled voltage");
});

test("a torque's axis is that of all but a few samples that would have half of it alone", () => {
  const torque = Float32Array.from({ length: 5000 }, (_, at) => 1 + Math.sin(at));
  const [low, high] = mostLimits(torque.slice(), torque);
  assert.ok(low < 0.001 && high > 1.999);
  torque[70] = 90;
  torque[71] = -40;
  torque[72] = NaN;
  assert.deepEqual(mostLimits(torque.slice(), torque).map((one) => Math.round(one)), [0, 2]);
  torque.fill(30, 100, 110); // ten are no outliers
  assert.deepEqual(mostLimits(torque.slice(), torque).map((one) => Math.round(one)), [0, 30]);
  assert.deepEqual(mostLimits(new Float32Array(9), new Float32Array(9)), [0, 0]);
  assert.deepEqual(mostLimits(Float32Array.from([NaN, NaN]), new Float32Array(2).fill(NaN)), [NaN, NaN]);
});

test("captures whose names begin alike are told apart by how they end", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { shortNames } = await import("../src/captures.js");
  const servo = ["2026-01-15_10h28m10.json", "2026-01-15_10h28m17.json", "2026-01-15_10h29m04.json"];
  assert.deepEqual(shortNames(servo), ["…10h28m10", "…10h28m17", "…10h29m04"]);
  const kinds = ["2026-01-15_10h28m10.json", "2026-01-15_10h28m10.csv", "2026-01-15_10h29m04.json"];
  assert.deepEqual(shortNames(kinds), ["…10h28m10.json", "…10h28m10.csv", "…10h29m04.json"], "of which kind, where that tells");
  for (const names of [["a.npz", "b.npz"], ["alone_in_it.npz"], []]) assert.deepEqual(shortNames(names), names);
  assert.deepEqual(shortNames(["knob 3.npz", "knob 3.npz"]), ["knob 3.npz", "knob 3.npz"], "names that are the same stay");
});

test("a note that is the same of all captures is said once", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { alikeInAll } = await import("../src/captures.js");
  const note = { said: ["columns"], severity: "note", overruled: false, seen: false };
  const other = { said: ["time"], severity: "note", overruled: false, seen: true };
  const captures = /** @type {any[]} */ ([{ findings: [note, other] }, { findings: [other, note] }]);
  assert.deepEqual([...alikeInAll(captures).values()], [note]);
  assert.equal(alikeInAll([...captures, /** @type {any} */ ({ findings: [] })]).size, 0);
  assert.equal(alikeInAll(captures.slice(1)).size, 0);
});

test("where no single effect explains what is left, the headline leads to a formula and to sets of effects", () => {
  /** @type {string[]} */
  const led = [];
  const to = { every: () => led.push("every"), laws: () => led.push("laws") };
  const law = /** @type {any} */ ({ rmse: 0.00063, fall: 0.65 });
  const said = (/** @type {any} */ state) => further(state, KNOB, /** @type {any} */ (to)).map((part) => (typeof part === "string" ? part : part.words)).join("");
  assert.equal(said({ sets: false, proposed: null }), "");
  assert.equal(said({ sets: false, proposed: [] }), "");
  assert.equal(said({ sets: false, proposed: [law] }), " A formula is proposed: it would leave 0.63\u00a0mNm of the 1.8\u00a0mNm that it was looked for in.");
  assert.match(said({ sets: true, proposed: null }), /one at a time: find everything weighs sets of them too\.$/);
  for (const part of further({ sets: true, proposed: [law] }, KNOB, /** @type {any} */ (to))) if (typeof part === "object") part.go();
  assert.deepEqual(led, ["laws", "every"]);
});

test("notes alone wait behind a line that counts them, what is doubtful is seen at once unless it is much", async () => {
  const { countedWords, waits } = await import("../src/captures.js");
  const of = (/** @type {string[]} */ ...kinds) => /** @type {any} */ (kinds.map((severity) => ({ severity, overruled: severity === "overruled" })));
  assert.deepEqual([of(), of("note"), of("note", "masked"), of("warning", "masked"), of("note", "note", "masked")].map(waits), [false, true, false, false, true]);
  assert.equal(countedWords(of("note")), "1 note on the log");
  assert.equal(countedWords(of("note", "note", "masked", "mended")), "⚠ 4 findings: 2 notes, 1 masked, 1 mended");
});
