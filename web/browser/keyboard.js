/**
 * The whole loop without a pointer: `node keyboard.js CHROMIUM ADDRESS`.
 *
 * The workbench at ADDRESS has nothing open. A surprise is made, looked at, found, added, undone, dragged, branched and
 * saved by keys alone; whatever opens is closed by Escape. What was done is printed as JSON.
 */

import assert from "node:assert/strict";

import { done, opened, painted, stateOf } from "./session.js";

const [chrome, address] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
page.setDefaultTimeout(120_000);
const press = (key) => page.keyboard.press(key);
const there = (selector) => page.evaluate((selector) => document.activeElement?.matches(selector) ?? false, selector);
const open = () => page.locator("dialog[open], details.menu[open]").count();

/** Go on by Tab until the focus is on what a selector names. */
async function reach(selector) {
  for (let steps = 0; steps < 150; steps++) {
    if (await there(selector)) return;
    await press("Tab");
  }
  throw new Error(`${selector} is not reached by Tab`);
}

/** Open something by Enter, and close it by Escape: the focus is back where it was. */
async function opensAndCloses(selector) {
  await reach(selector);
  await press("Enter");
  await page.waitForFunction(() => document.querySelector("dialog[open], details.menu[open]"));
  await press("Tab");
  await press("Escape");
  assert.equal(await open(), 0, `${selector}: Escape closes what it opened`);
  assert.ok(await there(selector), `${selector}: the focus is back`);
}

await page.locator("#welcome").waitFor();
for (const one of ["#open", "#new", "#save summary", "#new-first"]) await opensAndCloses(one);
await reach("#new-first");
await press("Enter");
await reach("#new-go");
await press("Enter");
await painted(page, "data");
await page.locator(".candidate").first().waitFor();
const first = await stateOf(page);

await reach(".plot[aria-label='residual over velocity']");
await done(page, "brush", () => press("ArrowRight"));
assert.match(await page.locator("#chosen").textContent(), /of the squared error/);
for (const key of [".", ".", ",", "Shift+ArrowRight", "z", "z"]) await press(key);
await press("Escape");

await reach(".candidate");
await press("ArrowDown");
await press("ArrowUp");
await press("?");
await page.locator("#about[open]").waitFor();
await press("Escape");
assert.equal(await open(), 0, "Escape closes what tells of an effect");
await page.waitForFunction(() => document.activeElement?.matches(".candidate"));
const effect = await page.evaluate(() => document.activeElement.dataset.effect);
await page.emulateMedia({ reducedMotion: "no-preference" });
await done(page, "add", () => press("Enter"));
// Residuals that move to where the new model leaves them arrive there, though bins come in meanwhile.
await page.waitForFunction(() => {
  const { residuals, data } = window.knobcam.app.linked;
  return data.splits && residuals.every(({ contents }) => contents.series[0].y === data.columns.residual);
}, null, { timeout: 10_000 });
await page.emulateMedia({ reducedMotion: "reduce" });
const second = await stateOf(page);
assert.equal(second.ladder.length, 2);
for (let again = 0; again < 3; again++) await press("Enter"); // nothing has the focus that would add another one
await page.waitForTimeout(500);
assert.deepEqual((await stateOf(page)).ladder, second.ladder);

await done(page, "undo", () => press("Control+z"));
await done(page, "redo", () => press("Control+Shift+z"));
await reach(".params input");
await done(page, "drag", () => press("ArrowRight"));
await press("Shift+Tab");
await reach("#snap");
await done(page, "snap", () => press("Enter"));
await reach("#new-branch");
await press("Enter");
await page.locator(".branch").nth(1).waitFor();
await reach("[data-beside]");
await done(page, "beside", () => press("Space"));

// A formula of one's own: fitted while it is typed, taken by Enter, and not a second time.
await reach("#own summary");
await press("Enter");
await reach("#own-form [name=law]");
await page.keyboard.type("k*theta");
await page.locator("#own-tried", { hasText: "would leave" }).waitFor();
await done(page, "add", () => press("Enter"), 1);
const third = await stateOf(page);
assert.equal(third.ladder.at(-1).label, "+ law");
await press("Enter");
await page.waitForTimeout(500);
assert.deepEqual((await stateOf(page)).ladder, third.ladder);

await reach("#unhide");
await press("Enter");
await page.locator("#unhidden", { hasText: /\w/ }).waitFor();
await opensAndCloses("#save summary");
await reach("#save summary");
await press("Enter");
await reach("[data-save=script]");
const saving = page.waitForEvent("download");
await press("Enter");
const script = (await saving).suggestedFilename();
assert.equal(await open(), 0);
assert.deepEqual(complaints, []);
await browser.close();
console.log(JSON.stringify({ effect, script, rmse: [first.rmse, second.rmse] }));
