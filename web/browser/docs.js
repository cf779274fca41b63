/**
 * The documentation on an ordinary screen: `node docs.js CHROMIUM FOLDER`.
 *
 * Of every page of the site in FOLDER it is printed what is wider than a screen of 1366 x 768, and which pictures are not
 * there.
 */

import { readdirSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { launched } from "./session.js";

const [chrome, folder] = process.argv.slice(2);
const { browser, page } = await launched(chrome);
await page.setViewportSize({ width: 1366, height: 768 });
const names = readdirSync(folder, { recursive: true }).filter((name) => name.endsWith(".html"));
const wide = {};
const lost = {};
for (const name of names) {
  await page.goto(pathToFileURL(join(folder, name)).href);
  const seen = await page.evaluate(() => {
    const most = document.documentElement.clientWidth;
    const sticks = (one) => one.getBoundingClientRect().right > most + 1 && one.getBoundingClientRect().width > 0;
    return {
      over: document.documentElement.scrollWidth > most
        ? [...document.querySelectorAll("main *, article *, body > *")].filter(sticks).slice(0, 3).map((one) => one.outerHTML.slice(0, 120))
        : null,
      lost: [...document.images].filter((one) => one.complete && one.naturalWidth === 0).map((one) => one.getAttribute("src")),
    };
  });
  if (seen.over) wide[name] = seen.over;
  if (seen.lost.length > 0) lost[name] = seen.lost;
}
await browser.close();
console.log(JSON.stringify({ pages: names.length, wide, lost }));
