/** What keys do wherever the focus is: Escape, undo and redo, zoom; and how menus close. */

import { byId } from "./dom.js";

const WITHOUT_LETTERS = new Set(["range", "checkbox", "radio"]); // inputs in which nobody types

/**
 * @param {{stop: () => unknown, clear: () => void, closer: () => void}} deeds
 * `stop`: a motor that turns; tells whether one did
 */
export function keys({ stop, clear, closer }) {
  document.addEventListener("keydown", (event) => {
    const typed = event.target instanceof HTMLInputElement && !WITHOUT_LETTERS.has(event.target.type);
    const control = event.ctrlKey || event.metaKey;
    const chosen = event.target instanceof HTMLSelectElement && !control; // there a letter is the beginning of a name
    if ((typed || chosen) && event.key !== "Escape") return;
    const key = event.key.toLowerCase();
    if (event.key === "Escape") {
      if (!stop() && !closeMenu(true) && !closePanel()) clear();
    } else if (!control && !event.altKey && key === "z") {
      closer();
    } else if (control && (key === "y" || (key === "z" && event.shiftKey))) {
      event.preventDefault();
      byId("redo").click();
    } else if (control && key === "z") {
      event.preventDefault();
      byId("undo").click();
    }
  });
  document.addEventListener("pointerdown", ({ target }) => {
    if (!(target instanceof Element && target.closest("details.menu"))) closeMenu(false);
  });
}

/** Close what lies over the plots, the uppermost first. @returns {boolean} whether anything did */
function closePanel() {
  const close = ["lead-close", "next-close"].map(byId).find((button) => button.offsetParent !== null);
  close?.click();
  return close !== undefined;
}

/**
 * Close the menu that is open.
 * @param {boolean} focus its button, on which it was opened
 * @returns {boolean} whether one was open
 */
function closeMenu(focus) {
  const menu = document.querySelector("details.menu[open]");
  menu?.removeAttribute("open");
  if (focus) menu?.querySelector("summary")?.focus();
  return menu !== null;
}
