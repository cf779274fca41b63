/** Elements, made so that text from a file or a server can never become markup. */

/**
 * Make an element.
 *
 * `text` and children that are strings go in as text; `on` holds event listeners; every other property is an
 * attribute, left out where it is null or false.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {{text?: string, on?: Record<string, (event: any) => void>, [attribute: string]: any}} [properties]
 * @param {...(Node | string | null)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  const { text, on = {}, ...attributes } = properties;
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false && value !== undefined) {
      element.setAttribute(name, value === true ? "" : String(value));
    }
  }
  for (const [name, listener] of Object.entries(on)) element.addEventListener(name, listener);
  if (text !== undefined) element.textContent = text;
  element.append(...children.filter((child) => child !== null));
  return element;
}

/**
 * Find an element of the page by its id.
 * @param {string} id
 * @returns {HTMLElement}
 */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element ${id}`);
  return element;
}

/**
 * The value of a colour or size that the style sheet names, as it is where an element stands.
 * @param {string} name
 * @param {Element} element
 */
export function styleValue(name, element) {
  return getComputedStyle(element).getPropertyValue(name).trim();
}

/** Bring what somebody was led to into sight, opened, and let it stand out for a moment. @param {HTMLElement} element */
export function shown(element) {
  for (const fold of element.querySelectorAll("details")) fold.open = true;
  element.scrollIntoView({ block: "nearest" });
  element.classList.remove("shown");
  void element.offsetWidth; // so that the same animation begins anew
  element.classList.add("shown");
}
