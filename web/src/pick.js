/** Which points lie in a rectangle: a uniform grid of cells, so that a brush looks at few points. */

/**
 * A rectangle in pixels of a plot's raster, all edges inside it.
 * @typedef {{left: number, right: number, top: number, bottom: number}} Rect
 */

const CELL = 16; // pixels
const MANY = 1 / 32; // of all points, of which so many are put in order by looking through all

export class Pick {
  /**
   * Sort the points into cells.
   * @param {Int32Array} pixels of each point, −1 where it is not drawn
   * @param {number} width of the raster
   * @param {number} height
   */
  constructor(pixels, width, height) {
    this.pixels = pixels;
    this.width = width;
    this.columns = Math.ceil(width / CELL);
    const cells = this.columns * Math.ceil(height / CELL);
    const of = new Int32Array(pixels.length);
    this.starts = new Uint32Array(cells + 1);
    for (let i = 0; i < pixels.length; i++) {
      const pixel = pixels[i];
      if (pixel < 0) {
        of[i] = -1;
        continue;
      }
      const row = (pixel / width) | 0;
      of[i] = ((row / CELL) | 0) * this.columns + (((pixel - row * width) / CELL) | 0);
      this.starts[of[i] + 1]++;
    }
    for (let cell = 0; cell < cells; cell++) this.starts[cell + 1] += this.starts[cell];
    this.order = new Uint32Array(this.starts[cells]);
    const next = this.starts.slice();
    for (let i = 0; i < of.length; i++) if (of[i] >= 0) this.order[next[of[i]]++] = i;
    this.found = new Uint32Array(this.order.length);
    this.taken = new Uint8Array(pixels.length);
  }

  /**
   * Return the indices of the points in a rectangle; valid until the next call.
   * @param {Rect} rect
   * @returns {Uint32Array}
   */
  inside({ left, right, top, bottom }) {
    let count = 0;
    const [first, last] = [Math.floor(left / CELL), Math.min(Math.floor(right / CELL), this.columns - 1)];
    const lowest = Math.min(Math.floor(bottom / CELL), Math.floor((this.starts.length - 2) / this.columns));
    for (let row = Math.floor(top / CELL); row <= lowest; row++) {
      const whole = row * CELL >= top && (row + 1) * CELL - 1 <= bottom;
      for (let column = first; column <= last; column++) {
        const cell = row * this.columns + column;
        const [from, to] = [this.starts[cell], this.starts[cell + 1]];
        if (whole && column * CELL >= left && (column + 1) * CELL - 1 <= right) {
          this.found.set(this.order.subarray(from, to), count);
          count += to - from;
          continue;
        }
        for (let at = from; at < to; at++) {
          const pixel = this.pixels[this.order[at]];
          const y = (pixel / this.width) | 0;
          const x = pixel - y * this.width;
          if (x >= left && x <= right && y >= top && y <= bottom) this.found[count++] = this.order[at];
        }
      }
    }
    const found = this.found.subarray(0, count);
    if (count > MANY * this.taken.length) this.inOrder(found);
    return found;
  }

  /** Put points in the order of their numbers: what is looked up of each then lies side by side in memory. @param {Uint32Array} found */
  inOrder(found) {
    const { taken } = this;
    for (let at = 0; at < found.length; at++) taken[found[at]] = 1;
    for (let i = 0, at = 0; at < found.length; i++) {
      if (taken[i] === 0) continue;
      found[at++] = i;
      taken[i] = 0;
    }
  }
}
