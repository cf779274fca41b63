/**
 * What captures do not tell, in a browser: `node untold.js CHROMIUM PENDULUM SERVO`.
 *
 * The workbench at the address PENDULUM has a capture open that knows an inertia and a weight only together, that at
 * SERVO several which disagree. What was designed for the one, and what is said of the others, is printed as JSON.
 */

import assert from "node:assert/strict";

import { done, opened, painted, stateOf } from "./session.js";

const [chrome, pendulum, servo] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, pendulum);
page.setDefaultTimeout(120_000);
await painted(page, "first picture");

// Two that are known together alone: the button beside that designs the motion which tells them.
await page.locator("#verdict .leads", { hasText: "Add it" }).waitFor();
await done(page, "add", () => page.locator("#verdict .leads", { hasText: "Add it" }).click());
const untold = page.locator("#findings li", { hasText: "Cannot be told: " }).filter({ has: page.getByRole("button") });
const { limitations } = await stateOf(page);
const design = untold.getByRole("button", { name: "Design that motion…" });
const title = await design.getAttribute("title");
await design.click();
await page.locator("#next:visible").waitFor();
const { experiment } = await stateOf(page);
const headline = await page.locator("#next-headline").textContent();

// What captures disagree on is one line, and by how much for who opens it; it stays open while the page goes on.
await page.goto(servo);
const apart = page.locator("#findings details[data-at]").first();
await apart.waitFor();
const line = await apart.innerText();
const params = (await stateOf(page)).disagreements.map(({ param }) => param);
assert.equal(await apart.locator("p").isVisible(), false);
await apart.locator("summary").click();
const whole = await apart.innerText();
await page.evaluate(() => globalThis.knobcam.app.refresh(Infinity));
await page.waitForTimeout(500);
assert.ok(await apart.locator("p").isVisible(), "who has opened it reads on");

assert.deepEqual(complaints, []);
await browser.close();
console.log(JSON.stringify({ sharpen: limitations.map((one) => one.sharpen), title, promises: experiment.promises, headline, line, whole, params }));
