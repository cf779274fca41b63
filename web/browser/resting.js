/**
 * A capture of more samples than are drawn at once: `node resting.js CHROMIUM ADDRESS`. How many dots its plots have in
 * the frame that shows them, and as soon as nothing moves, is printed as JSON.
 */

import { opened, painted } from "./session.js";

const [chrome, address] = process.argv.slice(2);
const { browser, page } = await opened(chrome, address);
const dots = () =>
  page.evaluate(() => {
    const { plots } = window.knobcam.app.linked;
    const ink = ({ base }) => {
      const pixels = new Uint32Array(base.getContext("2d").getImageData(0, 0, base.width, base.height).data.buffer);
      return pixels.reduce((count, pixel) => count + (pixel === pixels[0] ? 0 : 1), 0);
    };
    return plots.filter(({ contents, element }) => contents && element.offsetParent).map(ink);
  });
await page.addInitScript(() => (window.requestIdleCallback = (work) => setTimeout(work, 2000))); // the rest comes late enough to be seen
await page.reload();
await painted(page, "first picture");
const first = await dots();
await page.waitForTimeout(4000);
const rested = await dots();
console.log(JSON.stringify({ first, rested }));
await browser.close();
