/**
 * Files handed over in the browser: `node files.js CHROMIUM ADDRESS GOOD BROKEN FOLDER`.
 *
 * The workbench at ADDRESS has nothing open. GOOD is a capture whose name would be markup; BROKEN is one whose
 * columns angle (degrees) and moment (mN m) have to be mapped.
 */

import assert from "node:assert/strict";
import { basename, join } from "node:path";

import { accessible } from "./axe.js";
import { done, opened, stateOf } from "./session.js";

const [chrome, address, good, broken, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
await page.locator("#welcome").waitFor();
assert.equal(await page.locator("#said").textContent(), "", "nothing has gone wrong");
await page.screenshot({ path: join(folder, "8-welcome.png") });
await accessible(page, "welcome");

await page.getByRole("button", { name: "Open…" }).click();
await page.screenshot({ path: join(folder, "9-open.png") });
await page.locator("#open-file").setInputFiles(broken);
await page.locator("#open-columns button").first().waitFor();
const refused = await page.locator("#open-said").textContent();
assert.equal((await stateOf(page)).captures.length, 0);
assert.equal(await page.locator("#open-columns button").count(), 3);
await page.screenshot({ path: join(folder, "9-map.png") });
await accessible(page, "mapping");
assert.equal(await page.locator("[name=t]").inputValue(), "t");
assert.equal(await page.locator("[name=theta]").inputValue(), "angle", "by its name");
assert.equal(await page.locator("[name=t-unit]").inputValue(), "s", "so many rows a unit are seconds");
await page.locator("[name=tau]").fill("");
await page.locator("[name=tau]").focus();
await page.getByRole("button", { name: /^moment / }).click();
assert.equal(await page.locator("[name=tau]").inputValue(), "moment");
const mapping = page.getByRole("button", { name: "Open", exact: true });
const asked = async (words) => {
  await mapping.click();
  assert.match(await page.locator("#open-said").textContent(), words);
  assert.equal((await stateOf(page)).captures.length, 0);
};
await asked(/turn or slide/);
await page.locator("#open-linear").check();
assert.equal(await page.locator("[name=theta-unit] option[value=deg]").count(), 0, "no angle on an axis that slides");
await page.locator("#open-rotary").check();
await asked(/unit is angle/);
await page.locator("[name=omega]").fill("angle");
await page.locator("[name=theta-unit]").selectOption("rad");
assert.equal(await page.locator("[name=omega-unit]").inputValue(), "rad/s", "a velocity is in the position's unit, a second");
await page.locator("[name=omega]").fill("");
assert.match(await page.locator("#open-map").textContent(), /over [\d.]+ turns/); // so that nobody takes degrees for them
await page.locator("[name=tau-unit]").selectOption("mNm");
await page.locator("[name=theta-unit]").selectOption("counts");
await asked(/many counts has a turn/);
await page.locator("[name=counts]").fill("360"); // as an encoder whose counts are degrees
await page.getByText(/counts, over [\d.]+ degrees/).waitFor();
assert.equal(await page.evaluate(() => document.querySelector("#open-said").textContent), "", "what is answered is asked no more");
const foot = await page.locator("#open-dialog .foot").boundingBox();
assert.ok(foot.y + foot.height <= page.viewportSize().height, "the way on is on the screen");
await page.locator("[name=theta-unit]").selectOption("deg");
assert.ok(await page.locator("[name=counts]").isHidden());
await page.screenshot({ path: join(folder, "9-mapped.png") });
await done(page, "data", () => mapping.click());
const mapped = (await stateOf(page)).captures[0].samples;

await page.getByRole("button", { name: "Open…" }).click();
assert.equal(await page.locator("[name=theta]").inputValue(), "", "another file has columns of its own");
await page.locator("#open-same").check();
await page.locator("#open-file").setInputFiles(good);
const second = page.locator("button.capture").nth(1);
await second.waitFor({ timeout: 60_000 });
const name = await second.locator("strong").textContent();
assert.equal(name, basename(good));
await done(page, "captures", () => page.locator("button.capture[aria-pressed=false]").or(second).first().click());
await page.getByRole("button", { name: `close ${basename(good)}` }).click();
await second.waitFor({ state: "detached" });
assert.equal((await stateOf(page)).captures.length, 1);
await done(page, "undo", () => page.keyboard.press("Control+z"));
await second.waitFor(); // going back finds it
assert.equal(await page.locator("#captures img, #captures script, main img[src]").count(), 0);
assert.equal(await page.title(), "knobcam workbench");
assert.ok(await page.locator("#welcome").isHidden());

for (const option of ["own parts", "95 % band"]) await done(page, "data", () => page.getByLabel(option).check());
await page.screenshot({ path: join(folder, "10-isolated.png") });
await accessible(page, "two captures");

const plot = page.getByRole("img", { name: "residual over time", exact: true });
await plot.focus();
await done(page, "brush", () => page.keyboard.press("ArrowRight"));
const byKeys = await page.locator("#chosen").textContent();
assert.match(byKeys, /of the squared error/);
await page.keyboard.press("Escape");

await page.getByRole("button", { name: "light or dark" }).click();
assert.equal(await page.locator("html").getAttribute("data-theme"), "dark");
await browser.close();
console.log(JSON.stringify({ refused, mapped, name, byKeys, failures: complaints.length }));
