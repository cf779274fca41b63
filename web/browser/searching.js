/**
 * All that is missing, found at once: `node searching.js CHROMIUM ADDRESS FOLDER`.
 *
 * The page at ADDRESS has a capture of a knob that lacks effects. What the ladder said before, with what was found and
 * after going back is printed as JSON, with what the headline said.
 */

import assert from "node:assert/strict";
import { join } from "node:path";

import { accessible } from "./axe.js";
import { done, opened, painted, stateOf } from "./session.js";

const [chrome, address, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
page.setDefaultTimeout(120_000);
await painted(page, "first picture");
const ladder = () => page.locator("#ladder .label").allTextContents();
const alone = page.getByText("Find everything weighs sets too", { exact: false });
const find = page.getByRole("button", { name: "Find everything", exact: true });

// Given up it changes nothing, and can be begun again.
const before = await ladder();
await find.click();
await page.locator("#job-what", { hasText: /^(fitting|weighing|adding)/ }).waitFor();
assert.doesNotMatch(await page.locator("#job-what").textContent(), /_/, "no ids");
const stop = page.getByRole("button", { name: "Stop here" });
assert.ok(await stop.isVisible(), "it can be ended with what it has");
await page.getByRole("button", { name: "Cancel" }).click();
await page.locator("#said", { hasText: "cancelled; nothing was changed" }).waitFor();
assert.deepEqual(await ladder(), before);

// Ended before anything came in it says so, and can be begun again.
await find.click();
await stop.click();
await page.locator("#said", { hasText: /^the search was ended after \d+\u00a0s; nothing had come in yet$/ }).waitFor();
assert.deepEqual(await ladder(), before);

await page.locator("#verdict .leads", { hasText: "find everything" }).waitFor();
assert.ok(await stop.isHidden(), "of what is weighed in the background there is nothing to keep");
await alone.waitFor(); // whoever goes step by step is told that the search may end elsewhere
await page.locator("#verdict .leads", { hasText: "find everything" }).evaluate((lead) => lead.click());
await done(page, "search", () => page.locator("aside").evaluate((aside) => aside.scrollTo(0, aside.scrollHeight)));
await page.waitForFunction(() => globalThis.knobcam.app.state.searched && globalThis.knobcam.app.state.candidates.ready);
const found = await ladder();
const said = await page.locator("#verdict strong").textContent();
assert.ok(await find.isDisabled() && !(await alone.isVisible()), "there is no more to be found");
const { y } = await page.locator("#verdict").boundingBox();
assert.ok(Math.ceil(y) >= (await page.locator("aside").boundingBox()).y, "what was found is in sight");
await page.locator("h1").hover();
await page.screenshot({ path: join(folder, "30-found-everything.png") });
await accessible(page, "everything found");
await done(page, "undo", () => page.getByRole("button", { name: "Undo" }).click());
await page.waitForFunction((count) => document.querySelectorAll("#ladder .label").length === count, found.length);
const { branches } = await stateOf(page);
const back = branches[0].at;

// What is hidden in a challenge is not told by it.
await page.getByRole("button", { name: "New capture…" }).click();
await page.locator("#new-form [name=hides]").selectOption("easy");
await page.locator("#new-form button[type=submit]").click();
await page.locator("#hides:visible").waitFor();
await page.waitForFunction(() => document.body.classList.contains("sealed"));
const sealed = await find.isHidden();
const another = page.getByRole("button", { name: "Another challenge" });
assert.ok(await another.isHidden(), "who has not found it is not led away from it");
const { id } = (await stateOf(page)).captures.at(-1);
await page.getByRole("button", { name: "What was hidden?" }).click();
await another.click();
await page.waitForFunction((before) => globalThis.knobcam.app.state.captures.at(-1).id !== before, id);
await page.waitForFunction(() => document.body.classList.contains("sealed"));
assert.match(await page.locator("#challenge-score").textContent(), /^100 points$/);
assert.ok(await another.isHidden());
assert.deepEqual(complaints.filter((one) => !/400|cancelled/.test(one)), []);
await browser.close();
console.log(JSON.stringify({ before, found, said, back, sealed }));
