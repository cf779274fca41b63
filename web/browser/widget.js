/**
 * The widget in a page that keeps anywidget's protocol: `node widget.js CHROMIUM MODULE STATE FOLDER`.
 *
 * STATE is what Python shares, bytes as base64 under the names that `bytes` lists, and under `overlay` what its
 * answer about the first candidate would be. Pictures go to FOLDER; what was said to Python is printed.
 */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { brushed, launched, painted } from "./session.js";

const [chrome, module, state, folder] = process.argv.slice(2);
const NOTEBOOK = "http://notebook.test/";
const PAGE = `<!DOCTYPE html><title>notebook</title>
<style>.plot, .candidate { display: none; } button { color: rgb(255, 0, 0); }</style>
<body data-jp-theme-light="true"><button class="key soft" id="own">a button of the notebook</button></body>`;
const served = {
  [NOTEBOOK]: { contentType: "text/html", body: PAGE },
  [`${NOTEBOOK}widget.js`]: { contentType: "text/javascript", body: readFileSync(module) },
  [`${NOTEBOOK}state.json`]: { contentType: "application/json", body: readFileSync(state) },
};

const { browser, page, complaints } = await launched(chrome);
await page.route("**", (route) => {
  const answer = served[route.request().url()];
  return answer ? route.fulfill(answer) : route.abort();
});
await page.goto(NOTEBOOK);
const own = () => page.locator("#own").evaluate((button) => JSON.stringify({ ...getComputedStyle(button) }));
const before = await own();

await page.evaluate(async () => {
  const { bytes, overlay, ...state } = await (await fetch("state.json")).json();
  const view = (text) => new DataView(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
  for (const name of bytes) state[name] = view(state[name]);
  overlay.floats = view(overlay.floats);
  state.overlay = {};
  const listeners = new Map();
  const heard = (event) => listeners.get(event) ?? listeners.set(event, new Set()).get(event);
  const model = {
    saved: 0,
    get: (name) => state[name],
    set: (name, value) => {
      if (state[name] === value) return;
      state[name] = value;
      for (const hear of [...heard(`change:${name}`)]) hear();
    },
    save_changes: () => {
      model.saved++;
      if (state.looked === overlay.effect) setTimeout(() => model.set("overlay", overlay), 20); // Python answers
    },
    on: (event, hear) => heard(event).add(hear),
    off: (event, hear) => heard(event).delete(hear),
  };
  const { default: widget } = await import("./widget.js");
  const views = [];
  const render = () => {
    const el = document.createElement("div");
    document.body.append(el);
    views.push({ el, leave: widget.render({ model, el }) });
    window.knobcam ??= el.firstElementChild.knobcam;
  };
  const chosen = () => {
    const bits = new Uint8Array(state.chosen.buffer);
    return bits.reduce((sum, byte) => sum + byte.toString(2).replaceAll("0", "").length, 0);
  };
  Object.assign(window, { notebook: { model, views, render, chosen, listeners } });
  render();
});
const inView = (at, selector) => page.locator("body > div").nth(at).locator(selector);
const words = (at) => inView(at, ".below p").textContent();
await painted(page, "data");
assert.equal(await own(), before, "no style of the widget gets out");
assert.equal(await inView(0, ".plot:visible").count(), 6, "no style of the notebook gets in");
assert.match(await inView(0, ".look").textContent(), /25,000 of 1,000,000 samples are shown, taken at random/);

await brushed(page, "residual over velocity", [0.47, 0.12], [0.62, 0.85]);
await page.waitForFunction(() => window.notebook.chosen() > 0);
await page.waitForTimeout(300);
const [said] = /^[\d,]+/.exec(await words(0));
assert.equal(await page.evaluate(() => window.notebook.chosen()), Number(said.replaceAll(",", "")));
const saved = await page.evaluate(() => window.notebook.model.saved);
assert.ok(saved < 20, `${saved} messages for 20 moves`);

const drawn = () => page.evaluate(() => window.knobcam.look.linked.seen.filter(Boolean).length);
await page.mouse.wheel(0, -300);
await page.waitForTimeout(200);
assert.equal(await drawn(), 1, "the wheel zooms the plot that was clicked");
await inView(0, ".plot:visible").nth(5).hover();
await page.mouse.wheel(0, 1);
await page.waitForTimeout(200);
assert.equal(await drawn(), 1, "over any other it scrolls the notebook");

const first = inView(0, ".candidate").first();
await first.hover();
await inView(0, ".key .signature").waitFor();
await first.getByRole("button").click();
await page.mouse.move(5, 5);
await page.waitForTimeout(200);
assert.match(await inView(0, ".steps").textContent(), /would explain/, "what is held stays");
await page.screenshot({ path: join(folder, "11-widget.png") });

const ground = () =>
  inView(0, "canvas.points").first().evaluate((canvas) => canvas.getContext("2d").getImageData(0, 0, 1, 1).data.join());
const light = await ground();
await page.evaluate(async () => {
  document.body.style.display = "none"; // for a moment, as JupyterLab does
  document.body.dataset.jpThemeLight = "false";
  await new Promise((resolve) => setTimeout(resolve));
  document.body.style.display = "";
});
await page.waitForTimeout(300);
assert.notEqual(await ground(), light, "it follows the notebook's theme");
await page.screenshot({ path: join(folder, "12-widget-dark.png") });

await page.evaluate(() => window.notebook.render());
await page.waitForTimeout(300);
assert.equal(await words(1), await words(0), "a second view shows the same samples");
await inView(1, ".plot").first().focus();
await page.keyboard.press("ArrowRight");
await page.waitForTimeout(400);
assert.equal(await words(1), await words(0), "what is brushed in one view is chosen in the other");
await page.keyboard.press("Escape");
await page.waitForTimeout(400);
assert.equal(await page.evaluate(() => window.notebook.chosen()), 0);
assert.equal(await page.evaluate(() => window.notebook.model.get("looked")), "");

await page.evaluate(() => {
  const { model } = window.notebook;
  model.set("chosen", new DataView(Uint8Array.of(0b1010_0001).buffer));
  model.set("step", 1);
});
await page.waitForTimeout(300);
for (const at of [0, 1]) {
  assert.match(await words(at), /^3 samples chosen/, "what Python chooses lights up");
  assert.equal(await inView(at, ".steps button").nth(1).getAttribute("aria-pressed"), "true");
}
assert.equal(await inView(0, "img, script").count(), 0, "names are text");
assert.equal(await page.title(), "notebook");

const left = await page.evaluate(() => {
  for (const { leave } of window.notebook.views) leave();
  document.body.dataset.jpThemeLight = "true";
  const { views, listeners } = window.notebook;
  return { elements: views.map(({ el }) => el.childElementCount), heard: [...listeners.values()].map(({ size }) => size) };
});
assert.ok([...left.elements, ...left.heard].every((count) => count === 0), "nothing stays behind");
await page.waitForTimeout(200);
assert.deepEqual(complaints, []);
await browser.close();
console.log(JSON.stringify({ said, saved }));
