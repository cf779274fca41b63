/**
 * Clouds of points, drawn into pixels by hand.
 *
 * Every point's pixel is worked out once per change of the data; after that a selection of points is a loop
 * of single writes, which a browser without a graphics card does faster than its emulated one.
 */

/**
 * Where a plot's data lie in its raster.
 * @typedef {{width: number, height: number, x: [number, number], y: [number, number], dot: number,
 *   part?: {x: boolean, y: boolean}}} Frame
 * `part`: along which axes points beyond the frame are not meant to be seen
 */

/**
 * Work out the pixel of each point's upper left corner; −1 for points that are not finite or not to be seen.
 *
 * Points beyond the frame land on its edge, so that nothing is hidden; unless only a part is meant to be seen.
 *
 * @param {Float32Array} xs
 * @param {Float32Array} ys
 * @param {Frame} frame
 * @param {Int32Array} [pixels] where they go, as many as points
 * @param {number} [every] of how many points one is worked out
 * @returns {Int32Array}
 */
export function place(xs, ys, frame, pixels = new Int32Array(xs.length), every = 1) {
  const { width, height, dot } = frame;
  const [right, bottom] = [width - dot, height - dot];
  const xStep = right / (frame.x[1] - frame.x[0]);
  const yStep = bottom / (frame.y[1] - frame.y[0]);
  const [xLow, yHigh] = [frame.x[0], frame.y[1]];
  const { x: cutX, y: cutY } = frame.part ?? { x: false, y: false };
  for (let i = 0; i < xs.length; i += every) {
    let column = (xs[i] - xLow) * xStep;
    let row = (yHigh - ys[i]) * yStep;
    if (!(column >= 0 && column <= right && row >= 0 && row <= bottom)) {
      const hidden = (cutX && (column < 0 || column > right)) || (cutY && (row < 0 || row > bottom));
      if (column - column !== 0 || row - row !== 0 || hidden) {
        pixels[i] = -1;
        continue;
      }
      column = Math.min(right, Math.max(0, column));
      row = Math.min(bottom, Math.max(0, row));
    }
    pixels[i] = ((row + 0.5) | 0) * width + ((column + 0.5) | 0);
  }
  return pixels;
}

let scratch = new Int32Array(0); // of points whose pixels are counted and forgotten

const MANY = 0.25; // points a pixel, from which on most share theirs
const USUAL = 4; // times the mean count of points on a pixel have the full colour

/**
 * Of each pixel how many dots are on it; how many are many; one of how many points was counted.
 * @typedef {{counts: Uint32Array, full: number, every: number}} Cloud
 */

/**
 * Count the dots on each pixel.
 * @param {Float32Array} xs
 * @param {Float32Array} ys
 * @param {Frame} frame
 * @param {number} [every] of how many points one is counted
 * @returns {Cloud}
 */
export function cloudOf(xs, ys, frame, every = 1) {
  const { dot, width, height } = frame;
  const corners = new Uint32Array(width * height);
  let points = 0;
  if (scratch.length < xs.length) scratch = new Int32Array(xs.length);
  const pixels = place(xs, ys, frame, scratch, every);
  for (let i = 0; i < xs.length; i += every) {
    if (pixels[i] < 0) continue;
    corners[pixels[i]]++;
    points++;
  }
  // Every dot lies within the frame, so that none is carried over to the next row.
  const counts = new Uint32Array(corners.length);
  let hit = 0;
  for (let pixel = 0; pixel < corners.length; pixel++) {
    const more = corners[pixel];
    if (more === 0) continue;
    for (let row = 0; row < dot; row++) {
      const first = pixel + row * width;
      for (let at = first; at < first + dot; at++) {
        if (counts[at] === 0) hit++;
        counts[at] += more;
      }
    }
  }
  return { counts, every, full: Math.max(2, Math.ceil((USUAL * dot * dot * points) / Math.max(1, hit))) };
}

/**
 * Draw a cloud over what is there; where more points meet, the colour is fuller, by the logarithm of how many.
 *
 * @param {Uint32Array} image opaque pixels
 * @param {Cloud} cloud
 * @param {number} colour as in `image`
 * @param {number} strength share of the colour that a single point has
 */
export function drawCloud(image, { counts, full }, colour, strength) {
  const rise = (1 - strength) / Math.log(full);
  const weights = Float32Array.from({ length: full + 1 }, (_, n) => strength + rise * Math.log(Math.max(1, n)));
  const ground = image[0]; // where a cloud lies on nothing else, its colours are as many as its weights
  const alone = Uint32Array.from(weights, (weight) => mixed(ground, colour, weight));
  for (let at = 0; at < counts.length; at++) {
    if (counts[at] === 0) continue;
    const many = counts[at] < full ? counts[at] : full;
    image[at] = image[at] === ground ? alone[many] : mixed(image[at], colour, weights[many]);
  }
}

/**
 * Draw some of the points in one full colour.
 *
 * @param {Uint32Array} image
 * @param {Int32Array} pixels of `place`
 * @param {Uint32Array | null} chosen indices; all points where null
 * @param {Frame} frame
 * @param {number} colour
 * @param {number} [every] of how many of them one is drawn
 */
export function drawPoints(image, pixels, chosen, frame, colour, every = 1) {
  const { dot, width } = frame;
  const count = chosen ? chosen.length : pixels.length;
  if (count < MANY * image.length) {
    for (let i = 0; i < count; i += every) drawDot(image, pixels[chosen ? chosen[i] : i], { dot, width }, colour);
    return;
  }
  // Of so many most share theirs with others, and each is drawn once. What is nowhere, at −1, is noted before the first.
  const corners = new Uint8Array(image.length + 1);
  if (chosen) for (let i = 0; i < count; i += every) corners[pixels[chosen[i]] + 1] = 1;
  else for (let i = 0; i < count; i += every) corners[pixels[i] + 1] = 1;
  for (let at = 1; at < corners.length; at++) if (corners[at] === 1) drawDot(image, at - 1, { dot, width }, colour);
}

/** @param {Uint32Array} image @param {number} pixel −1: nowhere @param {Pick<Frame, "dot" | "width">} frame @param {number} colour */
function drawDot(image, pixel, { dot, width }, colour) {
  if (pixel < 0) return;
  for (let row = 0, first = pixel; row < dot; row++, first += width) {
    for (let at = first; at < first + dot; at++) image[at] = colour;
  }
}

/**
 * Draw a few points so that they are seen among thousands: three times as wide and high.
 *
 * @param {Uint32Array} image
 * @param {Int32Array} pixels of `place`
 * @param {Uint32Array} chosen
 * @param {Frame} frame
 * @param {number} colour
 */
export function drawFew(image, pixels, chosen, { dot, width, height }, colour) {
  for (const at of chosen) {
    const pixel = pixels[at];
    if (pixel < 0) continue;
    const [across, down] = [pixel % width, Math.floor(pixel / width)];
    const [left, right] = [Math.max(0, across - dot), Math.min(width, across + 2 * dot)];
    const bottom = Math.min(height, down + 2 * dot);
    for (let row = Math.max(0, down - dot); row < bottom; row++) image.fill(colour, row * width + left, row * width + right);
  }
}

/** Two channels at once, in steps of 1/256. @param {number} under @param {number} over @param {number} share of `over` */
function mixed(under, over, share) {
  const [some, rest] = [Math.round(256 * share), 256 - Math.round(256 * share)];
  const redBlue = (Math.imul(under & 0xff00ff, rest) + Math.imul(over & 0xff00ff, some)) >>> 8;
  const green = (Math.imul(under & 0xff00, rest) + Math.imul(over & 0xff00, some)) >>> 8;
  return (0xff000000 | (redBlue & 0xff00ff) | (green & 0xff00)) >>> 0;
}

/**
 * A colour of the style sheet as a pixel of an image: bytes red, green, blue, alpha.
 * @param {string} text `#rrggbb`
 */
export function pixelColour(text) {
  const value = Number.parseInt(text.slice(1), 16);
  return (0xff000000 | ((value & 0xff) << 16) | (value & 0xff00) | (value >> 16)) >>> 0;
}
