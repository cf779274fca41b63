/** A Chromium without a screen, looking at the workbench. */

import { chromium } from "playwright-core";

const QUIET = [
  ...["--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"],
  ...["--disable-component-update", "--disable-sync", "--no-sandbox"],
];

/**
 * Start a browser; whatever its page complains about is kept in `complaints`, whatever it asks for in `requests`.
 * @param {string} chrome path of the browser
 */
export async function launched(chrome) {
  const browser = await chromium.launch({ executablePath: chrome, args: QUIET });
  const page = await browser.newPage({ viewport: { width: 1500, height: 950 }, acceptDownloads: true, reducedMotion: "reduce" });
  const complaints = [];
  const requests = [];
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("response", async (answer) => {
    if (answer.status() >= 400) complaints.push(`${answer.url()} ${await answer.text().catch(() => "")}`);
  });
  page.on("request", (request) => requests.push(request.url()));
  return { browser, page, complaints, requests };
}

/**
 * Start a browser and open a page in it.
 * @param {string} chrome path of the browser
 * @param {string} address
 */
export async function opened(chrome, address) {
  const started = await launched(chrome);
  await started.page.goto(address);
  return started;
}

/**
 * Wait until a deed has been painted once more than `before`, and return its times in milliseconds.
 * @param {import("playwright-core").Page} page
 * @param {string} what
 * @param {number} [before]
 */
export async function painted(page, what, before = 0) {
  const handle = await page.waitForFunction(
    ([what, before]) => {
      const times = window.knobcam?.times.filter((time) => time.what === what) ?? [];
      return times.length > before ? times.at(-1) : null;
    },
    [what, before],
    { timeout: 60_000 },
  );
  const { start, script, painted: end } = await handle.jsonValue();
  return { script, painted: end - start };
}

/**
 * Do something and wait until the page has painted it.
 * @param {import("playwright-core").Page} page
 * @param {string} what
 * @param {() => Promise<unknown>} deed
 */
export async function done(page, what, deed) {
  const before = await page.evaluate((what) => window.knobcam.times.filter((time) => time.what === what).length, what);
  await deed();
  return painted(page, what, before);
}

/**
 * Drag a rectangle over a plot, by shares of its width and height; tells the longest move.
 * @param {import("playwright-core").Page} page
 * @param {string} plot name of it
 * @param {[number, number]} from
 * @param {[number, number]} to
 */
export async function brushed(page, plot, from, to) {
  const place = page.getByRole("img", { name: plot, exact: true });
  await place.scrollIntoViewIfNeeded();
  const box = await place.boundingBox();
  const moves = 20;
  const spot = (share) => [0, 1].map((i) => from[i] + (to[i] - from[i]) * share);
  const go = ([x, y]) => page.mouse.move(box.x + box.width * x, box.y + box.height * y);
  await go(from);
  await page.mouse.down();
  let [script, slowest] = [0, 0];
  for (let move = 1; move <= moves; move++) {
    const wait = move < 4 ? go(spot(move / moves)) : done(page, "brush", () => go(spot(move / moves)));
    const times = await wait;
    script = Math.max(script, times?.script ?? 0);
    slowest = Math.max(slowest, times?.painted ?? 0);
  }
  await page.mouse.up();
  return { script, painted: slowest };
}

/**
 * @param {import("playwright-core").Page} page
 * @returns {Promise<import("../src/types.js").State>}
 */
export function stateOf(page) {
  return page.evaluate(() => window.knobcam.app.state);
}
