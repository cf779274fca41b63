/**
 * A session that goes on: `node going.js CHROMIUM ADDRESS FOLDER MODE`.
 *
 * MODE `leave`: brushes, draws own parts and ends without a word. MODE `continue`: takes the offer of the page and
 * tells what is brushed then. Pictures go to FOLDER; what was seen is printed as JSON.
 */

import assert from "node:assert/strict";
import { join } from "node:path";

import { brushed, done, opened, painted, stateOf } from "./session.js";

const [chrome, address, folder, mode] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
const picture = (name) => page.screenshot({ path: join(folder, `${name}.png`) });

if (mode === "leave") {
  await painted(page, "first picture");
  await brushed(page, "residual over velocity", [0.3, 0.2], [0.6, 0.8]);
  const kept = page.waitForResponse((answer) => /"isolated":true/.test(answer.request().postData() ?? ""));
  await done(page, "data", () => page.locator("#isolated").check());
  await kept;
} else {
  await page.locator("#left-behind").waitFor();
  await picture("20-a-session-that-was-left");
  await page.getByRole("button", { name: "Continue" }).first().click();
  await painted(page, "data");
  await painted(page, "brush");
  await picture("21-it-goes-on");
}
const seen = await page.evaluate(() => ({
  brush: window.knobcam.app.linked.brushed,
  isolated: document.getElementById("isolated").checked,
  chosen: document.getElementById("chosen").textContent,
}));
const { captures } = await stateOf(page);
assert.deepEqual(complaints, []);
console.log(JSON.stringify({ ...seen, captures: captures.map(({ name }) => name) }));
await browser.close();
