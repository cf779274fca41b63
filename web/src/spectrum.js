/** The residual along frequency: no sample has one, so what is drawn is the core's RMS per bin beside chance. */

/** @typedef {import("./types.js").Split} Split */
/** @typedef {{x: number[], y: number[], chance: number[]}} Spectrum logarithms to base 10, of Hz and of SI */

const SEEN = 1e-3; // of the highest level of chance: below it the measurement filter has taken everything away
const LEAST = 0.02; // of the middle level of chance: what is lower is drawn there

/**
 * What a spectrum shows; null where there is nothing yet.
 * @param {Split | undefined} split
 * @returns {Spectrum | null}
 */
export function spectrumOf(split) {
  if (!split) return null;
  const level = split.band.map((value) => value ?? 0);
  const highest = Math.max(...level);
  const middle = split.low.map((low, at) => (low + split.high[at]) / 2);
  const shown = [...middle.keys()].filter((at) => middle[at] > 0 && level[at] > SEEN * highest);
  if (shown.length < 2) return null;
  const levels = shown.map((at) => level[at]).sort((a, b) => a - b);
  const least = LEAST * levels[levels.length >> 1];
  return {
    x: shown.map((at) => Math.log10(middle[at])),
    y: shown.map((at) => Math.log10(Math.max(split.mean[at], least))),
    chance: shown.map((at) => Math.log10(level[at])),
  };
}

/**
 * Draw it: what chance stays below as an area, the residual as a line.
 * @param {CanvasRenderingContext2D} brush
 * @param {Spectrum} spectrum
 * @param {{across: (value: number) => number, up: (value: number) => number, bottom: number}} place
 * @param {{wrong: string, band: string}} colours
 */
export function drawSpectrum(brush, { x, y, chance }, { across, up, bottom }, colours) {
  brush.globalAlpha = 0.35;
  brush.fillStyle = colours.band;
  brush.beginPath();
  brush.moveTo(across(x[0]), bottom);
  for (const [at, value] of x.entries()) brush.lineTo(across(value), up(chance[at]));
  brush.lineTo(across(x[x.length - 1]), bottom);
  brush.fill();
  brush.globalAlpha = 1;
  brush.strokeStyle = colours.wrong;
  brush.lineWidth = 1.2;
  brush.beginPath();
  for (const [at, value] of x.entries()) brush.lineTo(across(value), up(y[at]));
  brush.stroke();
}
