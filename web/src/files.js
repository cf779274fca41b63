/** Captures in, results out. */

import { download, post, upload } from "./api.js";
import { byId, make } from "./dom.js";

const COLUMNS = ["t", "theta", "omega", "alpha", "tau"];

/**
 * @typedef {{done: () => void, failed: (reason: unknown) => void, say: (words: string) => void}} Heard
 */

/**
 * Let captures be dropped anywhere, chosen from a dialog, or named by path.
 * @param {Heard} heard
 */
export function opening(heard) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("open-dialog"));
  const chosen = /** @type {HTMLInputElement} */ (byId("open-file"));
  const path = /** @type {HTMLInputElement} */ (byId("open-path"));
  const fields = COLUMNS.map((name) => make("input", { name, placeholder: `${name}=…`, autocomplete: "off" }));
  byId("open-map").replaceChildren(
    ...fields.map((field) => make("label", {}, make("span", { text: field.name }), field)),
  );

  const options = () => {
    const map = fields.filter(({ value }) => value.trim()).map(({ name, value }) => `${name}=${value.trim()}`);
    return map.length > 0 ? { map: map.join(",") } : {};
  };
  const take = async (/** @type {Iterable<File>} */ files) => {
    for (const file of files) {
      try {
        heard.say(`reading ${file.name} …`);
        await upload(file, /** @type {Record<string, string>} */ (options()));
        dialog.close();
        heard.done();
      } catch (reason) {
        heard.failed(reason);
        return;
      }
    }
  };

  byId("open").addEventListener("click", () => dialog.showModal());
  byId("open-close").addEventListener("click", () => dialog.close());
  chosen.addEventListener("change", () => take(chosen.files ?? []));
  byId("open-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      if (path.value.trim()) await post("open", { path: path.value.trim(), ...options() });
      dialog.close();
      heard.done();
    } catch (reason) {
      heard.failed(reason);
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
    take(event.dataTransfer?.files ?? []);
  });
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
