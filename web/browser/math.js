/** Whether laws can be typeset: `node math.js - FILE`, FILE a JSON object of LaTeX by name. Prints those that cannot. */

import { readFileSync } from "node:fs";

import { parsed } from "../src/math.js";

const laws = Object.entries(JSON.parse(readFileSync(process.argv[3], "utf8")));
console.log(JSON.stringify({ laws: laws.length, plain: laws.filter(([, latex]) => !parsed(latex)).map(([name]) => name) }));
