/**
 * What a person does most, on a capture that is large: `node large.js CHROMIUM ADDRESS EFFECT`.
 *
 * EFFECT, which is linear, is added before anything is weighed, undone and done again; a parameter is dragged. How long
 * each took until it was painted is printed as JSON.
 */

import { brushed, done, opened, painted } from "./session.js";

const [chrome, address, effect] = process.argv.slice(2);
const { browser, page } = await opened(chrome, address);
page.setDefaultTimeout(240_000);
const figures = { first: await painted(page, "first picture") };
await page.waitForTimeout(2000); // what is prepared while nobody does anything
figures.brush = await brushed(page, "residual over velocity", [0.47, 0.12], [0.62, 0.85]);
await page.keyboard.press("Escape");
await page.locator("#any-effect").selectOption(effect);
figures[effect] = await done(page, "add", () => page.locator("#any button[type=submit]").click());
const cancel = page.getByRole("button", { name: "Cancel" });
if (await cancel.isVisible()) await cancel.click(); // what is weighed in the background has the processors
await page.waitForTimeout(2000);
figures.undo = await done(page, "undo", () => page.keyboard.press("Control+z"));
figures.redo = await done(page, "redo", () => page.keyboard.press("Control+Shift+z"));
await page.locator(".params input").first().focus();
await done(page, "drag", () => page.keyboard.press("ArrowRight"));
figures.drag = await done(page, "drag", () => page.keyboard.press("ArrowRight"));
await browser.close();
console.log(JSON.stringify({ figures }));
