/**
 * What a person does most: `node often.js CHROMIUM ADDRESS EFFECT`.
 *
 * EFFECT, which is linear, is added before anything is weighed, undone and done again; a parameter is dragged. How long
 * each took until it was painted is printed as JSON: the middle of several, as a browser and its machine do other work.
 */

import { brushed, done, launched, opened, painted } from "./session.js";

const TIMES = 5;
const [chrome, address, effect] = process.argv.slice(2);

/**
 * The middle one of several measurements, by when it was painted.
 * @param {() => Promise<{script: number, painted: number}>} measure
 */
async function middle(measure) {
  const all = [];
  for (let time = 0; time < TIMES; time++) all.push(await measure());
  return all.sort((one, other) => one.painted - other.painted)[(TIMES - 1) / 2];
}

/** The first picture in a browser that has just been started, and that nobody looks into before it is there. */
async function first() {
  const { browser, page } = await launched(chrome);
  await page.goto(address, { waitUntil: "commit" });
  await new Promise((resolve) => setTimeout(resolve, 4000));
  const measured = await painted(page, "first picture");
  await browser.close();
  return measured;
}

const figures = { first: await middle(first) };
const { browser, page } = await opened(chrome, address);
page.setDefaultTimeout(240_000);
await painted(page, "first picture");
await page.waitForTimeout(2000); // what is prepared while nobody does anything
figures.brush = await middle(() => brushed(page, "residual over velocity", [0.47, 0.12], [0.62, 0.85]));
await page.keyboard.press("Escape");
await page.locator("#any-effect").selectOption(effect);
figures[effect] = await done(page, "add", () => page.locator("#any button[type=submit]").click());
const cancel = page.getByRole("button", { name: "Cancel" });
if (await cancel.isVisible()) await cancel.click(); // what is weighed in the background has the processors
await page.waitForTimeout(2000);
figures.undo = await middle(async () => {
  const measured = await done(page, "undo", () => page.keyboard.press("Control+z"));
  await done(page, "redo", () => page.keyboard.press("Control+Shift+z"));
  return measured;
});
figures.redo = await middle(async () => {
  await done(page, "undo", () => page.keyboard.press("Control+z"));
  return done(page, "redo", () => page.keyboard.press("Control+Shift+z"));
});
await page.locator(".params input").first().focus();
figures.drag = await middle(() => done(page, "drag", () => page.keyboard.press("ArrowRight")));
await browser.close();
console.log(JSON.stringify({ figures }));
