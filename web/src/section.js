/** A small moving cross-section of what an effect is, driven by a capture: what of it the catalogue tells. */

/** @typedef {import("./types.js").Effect} Effect */
/** @typedef {import("./store.js").Columns} Columns */
/** @typedef {CanvasRenderingContext2D} Brush */
/**
 * @typedef {{ink: string, soft: string, shade: string, colour: string}} Look
 * @typedef {{theta: number, along: number, omega: number, torque: number, level: number, bare: number,
 *   hills: Float32Array | null}} Now
 * `along`: where it is from the lowest position to the highest, 0 to 1; `omega`, `torque` that it adds and the measured
 * `level`, `bare` without it, of the largest, -1 to 1; `hills`: what it would take to get from the lowest position to each, 0 to 1
 */

const SIZE = { width: 260, height: 120 }; // CSS pixels
const BINS = 96; // of the positions that a capture passes
const FREE = 0.02; // of the largest torque: less is carried within the play

/** How each kind is drawn. @type {Record<string, (brush: Brush, now: Now, look: Look) => void>} */
const KINDS = { joint, gap, gauge, bristles, fluid, hills, spring, weight, poles, stops, mass };

/** Which kind an effect is: what the catalogue says, else by where it acts and what its torque follows. @param {Effect} effect */
export function kindOf({ place, friction, over, section }) {
  if (section && section in KINDS) return section;
  if (place === "coupling") return "joint";
  if (place === "sensor") return "gauge";
  if (friction) return "bristles";
  return over === "acceleration" ? "mass" : "hills";
}

/** What is seen, in words. @type {Record<string, string>} */
export const SEEN = {
  joint: "what drives and what is moved, and the joint between them with what it carries",
  gap: "what drives and what is moved, and the play between them: which side touches, and how hard",
  gauge: "the reading, and in grey what it would be without this",
  bristles: "two surfaces whose asperities bend like bristles as one slides over the other",
  hills: "the hills and valleys that this makes of the way, and where on it the readout is",
  fluid: "what moves, and the fluid that holds it back: the longer its lines, the faster it goes",
  spring: "a spring, drawn out and pressed together along the way, and the torque it gives",
  weight: "a weight off the axis: what it pulls as it goes round",
  poles: "magnets that pass poles, each pulled to the nearest",
  stops: "the way, its ends, and what they push back with",
  mass: "the mass that has to be set going and stopped",
};

/**
 * Draw an effect at one sample.
 * @param {HTMLCanvasElement} canvas
 * @param {Effect} effect
 * @param {Motion} motion
 * @param {number} at
 * @param {Look} look
 */
export function drawSection(canvas, effect, motion, at, look) {
  const scale = globalThis.devicePixelRatio || 1;
  canvas.width = SIZE.width * scale;
  canvas.height = SIZE.height * scale;
  const brush = canvas.getContext("2d");
  if (!brush) return;
  brush.scale(scale, scale);
  brush.lineWidth = 2;
  brush.lineJoin = "round";
  const now = motion.at(at);
  KINDS[kindOf(effect)](brush, now, look);
  bar(brush, now.torque, look);
}

/** A capture as cross-sections need it. */
export class Motion {
  /** @param {Columns} columns @param {Float32Array | null} added what the effect would add, as far as that is known */
  constructor(columns, added) {
    this.columns = columns;
    this.added = added;
    const [low, high] = reach(columns.theta);
    this.low = low;
    this.span = high - low || 1;
    this.most = { omega: largest(columns.omega), tau: largest(columns.tau), added: added ? largest(added) : 1 };
    this.hills = added && hillsOf(columns.theta, added, low, this.span);
  }

  /** @param {number} i @returns {Now} */
  at(i) {
    const { theta, omega, tau } = this.columns;
    const part = (/** @type {number} */ value, /** @type {number} */ most) => (value === value ? value / most : 0);
    return {
      theta: theta[i],
      along: (theta[i] - this.low) / this.span,
      omega: part(omega[i], this.most.omega),
      level: part(tau[i], this.most.tau),
      bare: this.added ? part(tau[i] - this.added[i], this.most.tau) : part(tau[i], this.most.tau),
      torque: this.added ? part(this.added[i], this.most.added) : 0,
      hills: this.hills,
    };
  }
}

/**
 * The work from the lowest position to each, scaled to 0 to 1: the mean torque there, added up.
 * @param {Float32Array} theta
 * @param {Float32Array} torque
 * @param {number} low
 * @param {number} span
 */
export function hillsOf(theta, torque, low, span) {
  const [sum, count] = [new Float32Array(BINS), new Float32Array(BINS)];
  for (let i = 0; i < theta.length; i++) {
    const bin = Math.min(BINS - 1, Math.floor((BINS * (theta[i] - low)) / span));
    if (!(bin >= 0) || torque[i] !== torque[i]) continue;
    sum[bin] += torque[i];
    count[bin]++;
  }
  let [work, last] = [0, 0];
  const found = sum.map((value, bin) => {
    last = count[bin] > 0 ? value / count[bin] : last;
    return (work += last);
  });
  const [least, most] = reach(found);
  return found.map((value) => (most > least ? (value - least) / (most - least) : 0.5));
}

/** @param {Float32Array} values @returns {[number, number]} */
function reach(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/** @param {Float32Array} values */
function largest(values) {
  const [low, high] = reach(values);
  return Math.max(-low, high) || 1;
}

/** The torque that it adds, from the middle up or down. @param {Brush} brush @param {number} torque @param {Look} look */
function bar(brush, torque, { soft, shade, colour }) {
  brush.fillStyle = shade;
  brush.fillRect(240, 6, 14, 108);
  brush.fillStyle = colour;
  brush.fillRect(240, 60, 14, -54 * torque);
  brush.fillStyle = soft;
  brush.fillRect(237, 59, 20, 2);
}

/** @param {Brush} brush @param {number[][]} points */
function line(brush, points) {
  brush.beginPath();
  for (const [x, y] of points) brush.lineTo(x, y);
  brush.stroke();
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function bristles(brush, { along, omega, torque }, { ink, shade, soft, colour }) {
  brush.fillStyle = shade;
  brush.fillRect(0, 92, 230, 28);
  brush.fillRect(0, 8, 230, 34);
  brush.strokeStyle = soft;
  for (let x = -40 + ((240 * along) % 20); x < 230; x += 20) line(brush, [[x + 10, 8], [x + 24, 42]].map(([a, b]) => [Math.max(0, Math.min(230, a)), b]));
  brush.strokeStyle = colour;
  const bent = 16 * Math.sign(omega) * Math.min(1, 0.25 + Math.abs(torque)) * Math.min(1, 20 * Math.abs(omega));
  for (let x = 14; x < 230; x += 18) {
    brush.beginPath();
    brush.moveTo(x, 92);
    brush.quadraticCurveTo(x, 64, x + bent, 44);
    brush.stroke();
  }
  brush.strokeStyle = ink;
  line(brush, [[0, 92], [230, 92]]);
  line(brush, [[0, 42], [230, 42]]);
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function hills(brush, { along, hills: heights }, { ink, soft, colour }) {
  const up = (/** @type {number} */ share) => {
    const bin = Math.min(BINS - 1, Math.max(0, Math.round(share * (BINS - 1))));
    return 100 - 66 * (heights ? heights[bin] : 0.3);
  };
  brush.strokeStyle = heights ? ink : soft;
  line(brush, Array.from({ length: BINS }, (_, bin) => [6 + (218 * bin) / (BINS - 1), up(bin / (BINS - 1))]));
  brush.fillStyle = colour;
  brush.beginPath();
  brush.arc(6 + 218 * along, up(along) - 10, 9, 0, 2 * Math.PI);
  brush.fill();
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function joint(brush, { along, torque }, { ink, shade, colour }) {
  const shaft = 24 + 70 * along;
  const knob = shaft + 84 + 22 * torque;
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  for (const [x, width] of [[shaft, 30], [knob, 44]]) {
    brush.fillRect(x, 34, width, 52);
    brush.strokeRect(x, 34, width, 52);
  }
  brush.strokeStyle = colour;
  const step = (knob - shaft - 30) / 10;
  line(brush, Array.from({ length: 11 }, (_, n) => [shaft + 30 + n * step, n % 10 === 0 ? 60 : n % 2 ? 48 : 72]));
}

/**
 * What drives is a fork around a tongue of what is moved: it touches on the side to which it pushes.
 * @param {Brush} brush @param {Now} now @param {Look} look
 */
function gap(brush, { along, torque, omega }, { ink, shade, colour }) {
  const fork = 20 + 90 * along;
  // It touches where it pushes, and where it pushes nothing lies in the play.
  const side = Math.abs(torque) > FREE ? Math.sign(torque) : 0.6 * Math.sign(omega);
  const tongue = fork + 40 + 12 * side;
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  brush.beginPath();
  for (const [x, y] of [[0, 100], [0, 20], [14, 20], [14, 84], [86, 84], [86, 20], [100, 20], [100, 100]]) brush.lineTo(fork + x, y);
  brush.closePath();
  brush.fill();
  brush.stroke();
  brush.fillRect(tongue, 10, 20, 62);
  brush.strokeRect(tongue, 10, 20, 62);
  if (Math.abs(torque) <= FREE) return;
  brush.fillStyle = colour;
  brush.fillRect(side > 0 ? tongue + 20 : tongue - 4, 30, 4, 12 + 28 * Math.abs(torque));
}

/** A plate over lines of flow. @param {Brush} brush @param {Now} now @param {Look} look */
function fluid(brush, { along, omega, torque }, { ink, shade, colour }) {
  const plate = 20 + 120 * along;
  brush.fillStyle = shade;
  brush.fillRect(0, 50, 230, 70);
  brush.strokeStyle = colour;
  for (let row = 0; row < 5; row++) {
    const y = 60 + 12 * row;
    const way = 70 * omega * (1 - row / 5); // the nearer the plate, the faster it flows along
    line(brush, [[115, y], [115 + way, y]]);
    line(brush, [[115 + way - 4 * Math.sign(way), y - 3], [115 + way, y], [115 + way - 4 * Math.sign(way), y + 3]]);
  }
  brush.fillStyle = shade;
  brush.strokeStyle = ink;
  brush.fillRect(plate, 24, 70, 24);
  brush.strokeRect(plate, 24, 70, 24);
  brush.strokeStyle = colour;
  line(brush, [[plate + 35, 36], [plate + 35 + 30 * torque, 36]]);
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function spring(brush, { along }, { ink, soft, shade, colour }) {
  const end = 70 + 110 * along;
  brush.strokeStyle = soft;
  line(brush, [[6, 96], [226, 96]]);
  brush.strokeStyle = ink;
  line(brush, [[8, 20], [8, 96]]);
  brush.strokeStyle = colour;
  line(brush, Array.from({ length: 15 }, (_, n) => [8 + (n * (end - 8)) / 14, n % 14 === 0 ? 66 : n % 2 ? 50 : 82]));
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  brush.fillRect(end, 38, 40, 56);
  brush.strokeRect(end, 38, 40, 56);
}

/** A wheel with a weight on it, and what it pulls. @param {Brush} brush @param {Now} now @param {Look} look */
function weight(brush, { theta, torque }, { ink, shade, colour }) {
  brush.fillStyle = shade;
  brush.strokeStyle = ink;
  brush.beginPath();
  brush.arc(115, 60, 44, 0, 2 * Math.PI);
  brush.fill();
  brush.stroke();
  const [x, y] = [115 + 30 * Math.cos(theta), 60 - 30 * Math.sin(theta)];
  line(brush, [[115, 60], [x, y]]);
  brush.fillStyle = colour;
  brush.beginPath();
  brush.arc(x, y, 11, 0, 2 * Math.PI);
  brush.fill();
  brush.strokeStyle = colour;
  brush.beginPath();
  brush.arc(115, 60, 54, -Math.PI / 2, -Math.PI / 2 - 1.2 * torque, torque > 0);
  brush.stroke();
}

/** Magnets on what moves, poles below. @param {Brush} brush @param {Now} now @param {Look} look */
function poles(brush, { along, torque }, { ink, soft, shade, colour }) {
  const apart = 46;
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  brush.fillRect(0, 100, 230, 20);
  for (let x = 0; x < 230; x += apart) {
    brush.fillRect(x + 8, 74, 26, 26);
    brush.strokeRect(x + 8, 74, 26, 26);
  }
  const moved = 3 * apart * along; // three poles from end to end, to be followed by the eye
  brush.fillStyle = colour;
  brush.strokeStyle = soft;
  for (let n = -3; n < 5; n++) {
    const x = n * apart + moved;
    const [left, right] = [Math.max(0, x), Math.min(230, x + 30)];
    if (right > left) brush.fillRect(left, 28, right - left, 22);
    if (x > 0 && x < 200) line(brush, [[x + 15, 52], [x + 15 + 14 * torque, 72]]);
  }
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function stops(brush, { along, torque }, { ink, shade, colour }) {
  brush.strokeStyle = ink;
  line(brush, [[6, 96], [226, 96]]);
  brush.fillStyle = shade;
  for (const x of [0, 214]) {
    brush.fillRect(x, 20, 16, 76);
    brush.strokeRect(x, 20, 16, 76);
  }
  const at = 18 + 154 * along;
  brush.fillRect(at, 48, 40, 46);
  brush.strokeRect(at, 48, 40, 46);
  brush.strokeStyle = colour;
  if (torque !== 0) line(brush, [[at + 20, 34], [at + 20 + 40 * torque, 34]]);
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function gauge(brush, { level, bare }, { ink, soft, colour }) {
  brush.strokeStyle = soft;
  brush.beginPath();
  brush.arc(115, 108, 92, Math.PI, 2 * Math.PI);
  brush.stroke();
  for (const [value, needle] of [[bare, soft], [level, colour]]) {
    const way = Math.PI / 2 - 1.3 * Number(value);
    brush.strokeStyle = String(needle);
    line(brush, [[115, 108], [115 + 84 * Math.cos(way), 108 - 84 * Math.sin(way)]]);
  }
  brush.fillStyle = ink;
  brush.fillRect(110, 103, 10, 10);
}

/** @param {Brush} brush @param {Now} now @param {Look} look */
function mass(brush, { theta }, { ink, shade, colour }) {
  brush.fillStyle = shade;
  brush.strokeStyle = ink;
  brush.beginPath();
  brush.arc(115, 60, 50, 0, 2 * Math.PI);
  brush.fill();
  brush.stroke();
  brush.fillStyle = colour;
  for (const turn of [0, 2.094, 4.189]) {
    brush.beginPath();
    brush.arc(115 + 34 * Math.cos(theta + turn), 60 - 34 * Math.sin(theta + turn), 9, 0, 2 * Math.PI);
    brush.fill();
  }
}
