/** Numbers as a person reads them. */

/**
 * @param {number | null} value
 * @param {number} [digits] significant ones
 * @returns {string} with a true minus; a dash where there is none
 */
export function number(value, digits = 3) {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(digits - 1) : plain(value, digits);
  return text.replaceAll("-", "−");
}

/**
 * The same in a column of figures, where each has as many digits as the others: 0.110 below 0.101.
 * @param {number | null} value
 * @param {number} [digits]
 */
export function figure(value, digits = 3) {
  const size = Math.abs(Number((value ?? NaN).toPrecision(digits)));
  return value !== null && size >= 1e-3 && size < 10 ** digits ? value.toPrecision(digits).replaceAll("-", "−") : number(value, digits);
}

/**
 * A value down to the second digit of half its interval, which is all that is known of it.
 * @param {number} value
 * @param {number} half
 */
export function asKnown(value, half) {
  if (!(half > 0)) return number(value, 4);
  const place = Math.floor(Math.log10(Number(half.toPrecision(2)))) - 1;
  const size = Math.max(Math.abs(value), half);
  const text = size < 1e-3 || size >= 1e5 ? value.toExponential(Math.max(0, Math.floor(Math.log10(Math.abs(value) || size)) - place)) : fixed(value, place);
  return text.replaceAll("-", "−");
}

/** @param {number} value @param {number} place power of ten of the last digit */
function fixed(value, place) {
  return place > 0 ? String(Math.round(value / 10 ** place) * 10 ** place) : value.toFixed(Math.min(12, -place));
}

/** @param {number} value @param {number} digits */
function plain(value, digits) {
  return String(Number(value.toPrecision(digits)));
}

/**
 * How many there are, its thousands apart. What the browser has for it first loads all that it knows of languages.
 * @param {number} many
 */
export function thousands(many) {
  return String(many).replace(/\B(?=(\d{3})+$)/g, ",");
}

/** @param {number} share from −1 to 1; of a fall the sign changes no digit */
export function percent(share) {
  if (!Number.isFinite(share)) return "–";
  const text = (100 * share).toFixed(Math.abs(share) < 0.1 ? 1 : 0);
  return `${Number(text) === 0 ? "0" : text}\u00a0%`.replaceAll("-", "−");
}

/**
 * The unit for the eye of all torques of a page: shown = factor * SI. Small ones in mNm, as the pictures of the package.
 * @param {{unit: string, peak: number}} about "N m" or "N", of a motor "A", "V" or "duty"; the largest torque there is, SI
 */
export function torqueScale({ unit, peak }) {
  return unit === "N m" && peak <= 2 ? { factor: 1000, unit: "mNm" } : { factor: 1, unit };
}

/** What has a shorter name; the radian is left out, as everybody does. @type {Record<string, string>} */
const SHORT = { "N s^2/m": "kg", "N m s^2/rad": "kg m²", 1: "" };

/**
 * A unit as a person writes it: N m s/rad, kg m² for N m s^2/rad; nothing for what has none.
 * @param {string} unit
 */
export function unitWords(unit) {
  return SHORT[unit] ?? unit.replaceAll("^2", "²").replaceAll("^3", "³");
}

/**
 * A unit of the catalogue, where torques are in N m and forces in N, of a capture that has something else in their place.
 * @param {string} unit
 * @param {string} torque what the capture has
 */
export function unitOf(unit, torque) {
  return unit.replace(/^N(?: m)?(?=[ /]|$)/, torque);
}

/**
 * How a unit is written that has that of the torques in it: as in the plots. An inertia has a name of its own.
 * @param {string} unit
 * @param {{unit: string, peak: number}} about as of torqueScale
 */
export function scaleOf(unit, about) {
  const torque = torqueScale(about);
  const own = !(unit in SHORT) && (unit === about.unit || unit.startsWith(`${about.unit} `) || unit.startsWith(`${about.unit}/`));
  return own ? { factor: torque.factor, unit: unit.replace(about.unit, torque.unit) } : { factor: 1, unit };
}

/**
 * What moves the knob, by its unit.
 * @param {string} unit
 */
export function torqueWord(unit) {
  /** @type {Record<string, string>} */
  const words = { N: "force", A: "current", V: "voltage", duty: "duty cycle" };
  return words[unit] ?? "torque";
}

/**
 * How a motion is called and measured, of a knob that turns or of one that slides.
 * @param {{coordinate: "rotary" | "linear"}} about
 */
export function motionWords({ coordinate }) {
  const [place, way] = coordinate === "linear" ? ["position", "m"] : ["angle", "rad"];
  return {
    theta: { name: place, unit: way },
    omega: { name: "velocity", unit: `${way}/s` },
    alpha: { name: "acceleration", unit: unitWords(`${way}/s^2`) },
  };
}

/**
 * Round values between two limits, for the ticks of an axis.
 * @param {number} low
 * @param {number} high
 * @param {number} count how many there may be, about
 */
export function ticks(low, high, count) {
  const span = high - low;
  if (!(span > 0) || !Number.isFinite(span)) return [];
  const rough = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const steps = [10, 5, 2, 1].map((factor) => factor * power);
  const wide = steps.findLastIndex((step) => step >= rough);
  // A single tick is no scale: then the next finer step, though that is more of them.
  const scales = steps.slice(wide).map((step) => {
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, at) => (first + at) * step);
  });
  return scales.find((marks) => marks.length > 1) ?? scales[scales.length - 1];
}
