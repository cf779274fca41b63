/**
 * The whole story in a browser: `node story.js CHROMIUM ADDRESS EFFECT FOLDER`.
 *
 * The page at ADDRESS has a capture of a knob that hides EFFECT. Pictures and the saved report go to FOLDER;
 * the RMS errors before, with the effect and with another, and how long the deeds took, are printed as JSON.
 */

import assert from "node:assert/strict";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { accessible } from "./axe.js";
import { brushed, done, opened, painted, stateOf } from "./session.js";

const [chrome, address, effect, folder] = process.argv.slice(2);
const { browser, page, complaints, requests } = await opened(chrome, address);
page.setDefaultTimeout(120_000);
const picture = (name) => page.screenshot({ path: join(folder, `${name}.png`) });
const figures = {};

figures.first = await painted(page, "first picture");
const first = await stateOf(page);
await picture("1-opened");

figures.brush = await brushed(page, "residual over velocity", [0.47, 0.12], [0.62, 0.85]);
const told = await page.locator("#chosen").textContent();
assert.match(told, /samples chosen, .* of the squared error/);
await picture("2-brushed");

const candidates = page.locator(".candidate");
await candidates.or(page.getByRole("button", { name: "What is missing?" })).first().waitFor({ timeout: 60_000 });
if ((await candidates.count()) === 0) await page.getByRole("button", { name: "What is missing?" }).click();
await candidates.first().waitFor({ timeout: 60_000 });
assert.equal(await candidates.first().getAttribute("data-effect"), effect);

await page.getByRole("button", { name: "Clear" }).click();
const lead = page.locator("#verdict .leads.place");
const [low] = /-?[\d.]+/.exec((await lead.textContent()).replaceAll("−", "-")) ?? [];
await lead.click();
await page.locator(".brush:visible").waitFor();
assert.match(await page.locator("#chosen").textContent(), /samples chosen, .* of the squared error/);
const marked = await page.evaluate(() => globalThis.knobcam.app.linked.brushed);
assert.ok(Math.abs(marked.x[0] - Number(low)) < 1e-3 * (1 + Math.abs(marked.x[0])), `${marked.x} is not from ${low} on`);
// Its other words lead too: to the effect that they name, which is laid over the residuals, and to the ladder.
const { [effect]: title } = (await stateOf(page)).titles;
await page.locator("#verdict .leads", { hasText: new RegExp(`^${title}$`) }).last().click();
assert.equal(await page.evaluate(() => document.activeElement.dataset.effect), effect);
await page.locator("#looked:visible").waitFor();
await page.locator("#verdict .leads", { hasText: "RMS error" }).click();
await page.locator("#ladder.shown").waitFor();
// A motion waits for what is missing; the limits of the rig are there before, and kept for it.
await page.getByRole("button", { name: "Limits…", exact: true }).click();
assert.match(await page.locator("#next-headline").textContent(), /once what is missing is in the model/);
await page.locator("#next-limits [name=torque_Nm]").fill("0.01");
await picture("2-limits");
await page.getByRole("button", { name: "Keep", exact: true }).click();
await page.locator("#next").waitFor({ state: "hidden" });
await page.getByRole("button", { name: "Limits…", exact: true }).click();
assert.equal(await page.locator("#next-limits [name=torque_Nm]").inputValue(), "0.01");
await page.locator("#next-limits [name=torque_Nm]").fill("");
await page.keyboard.press("Enter");
await page.locator("#next").waitFor({ state: "hidden" });
/** Draw the last row over another axis. */
async function drawnOver(axis) {
  await page.getByLabel("axis of row 3").selectOption(axis);
  await page.waitForFunction((axis) => globalThis.knobcam.app.linked.axes[2] === axis, axis);
}
for (const axis of ["acceleration", "load", "history"]) {
  await drawnOver(axis);
  const over = page.getByRole("img", { name: /^residual over (acceleration|modelled torque|distance since)/ });
  assert.equal(await over.filter({ visible: true }).count(), 1);
}
await picture("2-led-by-the-verdict");
await drawnOver("frequency");
// What is drawn over frequency comes with the bins, which may come after the samples.
const shown = await page.waitForFunction(() => globalThis.knobcam.app.linked.residuals[2].contents?.spectrum);
const spectrum = await shown.jsonValue();
assert.ok(spectrum.x.length > 100 && spectrum.chance.every(Number.isFinite));
await picture("2-over-frequency");
await drawnOver("time");
const plot = page.getByRole("img", { name: "residual over time", exact: true });
await plot.focus();
for (let press = 0; press < 20; press++) await page.keyboard.press(".");
assert.match(await page.locator("#moment-words").textContent(), /^[\d.]+ s, .* rad, .* measured, .* modelled, .* mNm left$/);
assert.equal(await page.locator(".plot .moment:visible").count(), 6, "one moment in every plot");

// 720 x 450: a screen of 1440 x 900 at 200 %.
for (const [width, height] of [[720, 450], [700, 950], [800, 950], [1120, 800], [1280, 950], [1366, 768], [1440, 900], [1920, 950]]) {
  await page.setViewportSize({ width, height });
  for (const seen of ["#ladder .track", ".candidate .label", ".plot[aria-label='residual over position']"]) {
    const box = await page.locator(seen).first().boundingBox();
    const inside = box && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= height;
    assert.ok(inside, `${seen} is not on a screen of ${width} x ${height}: ${JSON.stringify(box)}`);
  }
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), `${width} px`);
  const inside = await page.evaluate(() => document.querySelector("aside").scrollWidth <= document.querySelector("aside").clientWidth);
  assert.ok(inside, `the parameters are cut off at ${width} px`);
  const cut = await page.evaluate(() => {
    const chosen = document.getElementById("chosen");
    const bottoms = [...document.querySelectorAll("#plots .plot")].filter((one) => one.checkVisibility()).map((one) => one.getBoundingClientRect().bottom);
    return [chosen.scrollHeight - chosen.clientHeight, Math.max(...bottoms) - document.getElementById("plots").getBoundingClientRect().bottom];
  });
  assert.ok(cut[0] <= 2, `what is chosen is cut off at ${width} x ${height}`);
  assert.ok(height < 700 || cut[1] <= 2, `a plot is cut off at ${width} x ${height}`);
  await page.locator("h1").hover();
  if (width === 700 || width === 720 || width === 1920) await picture(`3-at-${width}`);
  const plots = await page.locator("#plots").boundingBox();
  await candidates.first().hover();
  await page.locator("#looked:visible").waitFor();
  assert.deepEqual(await page.locator("#plots").boundingBox(), plots, `the plots move at ${width} px`);
}
await page.setViewportSize({ width: 800, height: 950 });
await accessible(page, "narrow");
await page.setViewportSize({ width: 1500, height: 950 });
const folds = page.locator(".candidates ~ details");
assert.match(await folds.nth(0).locator("summary").textContent(), /^\d ruled out by values that none can have: .*friction over position \(−3\d\s%\)/);
for (const [at, doubt] of [[0, true], [1, false]]) {
  await folds.nth(at).locator("summary").click();
  const why = folds.nth(at).locator(".candidate").first().locator(".doubt");
  assert.equal((await why.count()) > 0, doubt);
  await accessible(page, at === 0 ? "what is ruled out" : "what is no better than chance");
  await folds.nth(at).locator("summary").click();
}
await page.locator("h1").hover();
figures.look = await done(page, "look", () => candidates.first().hover());
await picture("3-looked-at");
await page.emulateMedia({ colorScheme: "dark" });
// The plots take the new colours with the next frame.
await page.evaluate(() => new Promise((seen) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(seen)))));
await picture("3-dark");
await page.emulateMedia({ colorScheme: "light" });
await candidates.first().focus();
await page.route("**/api/picture*", async (route) => {
  await page.locator("#about[open] .formula math").waitFor(); // what is known is not waited for
  assert.match(await page.getByLabel("letters of the law").textContent(), /r rise towards rest, a share of the dry friction.*Stribeck speed, rad\/s/);
  await accessible(page, "about");
  const moment = page.getByLabel("moment", { exact: true });
  const start = Number(await moment.inputValue());
  await page.waitForFunction((start) => Number(document.querySelector("#about input").value) > start, start); // it moves
  await page.getByText(/s: adds -?−?[\d.e−]+ mNm/).waitFor();
  await route.continue();
});
await page.emulateMedia({ reducedMotion: "no-preference" });
await page.keyboard.press("?");
await page.waitForFunction(() => document.querySelector("#about img")?.naturalWidth > 500);
const moment = page.getByLabel("moment", { exact: true });
await moment.fill(String(Math.round(0.6 * Number(await moment.getAttribute("max"))))); // by hand it stands still
await page.getByRole("button", { name: "Play" }).waitFor();
const close = await page.locator("#about-close").boundingBox();
assert.ok(close.y + close.height < page.viewportSize().height, "the way out is in sight");
await picture("3-about");
await page.emulateMedia({ reducedMotion: "reduce" });
await page.getByRole("button", { name: "Close" }).click();

await page.locator("#save summary").click();
await page.getByRole("button", { name: "Report" }).waitFor();
await accessible(page, "menu");
await page.keyboard.press("Escape");
assert.equal(await page.locator("#save[open]").count(), 0, "Escape closes the menu");
assert.ok(await page.locator(".brush:visible").count(), "and nothing else");

await page.keyboard.press("Escape");
assert.equal(await page.locator(".brush:visible").count(), 0);
await candidates.first().focus();
figures.add = await done(page, "add", () => page.keyboard.press("Enter"));
const second = await stateOf(page);
assert.ok(second.rmse < 0.9 * first.rmse, `the error fell from ${first.rmse} to ${second.rmse} only`);
assert.ok(second.rmse < 1.1 * second.noise_floor, `${second.rmse} is not at the floor ${second.noise_floor}`);
await picture("4-added");
await page.keyboard.press("Enter"); // pressed twice: nothing more is added
await page.keyboard.press("Space");
await page.locator("#any button[type=submit]").focus();
await page.keyboard.press("Enter");
await page.locator("#candidates").focus();
await candidates.first().waitFor({ timeout: 60_000, state: "attached" });
assert.equal((await stateOf(page)).revision >= second.revision, true);
assert.deepEqual((await stateOf(page)).ladder, second.ladder);
assert.ok(await page.evaluate(() => document.activeElement?.id === "candidates"));
await page.keyboard.press("ArrowDown");
assert.ok(await candidates.first().evaluate((item) => item === document.activeElement));

figures.undo = await done(page, "undo", () => page.keyboard.press("Control+z"));
assert.deepEqual((await stateOf(page)).params, first.params);
figures.redo = await done(page, "redo", () => page.keyboard.press("Control+Shift+z"));
assert.deepEqual((await stateOf(page)).params, second.params);
await done(page, "undo", () => page.keyboard.press("Control+z"));
// The verdict's own words do the same; all torques of the page are in one unit.
await page.locator("#verdict .leads", { hasText: "Add it" }).waitFor({ timeout: 60_000 });
const units = await page.evaluate(() => {
  const rows = globalThis.knobcam.app.linked.residuals.map(({ contents }) => contents.yAxis.label);
  return [...rows, document.querySelector("#ladder .head").textContent, document.querySelector("#verdict").textContent];
});
assert.ok(units.every((words) => words.includes("mNm") && !/\sN\sm\b/.test(words)), units.join(" | "));
await done(page, "add", () => page.locator("#verdict .leads", { hasText: "Add it" }).click());
assert.deepEqual((await stateOf(page)).params, second.params);
await page.locator(".params .meaning", { hasText: "moment of inertia" }).waitFor({ state: "attached" });
await done(page, "undo", () => page.keyboard.press("Control+z"));

await page.getByRole("button", { name: "New branch" }).click();
await page.locator(".branch").nth(1).waitFor();
await candidates.nth(1).waitFor({ timeout: 60_000 });
const other = await candidates.nth(1).getAttribute("data-effect");
figures.other = await done(page, "add", () => candidates.nth(1).getByRole("button", { name: "add" }).click());
const third = await stateOf(page);
assert.equal(third.branches.length, 2);
const current = third.branches.find(({ id }) => id === third.branch);
assert.equal(current.steps[current.at].added, other);

figures.beside = await done(page, "beside", () => page.getByRole("checkbox", { name: "side by side" }).check());
assert.equal(await page.locator(".plot:visible").count(), 9);
await brushed(page, "residual over velocity of the branch beside", [0.47, 0.12], [0.62, 0.85]);
assert.match(await page.locator("#chosen").textContent(), /of the squared error.*; in main: RMS/);
await picture("5-side-by-side");
await accessible(page, "side by side");
await page.keyboard.press("Escape");
await page.getByRole("checkbox", { name: "side by side" }).uncheck();

await brushed(page, "residual over time", [0.3, 0.2], [0.5, 0.8]);
figures.closer = await done(page, "zoom", () => page.keyboard.press("z"));
const seen = await page.evaluate(() => window.knobcam.app.linked.residuals[2].frame.x);
assert.ok(seen[1] - seen[0] < 0.4 * third.captures[0].samples / third.captures[0].rate_hz);
await picture("6-zoomed");
await page.getByRole("img", { name: "residual over time", exact: true }).hover();
figures.wheel = await done(page, "zoom", () => page.mouse.wheel(0, -300));
await done(page, "zoom", () => page.getByRole("button", { name: "Zoom" }).click());
await page.keyboard.press("Escape");

const slider = page.locator(".params input").first();
await slider.focus();
figures.drag = await done(page, "drag", () => page.keyboard.press("ArrowRight"));
assert.ok((await stateOf(page)).rmse >= third.rmse);
figures.snap = await done(page, "snap", () => page.getByRole("button", { name: "Back to the fit" }).click());
assert.deepEqual((await stateOf(page)).params, third.params);
await page.emulateMedia({ colorScheme: "dark" });
await page.waitForTimeout(300);
await picture("7-other-branch-dark");

figures.switch = await done(page, "switch", () => page.locator(".branch").first().click());
await done(page, "redo", () => page.keyboard.press("Control+Shift+z"));
await page.locator("#save summary").click();
const saving = page.waitForEvent("download", { timeout: 60_000 });
await page.getByRole("button", { name: "Report" }).click();
const report = join(folder, "report.html");
await (await saving).saveAs(report);
const foreign = requests.filter((url) => !url.startsWith(new URL(address).origin) && !url.startsWith("blob:"));
assert.deepEqual(foreign, [], "the page asks nobody else");
assert.deepEqual(complaints, [], "the browser has nothing to complain about");

await page.goto("about:blank"); // what the workbench still asks for on the way out is its own
requests.length = 0;
await page.goto(pathToFileURL(report).href);
await page.screenshot({ path: join(folder, "8-report.png"), fullPage: true });
await page.emulateMedia({ media: "print" });
await page.setViewportSize({ width: 688, height: 1017 }); // A4 within the margins of a browser
const sheet = await page.locator("#sheet").boundingBox();
assert.ok(sheet.y + sheet.height < 1017, `what is handed in is longer than a page: ${JSON.stringify(sheet)}`);
assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), "or wider");
// What may not be parted is so small that two of it stand on a page, and the rest of none stays white.
const whole = await page.evaluate(() =>
  [...document.querySelectorAll("main > :not(#sheet), main > :not(#sheet) *")]
    .filter((one) => getComputedStyle(one).breakInside === "avoid")
    .map((one) => one.getBoundingClientRect().height),
);
assert.ok(whole.length > 10 && Math.max(...whole) < 1017 / 2, `a part of the appendix is ${Math.max(...whole)} px high`);
await page.emulateMedia({ media: "screen" });
await page.setViewportSize({ width: 1500, height: 950 });
assert.deepEqual(requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
const before = await page.locator("#look .below p").textContent();
await page.getByRole("button", { name: `+ ${effect}` }).click();
figures.report = await brushed(page, "residual over velocity", [0.47, 0.12], [0.62, 0.85]);
assert.notEqual(await page.locator("#look .below p").textContent(), before, "a brush works in the report");
await page.locator("#look details summary").click(); // nothing is better than chance by then
const weighed = page.locator("#look .candidate").first();
await weighed.hover();
await page.getByText(`what ${await weighed.locator(".label").textContent()} would explain`).waitFor();
await page.locator("#look").screenshot({ path: join(folder, "9-report-brushed.png") });
assert.deepEqual(complaints, []);
await browser.close();
console.log(JSON.stringify({ figures, rmse: [first.rmse, second.rmse, third.rmse] }));
