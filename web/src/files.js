/** Captures in, results out. */

import { download, post, upload } from "./api.js";
import { byId, make } from "./dom.js";

const COLUMNS = ["t", "theta", "omega", "alpha", "tau"];

/**
 * @typedef {{done: () => void, failed: (reason: unknown) => void, say: (words: string) => void}} Heard
 */

/**
 * Let captures be dropped anywhere, chosen from a dialog, or named by path.
 * A file that cannot be read as it is stays in the dialog, with its columns, to be mapped by eye.
 * @param {Heard} heard
 */
export function opening(heard) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("open-dialog"));
  const chosen = /** @type {HTMLInputElement} */ (byId("open-file"));
  const path = /** @type {HTMLInputElement} */ (byId("open-path"));
  const told = byId("open-said");
  /** @type {File[]} what could not be read yet */
  let waiting = [];
  const fields = COLUMNS.map((name) => make("input", { name, list: "open-columns", autocomplete: "off" }));
  byId("open-map").replaceChildren(
    ...fields.map((field) => make("label", {}, make("span", { text: field.name }), field)),
  );

  /** @returns {{} | {map: string}} */
  const options = () => {
    const map = fields.filter(({ value }) => value.trim()).map(({ name, value }) => `${name}=${value.trim()}`);
    return map.length > 0 ? { map: map.join(", ") } : {};
  };
  const opened = (/** @type {string} */ name) => {
    dialog.close();
    if (waiting.length === 0) for (const field of fields) field.value = ""; // the next file has its own columns
    told.textContent = "";
    heard.say(`opened ${name}`);
    heard.done();
  };
  const refused = (/** @type {unknown} */ reason) => {
    heard.failed(reason);
    told.textContent = reason instanceof Error ? reason.message : String(reason);
    if (!dialog.open) dialog.showModal();
  };
  const take = async (/** @type {File[]} */ files) => {
    waiting = files;
    for (const file of files) {
      try {
        heard.say(`reading ${file.name} …`);
        await upload(file, /** @type {Record<string, string>} */ (options()));
        waiting = waiting.filter((one) => one !== file);
        opened(file.name);
      } catch (reason) {
        const names = await columnsOf(file);
        showColumns(names);
        for (const field of fields) if (!field.value && names.includes(field.name)) field.value = field.name;
        refused(reason);
        return;
      }
    }
  };

  byId("open").addEventListener("click", () => dialog.showModal());
  byId("open-close").addEventListener("click", () => dialog.close());
  chosen.addEventListener("change", () => {
    take([...(chosen.files ?? [])]);
    chosen.value = "";
  });
  byId("open-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const named = path.value.trim();
    if (!named) return take(waiting);
    try {
      await post("open", { path: named, ...options() });
      return opened(named);
    } catch (reason) {
      return refused(reason);
    }
  });
  const zone = byId("drop");
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    zone.hidden = false;
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) zone.hidden = true;
  });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    zone.hidden = true;
    take([...(event.dataTransfer?.files ?? [])]);
  });
}

/**
 * The columns that a text file names; none for any other file.
 * @param {File} file
 * @returns {Promise<string[]>}
 */
async function columnsOf(file) {
  const start = await file.slice(0, 8192).text();
  const line = start.split(/\r?\n/).find((one) => one.trim() && !one.startsWith("#")) ?? "";
  const names = line.split(/[,;\t]/).map((name) => name.trim().replace(/^"(.*)"$/, "$1"));
  return names.length > 1 && !/[\0\ufffd]/.test(line) ? names : [];
}

/** @param {string[]} names */
function showColumns(names) {
  byId("open-columns").replaceChildren(...names.map((name) => make("option", { value: name })));
  byId("open-found").textContent = names.length > 0 ? `In the file: ${names.join(", ")}.` : "";
  if (names.length > 0) byId("open-more").setAttribute("open", "");
}

/**
 * The menu of what can be saved.
 * @param {Heard} heard
 */
export function saving(heard) {
  for (const button of document.querySelectorAll("[data-save]")) {
    button.addEventListener("click", async () => {
      const what = button.getAttribute("data-save") ?? "";
      byId("save").removeAttribute("open");
      try {
        heard.say(`making the ${what} …`);
        const { name, blob } = await download(what);
        const link = make("a", { href: URL.createObjectURL(blob), download: name });
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
        heard.say(`saved ${name}`);
      } catch (reason) {
        heard.failed(reason);
      }
    });
  }
}
