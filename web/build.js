/** Build the page: `node build.js FOLDER`, by default into the package. */

import { build } from "esbuild";
import { cpSync, mkdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const folder = process.argv[2] ?? join(here, "..", "python", "knobcam", "workbench", "page");
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
for (const name of ["index.html", "app.css", "icon.svg"]) cpSync(join(here, "src", name), join(folder, name));
await build({
  entryPoints: [join(here, "src", "app.js")],
  outfile: join(folder, "app.js"),
  bundle: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  legalComments: "inline",
  logLevel: "warning",
});
