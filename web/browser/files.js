/**
 * Files handed over in the browser: `node files.js CHROMIUM ADDRESS GOOD BROKEN FOLDER`.
 *
 * The workbench at ADDRESS has nothing open. GOOD is a capture whose name would be markup, BROKEN is none.
 */

import assert from "node:assert/strict";
import { basename, join } from "node:path";

import { done, opened, painted, stateOf } from "./session.js";

const [chrome, address, good, broken, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
await page.locator("#welcome").waitFor();
await page.screenshot({ path: join(folder, "8-welcome.png") });

await page.getByRole("button", { name: "Open…" }).click();
await page.screenshot({ path: join(folder, "9-open.png") });
await page.locator("#open-file").setInputFiles(broken);
await page.locator("#said.wrong").waitFor();
const refused = await page.locator("#said").textContent();
assert.equal((await stateOf(page)).captures.length, 0);

await page.locator("#open-file").setInputFiles(good);
await painted(page, "data");
const name = await page.locator(".capture strong").textContent();
assert.equal(name, basename(good));
assert.equal(await page.locator("#captures img, #captures script, main img[src]").count(), 0);
assert.equal(await page.title(), "knobcam workbench");
assert.ok(await page.locator("#welcome").isHidden());

for (const option of ["isolated parts", "95 % band"]) await done(page, "data", () => page.getByLabel(option).check());
await page.screenshot({ path: join(folder, "10-isolated.png") });

const plot = page.getByRole("img", { name: "residual over time", exact: true });
await plot.focus();
await done(page, "brush", () => page.keyboard.press("ArrowRight"));
const byKeys = await page.locator("#chosen").textContent();
assert.match(byKeys, /of the squared error/);
await page.keyboard.press("Escape");

await page.getByRole("button", { name: "light or dark" }).click();
assert.equal(await page.locator("html").getAttribute("data-theme"), "dark");
await browser.close();
console.log(JSON.stringify({ refused, name, byKeys, failures: complaints.length }));
