/** How long the page takes from a person's deed to the picture: told in `window.knobcam.times`. */

/**
 * @typedef {{what: string, start: number, script: number, painted: number}} Time
 * Milliseconds since the page was opened; `script` is how long the main thread was busy with drawing.
 */

/** @type {Time[]} */
export const times = [];
const KEPT = 500;

/**
 * Draw in the next frame, and note when the frame after it begins: then the picture is on the screen.
 *
 * @param {string} what
 * @param {() => void} draw
 * @param {number} [start] when the person did it; now by default
 */
export function timed(what, draw, start = performance.now()) {
  requestAnimationFrame(() => {
    const began = performance.now();
    draw();
    const script = performance.now() - began;
    requestAnimationFrame(() => {
      times.push({ what, start, script, painted: performance.now() });
      if (times.length > KEPT) times.shift();
    });
  });
}

/** @param {() => void} work for when nothing else is to be done */
export function idle(work) {
  if ("requestIdleCallback" in globalThis) requestIdleCallback(work);
  else setTimeout(work, 50);
}
