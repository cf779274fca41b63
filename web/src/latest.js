/** One request at a time, of which only the newest matters. */

/**
 * Make a function that runs `work` with the newest argument, never twice at once.
 * @template T
 * @param {(argument: T) => Promise<void>} work
 * @returns {(argument: T) => void}
 */
export function latest(work) {
  /** @type {T[]} */
  const next = [];
  let busy = false;
  return async (argument) => {
    next.splice(0, next.length, argument);
    if (busy) return;
    busy = true;
    try {
      for (let one = next.pop(); one !== undefined; one = next.pop()) await work(one);
    } finally {
      busy = false;
    }
  };
}
