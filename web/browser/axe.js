/** Whether everybody can use what the page shows: the rules of axe-core, in light, dark and forced colours. */

import assert from "node:assert/strict";

import axe from "axe-core";

const LOOKS = [
  { colorScheme: "light", forcedColors: "none" },
  { colorScheme: "dark", forcedColors: "none" },
  { colorScheme: "light", forcedColors: "active" },
];
const COLOURS = { runOnly: ["color-contrast"] }; // all that another look changes

/**
 * Hold a view against the rules of axe-core; leaves the page light.
 * @param {import("playwright-core").Page} page
 * @param {string} view what it is called where a rule is broken
 */
export async function accessible(page, view) {
  await page.evaluate(`globalThis.axe ?? (() => { ${axe.source} })()`);
  const broken = [];
  for (const [at, look] of LOOKS.entries()) {
    await page.emulateMedia(look);
    const found = await page.evaluate(
      (options) => globalThis.axe.run(document, { ...options, resultTypes: ["violations"] }),
      at === 0 ? {} : COLOURS,
    );
    for (const { id, nodes } of found.violations) {
      broken.push(...nodes.map(({ target, any }) => `${Object.values(look)} ${id} ${target}: ${any[0]?.message ?? ""}`));
    }
  }
  await page.emulateMedia({ colorScheme: "light", forcedColors: "none" });
  assert.deepEqual(broken, [], view);
}
