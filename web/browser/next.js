/**
 * The next experiment in a browser: `node next.js CHROMIUM ADDRESS EFFECT FOLDER`.
 *
 * The workbench at ADDRESS has a simulated capture of a knob that hides EFFECT, which the capture cannot tell from
 * another one. Pictures and the motion file go to FOLDER; what was seen is printed as JSON.
 */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { accessible } from "./axe.js";
import { opened, painted, stateOf } from "./session.js";

const [chrome, address, effect, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
page.setDefaultTimeout(120_000);
await page.setViewportSize({ width: 1440, height: 900 });
const picture = (name) => page.screenshot({ path: join(folder, `${name}.png`) });
// Alone, as it is the same whatever is weighed meanwhile.
const itself = (name) => page.locator("#next").screenshot({ path: join(folder, `${name}.png`) });
const button = (name) => page.getByRole("button", { name, exact: true });
const experiment = async () => (await stateOf(page)).experiment;
const nothingSticksOut = () => page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth);

await button("New capture…").click();
const dialog = page.getByRole("dialog", { name: "New capture" });
await dialog.locator("[name=knob]").selectOption("knob4");
await dialog.locator("[name=hides]").selectOption("chosen");
await dialog.locator(`[name=effects][value=${effect}]`).check();
await dialog.locator("[name=motion]").selectOption("hand");
await dialog.locator("[name=duration_s]").fill("3");
await dialog.getByRole("button", { name: "Simulate" }).click();
await painted(page, "data");
const apart = page.locator(`[data-effect=${effect}]`).getByRole("button", { name: /^Tell apart…/ });
await apart.waitFor({ timeout: 90_000 });
await picture("21-cannot-be-told");

// Its limits are beside it, before there is a motion.
const limited = page.locator(`[data-effect=${effect}]`).getByRole("button", { name: /^Limits…/ });
await limited.click();
assert.match(await page.locator("#next-headline").textContent(), /^For a motion that tells apart return spring and unbalance\.$/);
assert.equal(await page.locator("#next-again").textContent(), "Design");
await itself("21-limits");
await page.getByText("Within which limits").click();
await page.locator("#next-close").click();

// Given up: nothing is shown, nothing has changed.
// In the page itself, as it takes less than a second.
await page.evaluate(() => {
  const cancel = document.getElementById("cancel");
  new MutationObserver((_, seeing) => {
    if (!cancel.checkVisibility()) return;
    seeing.disconnect();
    cancel.click();
  }).observe(document.body, { attributes: true, childList: true, subtree: true });
});
await apart.click();
await page.waitForFunction(() => /cancelled/.test(document.getElementById("said").textContent));
assert.equal(await experiment(), null);
assert.ok(await page.locator("#next").isHidden());

await apart.click();
const shares = [];
while (await page.locator("#next").isHidden()) {
  shares.push(await page.locator("#job-done").evaluate((bar) => bar.value));
  await page.waitForTimeout(50);
}
await painted(page, "experiment");
const first = await experiment();
await picture("22-next");
await itself("22-itself");
await accessible(page, "the next experiment");

// Wider limits are asked for.
await page.getByText("Within which limits").click();
await page.locator("[name=theta_min_rad]").fill("-1.6");
await page.locator("[name=theta_max_rad]").fill("1.6");
await button("Design again").scrollIntoViewIfNeeded();
await button("Design again").click();
await page.waitForFunction((id) => window.knobcam.app.state.experiment.id !== id, first.id, { timeout: 90_000 });
await page.getByText("Within which limits").click();
const second = await experiment();
await picture("23-next-wider");

// Limits within which there is no motion stay in sight, with the one that would do.
const torque = page.locator("#next-limits [name=torque_Nm]");
await page.getByText("Within which limits").click();
await torque.fill("1.2");
await button("Design again").click();
await page.locator("#next-refused", { hasText: "“torque, mNm”" }).waitFor({ timeout: 90_000 });
const enough = await page.locator("#next-enough").textContent();
assert.equal((await experiment()).id, second.id);
await accessible(page, "limits that are too narrow");
await itself("23-too-narrow");
await torque.fill("");
await page.getByText("Within which limits").click();

const saving = page.waitForEvent("download");
await button("Motion file").click();
const file = join(folder, "motion.toml");
await (await saving).saveAs(file);
assert.match(readFileSync(file, "utf8"), /^schema = "knobcam.motion\/1"/);

// A hand is led, through a motion that it can make: the mark moves with the clock, and stands where the motion is.
await button("By hand…").click();
await page.locator("#lead").waitFor({ timeout: 90_000 });
const third = await experiment();
assert.ok(third.by_hand && (second.by_hand || third.id !== second.id));
await picture("24-metronome");
await accessible(page, "metronome");
await page.getByLabel("click at each beat").check();
await button("Start").click();
// Between two seconds: at the full one either number may stand there.
await page.waitForTimeout(1500);
const counted = await page.locator("#lead-left").textContent();
await page.waitForTimeout(4500);
const left = [parseFloat(await page.locator("#lead-left").textContent())];
await picture("25-led");
await page.waitForTimeout(1000);
left.push(parseFloat(await page.locator("#lead-left").textContent()));
const clicks = await page.evaluate(() => window.knobcam.app.next.metronome.next);
await button("Stop").click();
await page.locator("#lead").getByRole("button", { name: "Close" }).click();

// A rig elsewhere is asked for by its port, and what is wrong is said there.
await button("Record from a rig…").click();
await page.getByRole("dialog", { name: "Record from a rig" }).locator("[name=port]").fill("/dev/no_such_rig");
await picture("26-from-a-rig");
await page.getByRole("dialog", { name: "Record from a rig" }).getByRole("button", { name: "Record" }).click();
const refused = page.locator("#rig-said", { hasText: "no such port" });
await refused.waitFor().catch(async (reason) => {
  const said = await Promise.all(["#rig-said", "#said", "#live-said", "#job"].map((id) => page.locator(id).textContent()));
  throw new Error(`instead of a refusal: ${JSON.stringify([said, complaints])}`, { cause: reason });
});
await page.getByRole("dialog", { name: "Record from a rig" }).getByRole("button", { name: "Close" }).click();

await button("Record it").click();
await page.waitForFunction(() => window.knobcam.app.state.experiment?.verdict, null, { timeout: 90_000 });
await page.waitForFunction(() => window.knobcam.app.state.captures.length === 2);
await page.waitForTimeout(500);
const told = await experiment();
await picture("27-told");
for (const [name, scheme, width] of [["28-told-dark", "dark", 1440], ["29-told-narrow", "light", 800], ["30-told-narrow-dark", "dark", 800]]) {
  await page.emulateMedia({ colorScheme: scheme });
  await page.setViewportSize({ width, height: 900 });
  await page.waitForTimeout(300);
  await picture(name);
  if (name === "28-told-dark") await itself("28-itself-dark");
  assert.ok(await nothingSticksOut(), `something sticks out at ${width}`);
}
await button("By hand…").click();
await picture("31-metronome-narrow-dark");
await page.keyboard.press("Escape"); // closes the uppermost
assert.equal(await page.locator("#lead").isVisible(), false);
await page.emulateMedia({ colorScheme: "light" });
page.setDefaultTimeout(120_000);
await page.setViewportSize({ width: 1440, height: 900 });
await page.locator("#next").getByRole("button", { name: "Close" }).click();
await page.waitForTimeout(300);
const words = await page.locator("#next-said").textContent();
await picture("32-after");
await button("Next experiment…").click();
await page.locator("#next").waitFor();

assert.deepEqual(complaints.filter((one) => !/api\/(design|try)|400 \(Bad Request\)/.test(one)), []);
const state = await stateOf(page);
await browser.close();
console.log(
  JSON.stringify({
    ...{ enough, shares, first, second, third, counted, left, clicks, told, words },
    effects: [...new Set(state.params.map(({ name }) => name.split(".")[0]))],
    captures: state.captures.map(({ name, samples }) => ({ name, samples })),
  }),
);
