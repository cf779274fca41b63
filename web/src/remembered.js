/** What was worked out of samples once: they are many, never change, and are looked at again. */

/**
 * A function that works out the same again only where it is asked of something else.
 * @template {object} K
 * @template {unknown[]} O
 * @template T
 * @param {(key: K, ...others: O) => T} work
 * @returns {(key: K, ...others: O) => T}
 */
export function remembered(work) {
  /** @type {WeakMap<K, {others: O, told: T}>} */
  const known = new WeakMap();
  return (key, ...others) => {
    const before = known.get(key);
    if (before && before.others.every((one, at) => one === others[at])) return before.told;
    const told = work(key, ...others);
    known.set(key, { others, told });
    return told;
  };
}
