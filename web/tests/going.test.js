import assert from "node:assert/strict";
import { test } from "node:test";

test("a session that was left is told with its files, its fits and its end", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { called, words } = await import("../src/going.js");
  const left = { id: "000001", when: 0, ended: false, captures: ["a.npz", "<b>"], steps: 1, wrong: null };
  assert.match(words(left), /^one fit, broken off .*(1970|1969)/);
  assert.equal(words({ ...left, ended: true, steps: 3, when: null }), "3 fits, ended");
  assert.equal(called(left), "a.npz, <b>");
  assert.equal(called({ ...left, captures: ["a", "b", "c"] }), "a, b, c");
  assert.equal(called({ ...left, captures: ["a", "b", "c", "d"] }), "a, b and 2 more");
});

test("how the page looks is told when it rests, and once", async () => {
  globalThis.location = /** @type {any} */ ({ search: "" });
  const { Looking } = await import("../src/going.js");
  /** @type {any[]} */
  const sent = [];
  globalThis.fetch = /** @type {any} */ (async (_, { body }) => {
    sent.push(JSON.parse(body));
    return { ok: true, json: async () => ({}) };
  });
  let plot = 0;
  const view = { axes: ["position", "velocity", "time"], isolated: false, band: false, held: true };
  const looking = new Looking(() => ({ view, beside: null, brush: { plot, x: [0, 1], y: [0, 1] } }));
  for (plot = 0; plot < 5; plot++) looking.changed();
  await new Promise((resolve) => setTimeout(resolve, 400));
  looking.changed();
  await new Promise((resolve) => setTimeout(resolve, 400));
  assert.equal(sent.length, 1);
  assert.equal(sent[0].brush.plot, 5);
});
