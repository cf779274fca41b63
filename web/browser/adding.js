/**
 * Effects that nobody has weighed yet, added while the weighing is under way: `node adding.js CHROMIUM ADDRESS
 * EFFECT...`. Each is added to the first model; how long that took is printed as JSON.
 */

import { done, opened, painted, stateOf } from "./session.js";

const [chrome, address, ...effects] = process.argv.slice(2);
const { browser, page } = await opened(chrome, address);
await painted(page, "first picture");
const figures = {};
for (const effect of effects) {
  await page.waitForFunction(() => window.knobcam.app.state.job !== null);
  await page.waitForTimeout(1500); // the weighing has begun
  if ((await stateOf(page)).candidates.ready) throw new Error(`${effect} was weighed already`);
  await page.selectOption("#any-effect", effect);
  figures[effect] = await done(page, "add", () => page.locator("#any [type=submit]").click());
  await done(page, "undo", () => page.keyboard.press("Control+z"));
}
console.log(JSON.stringify({ figures }));
await browser.close();
