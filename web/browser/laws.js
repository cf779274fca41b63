/**
 * A law for what no effect explains, in a browser: `node laws.js CHROMIUM ADDRESS FOLDER`.
 *
 * The workbench at ADDRESS has a capture open that no effect explains. It is looked for, laid over the residuals by
 * pointing and by key, and taken. Pictures go to FOLDER; what was seen is printed as JSON.
 */

import assert from "node:assert/strict";
import { join } from "node:path";

import { accessible } from "./axe.js";
import { done, opened, painted, stateOf } from "./session.js";

const [chrome, address, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
page.setDefaultTimeout(120_000);
await page.setViewportSize({ width: 1440, height: 900 });
const picture = (name) => page.screenshot({ path: join(folder, `${name}.png`) });
await painted(page, "first picture");

await page.getByRole("button", { name: "Look for a law…" }).click();
const law = page.locator(".law").first();
await law.waitFor();
const looked = page.locator("#looked");
assert.ok(await looked.isHidden());
const curve = page.locator("#curve-plot");
assert.match(await curve.getAttribute("aria-label"), /left over velocity, with its 95 % band; green: law 1/);
await law.hover();
await painted(page, "look");
assert.equal(await looked.textContent(), "what law 1 would explain");
await picture("31-law");
await accessible(page, "laws");
await page.mouse.move(1, 1);
await looked.waitFor({ state: "hidden" });

// The verdict, which is read first, leads to it.
const led = page.locator("#verdict .leads", { hasText: /^A formula$/ });
assert.match(await page.locator("#verdict").textContent(), /A formula is proposed: it would leave [\d.]+\smNm of the [\d.]+\smNm/);
await led.click();
await page.locator("#laws.shown").waitFor();

const before = await stateOf(page);
await page.getByLabel("name of law 1").fill("eddy");
assert.equal(await looked.textContent(), "what law 1 would explain"); // for the keys are there
const figures = { add: await done(page, "add", () => page.keyboard.press("Enter")) };
const after = await stateOf(page);
await picture("32-law-taken");

// The same as a formula of one's own, first with a bracket too few.
await done(page, "undo", () => page.keyboard.press("Control+z"));
const form = page.locator("#own-form");
await page.getByRole("button", { name: "edit law 1" }).click();
assert.equal(await form.getByLabel("Torque").inputValue(), "2*a*(omega/w)/(1 + (omega/w)^2)");
assert.match(await form.getByLabel("starts at").inputValue(), /^a=0\.00\d+ w=1\.\d+$/);
await form.getByLabel("Torque").fill("2 b (omega/w) / (1 + (omega/w)^2");
await form.getByLabel("starts at").fill("b=0.01 w=1");
await page.locator("#own-tried", { hasText: "character" }).waitFor(); // while it is typed
await form.getByLabel("called").fill("brake");
await page.keyboard.press("Enter");
await page.waitForFunction(() => /character/.test(document.getElementById("said").textContent));
await picture("33-formula-refused");
assert.equal(complaints.splice(0).length, 2); // the refusal, as the browser tells it and as it came
await form.getByLabel("Torque").fill("2 b (omega/w) / (1 + (omega/w)^2)");
await page.locator("#own-tried", { hasText: /^would leave 0\.\d+ mNm, .* w = 1\.\d+ ± 0\.\d+ rad\/s/ }).waitFor();
assert.equal(await looked.textContent(), "what the formula that is typed would explain");
assert.deepEqual((await stateOf(page)).ladder, before.ladder, "nothing is taken by typing");
figures.formula = await done(page, "add", () => page.keyboard.press("Enter"), figures.add);
const typed = await stateOf(page);
assert.equal(typed.ladder.at(-1).label, "+ brake");
assert.ok(Math.abs(typed.rmse / after.rmse - 1) < 1e-3);
assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
assert.deepEqual(complaints, []);
console.log(JSON.stringify({ figures, rmse: [before.rmse, after.rmse], ladder: after.ladder.map(({ label }) => label) }));
await browser.close();
