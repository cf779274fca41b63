/** Light and dark as a notebook has them: they may differ from the system's. */

/**
 * What the notebook around says; null where it says nothing, and the system's theme holds.
 * @returns {"light" | "dark" | null}
 */
export function notebookTheme() {
  const { jpThemeLight, vscodeThemeKind } = document.body.dataset;
  if (jpThemeLight) return jpThemeLight === "true" ? "light" : "dark"; // JupyterLab, Notebook 7
  if (vscodeThemeKind) return vscodeThemeKind.endsWith("light") ? "light" : "dark";
  const colab = document.documentElement.getAttribute("theme");
  return colab === "light" || colab === "dark" ? colab : null;
}

/**
 * Call back whenever the theme may have changed, until the function that is returned is called.
 * @param {() => void} changed
 * @returns {() => void}
 */
export function themeWatched(changed) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const around = new MutationObserver(changed);
  const watched = { attributes: true, attributeFilter: ["data-jp-theme-light", "data-vscode-theme-kind", "theme"] };
  for (const element of [document.body, document.documentElement]) around.observe(element, watched);
  system.addEventListener("change", changed);
  return () => {
    around.disconnect();
    system.removeEventListener("change", changed);
  };
}
