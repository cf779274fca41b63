/** Light and dark: as the system has it, or as the person chose. */

import { byId } from "./dom.js";

const KEY = "knobcam-theme";

/** @param {() => void} changed */
export function themed(changed) {
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const kept = localStorage.getItem(KEY);
  if (kept === "light" || kept === "dark") root.dataset.theme = kept;
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  byId("theme").addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    localStorage.setItem(KEY, root.dataset.theme);
    changed();
  });
  system.addEventListener("change", changed);
}
