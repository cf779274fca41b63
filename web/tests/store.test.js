import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.location = new URL("http://127.0.0.1:1/?token=secret");
const { Store, decode, joined } = await import("../src/store.js");

/** The server's binary answer. */
function answer(columns) {
  const head = JSON.stringify({ names: Object.keys(columns), n: Object.values(columns)[0].length, dtype: "f32" });
  const padded = head + " ".repeat(3 - (head.length % 4)) + "\n";
  return new Blob([padded, ...Object.values(columns)]).arrayBuffer();
}

test("columns are read as they were written", async () => {
  const columns = { tau: Float32Array.of(1, NaN, 3), "τ": Float32Array.of(4, 5, 6) };
  const text = new TextEncoder().encode(JSON.stringify({ names: ["tau", "τ"], n: 3, dtype: "f32" }));
  const head = new Uint8Array(Math.ceil((text.length + 1) / 4) * 4).fill(32);
  head.set(text);
  head[head.length - 1] = 10;
  assert.deepEqual(decode(await new Blob([head, columns.tau, columns["τ"]]).arrayBuffer()), columns);
});

test("captures follow one another, and time goes on", () => {
  const part = (start) => ({ t: Float32Array.of(start, start + 1), tau: Float32Array.of(start, 2) });
  const whole = joined([part(0), part(5)], ["t", "tau"]);
  assert.deepEqual(Array.from(whole.t), [0, 1, 1, 2]);
  assert.deepEqual(Array.from(whole.tau), [0, 2, 5, 2]);
});

test("what was fetched is not fetched again, and the token goes along", async () => {
  const asked = [];
  globalThis.fetch = async (path, options) => {
    asked.push(path);
    assert.equal(options.headers["x-knobcam-token"], "secret");
    const names = new URL(path, location).searchParams.get("names").split(",");
    const columns = Object.fromEntries(names.map((name) => [name, Float32Array.of(1, 2)]));
    return new Response(await answer(columns));
  };
  const store = new Store();
  await store.columns("n1", ["c1"], ["tau", "model"]);
  await store.columns("n1", ["c1"], ["tau", "model"]);
  assert.equal(asked.length, 1);
  await store.columns("n2", ["c1"], ["tau", "model"]);
  assert.match(asked[1], /names=model$/); // the motion is the same for every model
});
