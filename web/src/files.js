/** Captures in, results out. */

import { Refusal, download, post, upload, wordsOf } from "./api.js";
import { byId, make } from "./dom.js";
import { Mapping } from "./mapping.js";

/**
 * @typedef {{done: () => void, failed: (reason: unknown) => void, say: (words: string) => void}} Heard
 */

/**
 * Let captures be dropped anywhere, chosen from a dialog, or named by path.
 * A file that cannot be read as it is stays in the dialog, with its columns, to be mapped by eye.
 * @param {Heard} heard
 * @returns {(paths: string[]) => void} what asks for the columns of logs that are named so
 */
export function opening(heard) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("open-dialog"));
  const chosen = /** @type {HTMLInputElement} */ (byId("open-file"));
  const path = /** @type {HTMLInputElement} */ (byId("open-path"));
  const told = byId("open-said");
  const same = /** @type {HTMLInputElement} */ (byId("open-same"));
  /** @type {File[]} what could not be read yet */
  let waiting = [];
  /** @type {string[]} logs that are read like the one that is asked about, and of the same knob */
  let alike = [];
  const mapping = new Mapping(byId("open-map"), byId("open-columns"));

  const opened = (/** @type {string} */ name) => {
    dialog.close();
    told.textContent = "";
    heard.say(`opened ${name}`);
    heard.done();
  };
  const refused = (/** @type {unknown} */ reason) => {
    heard.say("");
    told.textContent = wordsOf(reason);
    if (reason instanceof Refusal && reason.columns) {
      mapping.show(reason.columns, reason.guess);
      byId("open-more").setAttribute("open", "");
    }
    if (!dialog.open) dialog.showModal();
  };
  /**
   * Read one after the other; those that are handed over at once are of one knob. What is refused is asked about.
   * @template T
   * @param {T[]} given
   * @param {(one: T, together: boolean, at: number) => Promise<string>} read returns its name
   */
  const each = async (given, read) => {
    try {
      for (const [at, one] of given.entries()) opened(await read(one, at > 0 || same.checked, at));
    } catch (reason) {
      refused(reason);
    }
  };
  const take = (/** @type {File[]} */ files) => {
    waiting = files;
    return each(files, async (file, together) => {
      heard.say(`reading ${file.name} …`);
      await upload(file, { ...mapping.options(), together: String(together) });
      waiting = waiting.filter((one) => one !== file);
      return file.name;
    });
  };
  const byPath = (/** @type {string[]} */ paths) =>
    each(paths, async (one, together, at) => {
      [path.value, alike] = [one, paths.slice(at + 1)];
      await post("open", { path: one, together, ...mapping.options() });
      path.value = "";
      return one;
    });

  const fresh = (/** @type {File[]} */ files) => {
    mapping.clear(); // other files have columns of their own
    [path.value, alike] = ["", []];
    byId("open-named").textContent = `chosen: ${files.map(({ name }) => name).join(", ")}`;
    return take(files);
  };

  byId("open").addEventListener("click", () => {
    mapping.clear();
    [waiting, alike] = [[], []];
    told.textContent = byId("open-named").textContent = "";
    dialog.showModal();
  });
  byId("open-close").addEventListener("click", () => dialog.close());
  chosen.addEventListener("change", () => {
    fresh([...(chosen.files ?? [])]);
    chosen.value = "";
  });
  byId("open-map").addEventListener("input", () => (told.textContent = "")); // what was asked is being answered
  byId("open-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const named = path.value.trim();
    told.textContent = mapping.lacking();
    if (told.textContent) return undefined;
    if (!named && waiting.length === 0) {
      told.textContent = "Choose a file, or type its path.";
      return undefined;
    }
    if (!named) return take(waiting);
    return byPath([named, ...alike]);
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
    fresh([...(event.dataTransfer?.files ?? [])]);
  });
  return byPath;
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
