import { opened } from "./session.js";
const [chrome, address, folder, name, ...steps] = process.argv.slice(2);
const { browser, page } = await opened(chrome, address);
page.setDefaultTimeout(60000);
await page.waitForTimeout(2500);
for (const step of steps) { await page.evaluate((s) => eval(s), step); await page.waitForTimeout(1500); }
for (const [w, h, dark] of [[1440, 900, false], [1440, 900, true], [800, 900, false], [800, 900, true]]) {
  await page.emulateMedia({ colorScheme: dark ? "dark" : "light" });
  await page.setViewportSize({ width: w, height: h });
  await page.waitForTimeout(700);
  await page.screenshot({ path: `${folder}/${name}-${w}${dark ? "-dark" : ""}.png` });
}
await browser.close();
