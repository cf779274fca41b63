/**
 * Samples that are left out in a browser: `node leaving.js CHROMIUM ADDRESS CAPTURE FOLDER`.
 *
 * The workbench at ADDRESS has a capture open in which something spoilt the torque from 1 to 1.5 s. CAPTURE has as many
 * samples, of another knob. Pictures go to FOLDER.
 */

import assert from "node:assert/strict";
import { join } from "node:path";

import { accessible } from "./axe.js";
import { brushed, done, opened, painted, stateOf } from "./session.js";

const [chrome, address, capture, folder] = process.argv.slice(2);
const { browser, page, complaints } = await opened(chrome, address);
page.setDefaultTimeout(60_000);
await painted(page, "first picture");
const button = page.locator("#leave-out");
const before = await stateOf(page);
assert.ok(await button.isHidden());
// Over velocity no sample is drawn to which nothing is fitted, and none of them sets the axis.
const grey = await page.evaluate(() => {
  const { linked } = globalThis.knobcam.app;
  const { residual } = linked.data.columns;
  const { series, picked, x, xAxis } = linked.torques[1].contents;
  const counted = [...x].filter((_, i) => residual[i] === residual[i]);
  return {
    drawn: series[picked].y.some((value, i) => value === value && residual[i] !== residual[i]),
    wide: (xAxis.high - xAxis.low) / (Math.max(...counted) - Math.min(...counted)),
  };
});
assert.ok(!grey.drawn && grey.wide < 1.05, JSON.stringify(grey));
assert.match(await page.locator("#measured").getAttribute("title"), /torque below \d+ Hz: a filter takes off what is faster/);
assert.match(await page.evaluate(() => globalThis.knobcam.app.linked.torques[1].contents.yAxis.label), /^torque below \d+ Hz, mNm/);

await brushed(page, "residual over time", [0.3, 0.1], [0.46, 0.9]);
await button.filter({ hasText: /^Leave out [01]\.\d* to 1\.\d+ s$/ }).waitFor(); // it counts once the brush rests
await page.screenshot({ path: join(folder, "41-to-be-left-out.png") });
await done(page, "data", () => button.click());
await button.waitFor({ state: "hidden" });
const after = await stateOf(page);
assert.ok(after.rmse < 0.5 * before.rmse, `${before.rmse} ${after.rmse}`);
assert.ok(after.captures[0].findings.some(({ key, seen }) => key === "left_out:t" && seen));
await page.locator("#masked:visible").waitFor();
await page.waitForFunction(() => globalThis.knobcam.app.state.candidates.ready);
await accessible(page, "samples left out");
await page.screenshot({ path: join(folder, "42-left-out.png") });
await page.getByRole("button", { name: "Undo" }).click();
await page.waitForFunction((node) => globalThis.knobcam.app.state.node === node, before.node);

// The scale that is kept is that of these captures; the next one has its own.
const reach = () => page.evaluate(() => globalThis.knobcam.app.linked.residuals[1].contents.yAxis.high);
const wide = await reach();
await page.getByRole("button", { name: "Open…" }).click();
await page.fill("#open-path", capture);
await done(page, "data", () => page.getByRole("button", { name: "Open", exact: true }).click());
const narrow = await reach();
assert.ok(narrow < 0.3 * wide, `${wide} ${narrow}`);

// Several captures take a line of a narrow screen: all plots are on it nevertheless.
await page.setViewportSize({ width: 800, height: 900 });
const bottoms = await page.evaluate(() =>
  [document.getElementById("plots"), ...[...document.querySelectorAll("#plots .plot")].filter((one) => one.checkVisibility())].map((one) => one.getBoundingClientRect().bottom));
assert.equal(bottoms.length, 7);
assert.ok(Math.max(...bottoms) <= bottoms[0] + 1, `a plot is cut off: ${bottoms}`);
assert.deepEqual(complaints, []);
await browser.close();
console.log(JSON.stringify({ rmse: [before.rmse, after.rmse] }));
