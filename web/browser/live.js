/**
 * A capture made in the page: `node live.js CHROMIUM ADDRESS EFFECT LOGS FOLDER`.
 *
 * The workbench at ADDRESS has nothing open. An emulated rig that hides EFFECT is recorded from in real time, its
 * wire logs kept in LOGS; pictures go to FOLDER, and what was seen is printed as JSON.
 */

import assert from "node:assert/strict";
import { join } from "node:path";

import { accessible } from "./axe.js";
import { opened, painted, stateOf } from "./session.js";

const HOSTILE = "<img src=x onerror=\"document.title='hit'\">";
const [chrome, address, effect, logs, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
const picture = (name) => page.screenshot({ path: join(folder, `${name}.png`) });
const dialog = page.getByRole("dialog", { name: "New capture" });
const control = (name) => dialog.locator(`[name=${name}]`);
const from = (source) => dialog.locator(`[name=source][value=${source}]`);
const shown = () => page.evaluate(() => window.knobcam.app.live.columns.t?.length ?? 0);
const told = () => page.evaluate(() => window.knobcam.app.live.told);

await page.locator("#welcome").waitFor();
await picture("11-nothing-open");
await page.keyboard.press("Tab");
await page.getByRole("button", { name: "Make a capture…" }).press("Enter");
await dialog.waitFor();
await page.waitForFunction(() => document.querySelector("#new-form [name=knob]").options.length > 0);
await picture("12-new-capture");
await from("emulated").check();
await control("hides").selectOption("chosen");
await dialog.locator(`[name=effects][value=${effect}]`).check();
await control("folder").fill(logs);

await control("duration_s").fill("-3");
await dialog.getByRole("button", { name: "Record" }).click();
const refused = dialog.locator("#new-said");
await page.waitForFunction(() => document.getElementById("new-said").textContent !== "");
const wrong = await refused.textContent();
await picture("13-wrong-value");
await accessible(page, "new capture");
await control("duration_s").fill("6");
const clicked = Date.now();
await dialog.getByRole("button", { name: "Record" }).click();

await page.locator("#live").waitFor();
const grown = [];
for (let look = 0; look < 12; look++) {
  await page.waitForTimeout(250);
  grown.push([(await told()).done, await shown()]);
  if (look === 6) await picture("14-recording");
}
await page.locator("#live").waitFor({ state: "hidden", timeout: 60_000 });
await painted(page, "data");
const captured = Date.now() - clicked;
const first = await told();
const updates = await page.evaluate(() => window.knobcam.times.filter(({ what }) => what === "live"));
await picture("15-recorded");

const candidates = page.locator(".candidate");
await candidates.first().waitFor({ timeout: 90_000 });
const top = await candidates.first().getAttribute("data-effect");
await page.getByRole("button", { name: "What was hidden?" }).click();
await page.waitForFunction(() => document.getElementById("unhidden").textContent !== "");
const hidden = await page.locator("#unhidden").textContent();
await picture("16-candidates");

await page.emulateMedia({ colorScheme: "dark" });
await page.route("**/api/sources*", async (route) => {
  const answer = await route.fetch();
  const ports = [{ port: HOSTILE, words: HOSTILE }];
  await route.fulfill({ response: answer, json: { ...(await answer.json()), ports } });
});
await page.getByRole("button", { name: "New capture…" }).click();
await from("port").check();
// The ports of the machine stand there until the answer above has come.
await dialog.locator("#new-found").filter({ hasText: HOSTILE }).waitFor();
assert.equal(await dialog.locator("#new-found").textContent(), `${HOSTILE} (${HOSTILE})`);
assert.ok(await dialog.locator("#new-warning").isVisible());
await picture("17-port-dark");
await control("port").fill(HOSTILE);
await dialog.getByRole("button", { name: "Record" }).click();
await page.waitForFunction(() => document.getElementById("new-said").textContent.includes("no such port"));
await from("emulated").check();
await control("duration_s").fill("60");
await control("motion").selectOption("multisine");
await dialog.getByRole("button", { name: "Record" }).click();
await page.locator("#live").waitFor();
await page.waitForFunction(() => (window.knobcam.app.live.told?.elapsed_s ?? 0) > 3);
await picture("18-recording-dark");

await page.route("**/api/live*", async (route) => {
  const answer = await route.fetch();
  await route.fulfill({ response: answer, body: broken(await answer.body()) });
});
// What a broken answer says stands there until the next answer comes.
await page.waitForFunction((text) => document.getElementById("live-said").textContent === text, HOSTILE);
await page.getByRole("button", { name: "Open what was kept" }).waitFor();
await picture("20-broken-dark");
await accessible(page, "recording");
await page.unroute("**/api/live*");
await page.reload();
await page.locator("#live").waitFor();
await page.waitForFunction(() => (window.knobcam.app.live.told?.elapsed_s ?? 0) > 4);
await page.keyboard.press("Escape");
await page.locator("#live").waitFor({ state: "hidden", timeout: 60_000 });
await page.locator("button.capture").nth(1).waitFor();
const stopped = await told();

await page.getByRole("button", { name: "New capture…" }).click();
await from("simulated").check();
await control("duration_s").fill("4");
await control("hides").selectOption("surprise");
await dialog.getByRole("button", { name: "Simulate" }).click();
await page.locator("button.capture").nth(2).waitFor();
const state = await stateOf(page);
await picture("19-simulated-dark");
assert.equal(await page.locator("img, dialog script").count(), 0);
assert.equal(await page.title(), "knobcam workbench");
assert.deepEqual(complaints.filter((one) => !/api\/record|400 \(Bad Request\)/.test(one)), []);
await browser.close();
const scripts = updates.map(({ script }) => script).sort((a, b) => a - b);
console.log(
  JSON.stringify({
    ...{ wrong, grown, top, hidden, captured, first, stopped },
    captures: state.captures.map(({ name, samples }) => ({ name, samples })),
    updates: { count: updates.length, median: scripts[scripts.length >> 1], longest: scripts.at(-1) },
  }),
);

/**
 * The answer of a recording whose rig has gone.
 * @param {Buffer} body
 */
function broken(body) {
  const end = body.indexOf(10);
  const head = JSON.parse(body.subarray(0, end).toString());
  Object.assign(head.live, { ended: true, error: HOSTILE });
  const line = `${JSON.stringify(head)}\n`;
  return Buffer.concat([Buffer.from(line.padEnd(Math.ceil(line.length / 4) * 4, "\0")), body.subarray(4 * Math.ceil((end + 1) / 4))]);
}
