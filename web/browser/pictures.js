/**
 * The documentation's pictures of the page: `node pictures.js CHROMIUM FOLDER SPRING BRAKED`.
 *
 * SPRING and BRAKED are the addresses of workbenches: a knob that hides an effect, and one whose torque no effect is.
 */

import { join } from "node:path";

import { brushed, opened, painted } from "./session.js";

const [chrome, folder, ...addresses] = process.argv.slice(2);
const [effect, law] = addresses;

const first = await opened(chrome, effect);
await first.page.setViewportSize({ width: 1440, height: 900 });
first.page.setDefaultTimeout(120_000);
await painted(first.page, "first picture");
await first.page.locator(".candidate").first().waitFor();
await brushed(first.page, "residual over velocity", [0.47, 0.08], [0.6, 0.92]);
await first.page.locator(".candidate").first().hover();
await painted(first.page, "look");
await first.page.screenshot({ path: join(folder, "workbench.png") });
await first.browser.close();

const second = await opened(chrome, law);
await second.page.setViewportSize({ width: 1440, height: 900 });
second.page.setDefaultTimeout(120_000);
await painted(second.page, "first picture");
await second.page.getByRole("button", { name: "Look for a law…" }).click();
await second.page.locator(".law").first().waitFor();
await second.page.locator("#laws").evaluate((laws) => laws.scrollIntoView({ block: "end" }));
await second.page.locator(".law").first().hover();
await painted(second.page, "look");
await second.page.screenshot({ path: join(folder, "workbench-law.png") });
await second.browser.close();
