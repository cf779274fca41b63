/**
 * What goes wrong around a page: `node faults.js CHROMIUM ADDRESS CAPTURE LARGE PIPE PID FOLDER`.
 *
 * The workbench at ADDRESS, process PID, has a CAPTURE open in which samples are masked. LARGE is more than a browser may
 * hand over, PIPE gives nothing for ever. A picture of an overruled finding goes to FOLDER.
 */

import assert from "node:assert/strict";
import { join } from "node:path";

import { accessible } from "./axe.js";
import { done, opened, painted, stateOf } from "./session.js";

const [chrome, address, capture, large, pipe, pid, folder] = process.argv.slice(2);
const { browser, page } = await opened(chrome, address);
await painted(page, "first picture");
const said = page.locator("#open-said");

await page.getByRole("button", { name: "Open…" }).click();
await page.locator("#open-file").setInputFiles(large);
await page.getByText(/more than 200 MB; .* open it by its path/).waitFor();
const waits = {};
for (const path of [pipe, "/dev/zero"]) {
  const start = performance.now();
  await page.fill("#open-path", path);
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.waitForFunction((path) => document.querySelector("#open-said").textContent.startsWith(path), path);
  assert.match(await said.textContent(), /is a (pipe|device), not a file/);
  waits[path] = performance.now() - start;
}
await page.keyboard.press("Escape");

// A finding is seen at its samples, and overruled; the model follows, and the switch keeps the focus.
const before = await stateOf(page);
await page.locator(".finding .leads", { hasText: "torque" }).click();
await page.getByText(/^1 sample chosen, .*: nothing is fitted to them$/).waitFor();
assert.equal(await page.evaluate(() => globalThis.knobcam.app.linked.chosen.length), 1);
await page.keyboard.press("Escape");
const box = page.getByRole("switch", { name: /^applied: .*torque/ });
await box.focus();
await done(page, "data", () => page.keyboard.press("Space"));
await page.getByText("overruled", { exact: true }).waitFor();
const after = await stateOf(page);
assert.ok(after.rmse > before.rmse && after.captures.length === 1);
assert.ok(await box.evaluate((one) => one === document.activeElement && !one.checked));
await accessible(page, "a finding overruled");
await page.waitForFunction(() => globalThis.knobcam.app.state.candidates.ready, null, { timeout: 60_000 });
await page.locator("#job").waitFor({ state: "hidden" });
await page.screenshot({ path: join(folder, "20-overruled.png") });

// Two pages look at one session: what one does, the other shows; and a page that is loaded anew is where it was.
const other = await browser.newPage();
await other.goto(address);
await painted(other, "first picture");
await done(page, "undo", () => page.keyboard.press("Control+z"));
await other.waitForFunction((node) => globalThis.knobcam.app.state.node === node, before.node);
await done(other, "redo", () => other.keyboard.press("Control+Shift+z"));
await page.waitForFunction((node) => globalThis.knobcam.app.state.node === node, after.node);
await page.reload();
await painted(page, "first picture");
assert.equal((await stateOf(page)).node, after.node);
assert.ok(await page.locator("#lost").isHidden());

process.kill(Number(pid), "SIGKILL");
await page.locator("#lost:visible").waitFor();
await page.getByRole("button", { name: "Undo" }).click();
await page.locator("#said.wrong", { hasText: "does not answer" }).waitFor();
assert.ok(await page.locator(".plot:visible").count(), "what was seen stays to be looked at");
await browser.close();
console.log(JSON.stringify({ waits, capture: before.captures[0].name, rmse: [before.rmse, after.rmse] }));
