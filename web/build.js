/** Build the page: `node build.js FOLDER`, by default into the package. */

import { build } from "esbuild";
import { cpSync, mkdirSync, rmSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const folder = process.argv[2] ? resolve(process.argv[2]) : join(here, "..", "python", "knobcam", "workbench", "page");
const common = {
  ...{ bundle: true, target: "es2022", charset: "utf8", legalComments: "inline", logLevel: "warning" },
  absWorkingDir: here, // the same files wherever the command is given
};
const source = (name) => join(here, "src", name);

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
for (const name of ["index.html", "icon.svg"]) cpSync(source(name), join(folder, name));
await build({ ...common, entryPoints: [source("app.js"), source("app.css")], outdir: folder, format: "esm" });
// What goes into a report's file or a notebook is small: every one carries it.
const small = { ...common, outdir: folder, minify: true };
await build({ ...small, entryPoints: [source("report.js"), source("report.css")], format: "iife" });
await build({ ...small, entryPoints: [source("widget.js")], format: "esm", loader: { ".css": "text" } });
