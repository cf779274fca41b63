// src/api.js
var Refusal = class extends Error {
  /** @param {string} words @param {import("./types.js").Why} [more] */
  constructor(words4, { columns, guess, fault, enough } = {}) {
    super(words4);
    this.columns = columns ?? null;
    this.guess = guess ?? {};
    this.fault = fault ?? null;
    this.enough = enough ?? null;
  }
};
function wordsOf(reason2) {
  return reason2 instanceof Error ? reason2.message : String(reason2);
}
var token = new URLSearchParams(location.search).get("token") ?? "";
async function request(path, options = {}) {
  const headers = { ...options.headers, "x-knobcam-token": token };
  let answer;
  try {
    answer = await fetch(path, { ...options, headers });
  } catch (reason2) {
    if (options.signal?.aborted) throw reason2;
    throw new Error("the workbench does not answer; is its command still running?");
  }
  if (answer.ok) return answer;
  const said = await answer.json().catch(() => ({}));
  throw new Refusal(said.error ?? `the workbench answered ${answer.status}`, said);
}
async function ask(what, query = {}) {
  return (await request(`/api/${what}?${new URLSearchParams(query)}`)).json();
}
async function fetchState() {
  const first = document.getElementById("first-state");
  first?.remove();
  return first ? JSON.parse(first.textContent ?? "") : ask("state");
}
async function fetchBytes(path, query, signal) {
  const answer = await request(`${path}?${new URLSearchParams(query)}`, { signal });
  return answer.arrayBuffer();
}
function early(node, capture) {
  if (!("document" in globalThis)) return null;
  const links = (
    /** @type {NodeListOf<HTMLLinkElement>} */
    document.querySelectorAll("link[rel=preload]")
  );
  const link2 = [...links].find(({ href }) => {
    const asked2 = new URL(href).searchParams;
    return asked2.get("node") === node && asked2.get("capture") === capture;
  });
  link2?.remove();
  return link2 ? fetch(link2.href).then((answer) => answer.ok ? answer.arrayBuffer() : Promise.reject(new Refusal(`the workbench answered ${answer.status}`))) : null;
}
async function fetchPicture(effect) {
  return (await request(`/api/picture?${new URLSearchParams({ effect })}`)).blob();
}
async function post(verb, body = {}) {
  const headers = { "content-type": "application/json" };
  const answer = await request(`/api/${verb}`, { method: "POST", headers, body: JSON.stringify(body) });
  return answer.json();
}
async function upload(file, options = {}) {
  const headers = { "content-type": "application/octet-stream", "x-filename": encodeURIComponent(file.name) };
  const query = new URLSearchParams(options);
  return (await request(`/api/upload?${query}`, { method: "POST", headers, body: file })).json();
}
async function download(what) {
  const answer = await request(`/api/download?${new URLSearchParams({ what })}`);
  const named2 = /filename="?([^";]+)"?/.exec(answer.headers.get("content-disposition") ?? "");
  return { name: named2 ? named2[1] : `knobcam-${what}`, blob: await answer.blob() };
}
function listen(heard) {
  const source = new EventSource(`/api/events?${new URLSearchParams({ token })}`);
  source.addEventListener("state", (event) => heard.state(JSON.parse(event.data).revision));
  source.addEventListener("progress", (event) => {
    heard.progress(JSON.parse(event.data));
  });
  source.addEventListener("open", () => heard.connected(true));
  source.addEventListener("error", () => heard.connected(false));
}

// src/dom.js
function make(tag, properties = {}, ...children) {
  const element2 = document.createElement(tag);
  const { text, on = {}, ...attributes } = properties;
  for (const [name2, value] of Object.entries(attributes)) {
    if (value !== null && value !== false && value !== void 0) {
      element2.setAttribute(name2, value === true ? "" : String(value));
    }
  }
  for (const [name2, listener] of Object.entries(on)) element2.addEventListener(name2, listener);
  if (text !== void 0) element2.textContent = text;
  element2.append(...children.filter((child) => child !== null));
  return element2;
}
function byId(id) {
  const element2 = document.getElementById(id);
  if (!element2) throw new Error(`the page has no element ${id}`);
  return element2;
}
function styleValue(name2, element2) {
  return getComputedStyle(element2).getPropertyValue(name2).trim();
}
function shown(element2) {
  for (const fold of element2.querySelectorAll("details")) fold.open = true;
  element2.scrollIntoView({ block: "nearest" });
  element2.classList.remove("shown");
  void element2.offsetWidth;
  element2.classList.add("shown");
}

// src/names.js
var titles = {};
var meanings = {};
function known({ titles: called2, params = [] }) {
  titles = called2;
  meanings = Object.fromEntries(params.map(({ name: name2, meaning }) => [name2, meaning]));
}
function titleOf(effect) {
  return titles[effect] ?? effect;
}
function paramOf(name2) {
  const [effect, ...own] = name2.split(".");
  const [words4] = (meanings[name2] || own.join(".")).split(", ");
  const title = titleOf(effect);
  return words4.includes(title) ? words4 : `${words4} (${title})`;
}
function named(words4, id) {
  return make("span", { text: words4, title: words4 === id ? null : id });
}
function listed(effects, between3) {
  return effects.flatMap((effect, at) => [at > 0 ? between3 : "", named(titleOf(effect), effect)]);
}
function changeOf({ added, along, dropped }) {
  const came = added ? [`+ ${[titleOf(added), ...along.map(titleOf)].join(" with ")}`] : [];
  return [...came, ...dropped.map((one) => `− ${titleOf(one)}`)].join(" ");
}

// src/numbers.js
function number(value, digits = 3) {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(digits - 1) : plain(value, digits);
  return text.replaceAll("-", "−");
}
function figure(value, digits = 3) {
  const size = Math.abs(Number((value ?? NaN).toPrecision(digits)));
  return value !== null && size >= 1e-3 && size < 10 ** digits ? value.toPrecision(digits).replaceAll("-", "−") : number(value, digits);
}
function asKnown(value, half) {
  if (!(half > 0)) return number(value, 4);
  const place4 = Math.floor(Math.log10(Number(half.toPrecision(2)))) - 1;
  const size = Math.max(Math.abs(value), half);
  const text = size < 1e-3 || size >= 1e5 ? value.toExponential(Math.max(0, Math.floor(Math.log10(Math.abs(value) || size)) - place4)) : fixed(value, place4);
  return text.replaceAll("-", "−");
}
function fixed(value, place4) {
  return place4 > 0 ? String(Math.round(value / 10 ** place4) * 10 ** place4) : value.toFixed(Math.min(12, -place4));
}
function plain(value, digits) {
  return String(Number(value.toPrecision(digits)));
}
function thousands(many) {
  return String(many).replace(/\B(?=(\d{3})+$)/g, ",");
}
function percent(share) {
  if (!Number.isFinite(share)) return "–";
  const text = (100 * share).toFixed(Math.abs(share) < 0.1 ? 1 : 0);
  return `${Number(text) === 0 ? "0" : text} %`.replaceAll("-", "−");
}
function torqueScale({ unit, peak }) {
  return unit === "N m" && peak <= 2 ? { factor: 1e3, unit: "mNm" } : { factor: 1, unit };
}
var SHORT = { "N s^2/m": "kg", "N m s^2/rad": "kg m²", 1: "" };
function unitWords(unit) {
  return SHORT[unit] ?? unit.replaceAll("^2", "²").replaceAll("^3", "³");
}
function unitOf(unit, torque) {
  return unit.replace(/^N(?: m)?(?=[ /]|$)/, torque);
}
function scaleOf(unit, about2) {
  const torque = torqueScale(about2);
  const own = !(unit in SHORT) && (unit === about2.unit || unit.startsWith(`${about2.unit} `) || unit.startsWith(`${about2.unit}/`));
  return own ? { factor: torque.factor, unit: unit.replace(about2.unit, torque.unit) } : { factor: 1, unit };
}
function torqueWord(unit) {
  const words4 = { N: "force", A: "current", V: "voltage", duty: "duty cycle" };
  return words4[unit] ?? "torque";
}
function motionWords({ coordinate }) {
  const [place4, way] = coordinate === "linear" ? ["position", "m"] : ["angle", "rad"];
  return {
    theta: { name: place4, unit: way },
    omega: { name: "velocity", unit: `${way}/s` },
    alpha: { name: "acceleration", unit: unitWords(`${way}/s^2`) }
  };
}
function ticks(low, high, count) {
  const span4 = high - low;
  if (!(span4 > 0) || !Number.isFinite(span4)) return [];
  const rough = span4 / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const steps = [10, 5, 2, 1].map((factor2) => factor2 * power);
  const wide = steps.findLastIndex((step) => step >= rough);
  const scales = steps.slice(wide).map((step) => {
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, at) => (first + at) * step);
  });
  return scales.find((marks) => marks.length > 1) ?? scales[scales.length - 1];
}

// src/branches.js
function comparable({ branches, branch: current, active }, branch) {
  const other = branches.find(({ id }) => id === branch && id !== current);
  return other !== void 0 && other.steps[other.at]?.captures.join() === active.join();
}
function showBranches(place4, state, beside2, deeds) {
  const focused = document.activeElement?.getAttribute("data-beside");
  const scale = torqueScale(state);
  const cards = state.branches.map(({ id, name: name2, steps, at }) => {
    const step = steps[at];
    const done = steps.slice(0, at + 1);
    const own = done.slice(done.findLastIndex(({ anew }) => anew));
    const changed = own.filter(({ added, dropped }) => added || dropped.length > 0);
    const changes = changed.map(changeOf);
    const words4 = changes.join(" ") || "nothing added";
    const card = make(
      "button",
      {
        ...{ type: "button", class: "branch", "aria-pressed": String(id === state.branch), "data-branch": id },
        on: { click: () => deeds.choose(id) }
      },
      make("strong", { text: name2 }),
      make("span", { class: "soft", text: words4 }),
      make("span", { class: "figure", text: step ? `${number(step.rmse * scale.factor)} ${scale.unit}` : "–" })
    );
    if (id === state.branch) return make("div", { class: "card" }, card);
    const there = comparable(state, id);
    const box = make("input", {
      ...{ type: "checkbox", checked: id === beside2, "data-beside": id, disabled: !there },
      ...{ title: there ? null : "it is fitted to other captures, or to the same read otherwise" },
      on: { change: () => deeds.beside(id === beside2 ? null : id) }
    });
    return make("div", { class: "card" }, card, make("label", {}, box, " side by side"));
  });
  place4.replaceChildren(...cards);
  if (focused) {
    place4.querySelector(`[data-beside="${CSS.escape(focused)}"]`)?.focus();
  }
}
function capturesOf(node, { branches, active }) {
  return branches.flatMap(({ steps }) => steps).find((step) => step.node === node)?.captures ?? active;
}

// src/spectrum.js
var SEEN = 1e-3;
var LEAST = 0.02;
function spectrumOf(split) {
  if (!split) return null;
  const level2 = split.band.map((value) => value ?? 0);
  const highest = Math.max(...level2);
  const middle = split.low.map((low, at) => (low + split.high[at]) / 2);
  const shown2 = [...middle.keys()].filter((at) => middle[at] > 0 && level2[at] > SEEN * highest);
  if (shown2.length < 2) return null;
  const levels = shown2.map((at) => level2[at]).sort((a, b) => a - b);
  const least = LEAST * levels[levels.length >> 1];
  return {
    x: shown2.map((at) => Math.log10(middle[at])),
    y: shown2.map((at) => Math.log10(Math.max(split.mean[at], least))),
    chance: shown2.map((at) => Math.log10(level2[at]))
  };
}
function drawSpectrum(brush, { x, y, chance }, { across, up, bottom }, colours) {
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

// src/axes.js
var MARGIN = { left: 52, right: 10, top: 22, bottom: 34 };
function drawAxes(brush, size, { x, y, title, colours, noise, bins, spectrum }) {
  const { left, top } = MARGIN;
  const [right, bottom] = [size.width - MARGIN.right, size.height - MARGIN.bottom];
  brush.clearRect(0, 0, size.width, size.height);
  brush.font = "11px system-ui, 'DejaVu Sans', sans-serif";
  brush.lineWidth = 1;
  const across = (value) => left + (value - x.low) / (x.high - x.low) * (right - left);
  const up = (value) => bottom - (value - y.low) / (y.high - y.low) * (bottom - top);
  brush.strokeStyle = colours.line;
  brush.fillStyle = colours.soft;
  brush.textAlign = "center";
  brush.textBaseline = "top";
  for (const [value, text] of ticksOf(x, (right - left) / 70)) {
    const at = Math.round(across(value)) + 0.5;
    stroke(brush, at, top, at, bottom);
    brush.fillText(text, at, bottom + 4);
  }
  brush.textAlign = "right";
  brush.textBaseline = "middle";
  for (const [value, text] of ticksOf(y, (bottom - top) / 32)) {
    const at = Math.round(up(value)) + 0.5;
    stroke(brush, left, at, right, at);
    brush.fillText(text, left - 5, at);
  }
  if (noise) {
    brush.save();
    brush.strokeStyle = colours.ink;
    brush.setLineDash([5, 4]);
    for (const value of [-noise, noise]) {
      const at = Math.round(up(value)) + 0.5;
      if (at > top && at < bottom) stroke(brush, left, at, right, at);
    }
    brush.restore();
  }
  if (bins || spectrum) {
    brush.save();
    brush.beginPath();
    brush.rect(left, top, right - left, bottom - top);
    brush.clip();
    if (bins) drawBins(brush, bins, across, up, colours);
    if (spectrum) drawSpectrum(brush, spectrum, { across, up, bottom }, colours);
    brush.restore();
  }
  brush.strokeStyle = colours.soft;
  stroke(brush, left + 0.5, top, left + 0.5, bottom);
  stroke(brush, left, bottom + 0.5, right, bottom + 0.5);
  brush.textAlign = "right";
  brush.textBaseline = "bottom";
  brush.fillText(x.label, right, size.height - 2);
  const font = brush.font;
  brush.fillStyle = colours.ink;
  brush.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
  brush.fillText(title, right, top - 4);
  const room = right - brush.measureText(title).width - 16;
  brush.fillStyle = colours.soft;
  brush.font = font;
  brush.textAlign = "left";
  brush.fillText(labelWithin(y.label, room, (text) => brush.measureText(text).width), 4, top - 5, Math.max(room, 24));
}
function labelWithin(label, room, widthOf) {
  return widthOf(label) <= room ? label : label.slice(label.indexOf(", ") + 1).trim();
}
function tickWords(value) {
  return number(value, 6).replace(/\.?0+e/, "e");
}
function ticksOf({ low, high, factor: factor2, log }, count) {
  if (!log) return ticks(low * factor2, high * factor2, count).map((value) => [value / factor2, tickWords(value)]);
  const few = count / (high - low) >= 3 ? [1, 2, 5] : [1];
  const decades = Array.from({ length: Math.ceil(high) - Math.floor(low) + 1 }, (_, at) => 10 ** (Math.floor(low) + at));
  const shift = Math.log10(factor2);
  return decades.flatMap((decade) => few.map((digit) => digit * decade)).map((value) => (
    /** @type {[number, string]} */
    [Math.log10(value) - shift, number(value, 1)]
  )).filter(([at]) => at >= low && at <= high);
}
function drawBins(brush, bins, across, up, { ink, band: band2 }) {
  const edges = bins.low.map((low, at) => [across(low), across(bins.high[at])]);
  brush.globalAlpha = 0.35;
  brush.fillStyle = band2;
  for (const [at, [from, to]] of edges.entries()) {
    const half = bins.band[at];
    if (half) brush.fillRect(from, up(half), to - from, up(-half) - up(half));
  }
  brush.globalAlpha = 1;
  brush.strokeStyle = ink;
  brush.lineWidth = 2;
  for (const [at, [from, to]] of edges.entries()) {
    brush.setLineDash(bins.direction[at] < 0 ? [3, 2] : []);
    stroke(brush, from, up(bins.mean[at]), to, up(bins.mean[at]));
  }
}
function stroke(brush, x0, y0, x1, y1) {
  brush.beginPath();
  brush.moveTo(x0, y0);
  brush.lineTo(x1, y1);
  brush.stroke();
}
function limits(columns, { air = 0.03, around = NaN } = {}) {
  let [low, high] = [Infinity, -Infinity];
  for (const column of columns) {
    for (let i = 0; i < column.length; i++) {
      if (column[i] < low) low = column[i];
      if (column[i] > high) high = column[i];
    }
  }
  if (around < low) low = around;
  if (around > high) high = around;
  if (!(low <= high)) return [-1, 1];
  const room = high > low ? air * (high - low) : Math.abs(low) || 1;
  return [low - room, high + room];
}

// src/remembered.js
function remembered(work) {
  const known2 = /* @__PURE__ */ new WeakMap();
  return (key2, ...others) => {
    const before = known2.get(key2);
    if (before && before.others.every((one, at) => one === others[at])) return before.told;
    const told = work(key2, ...others);
    known2.set(key2, { others, told });
    return told;
  };
}

// src/outliers.js
var TIMES = 2;
var SHARE = 2e-4;
var FEW = 3;
var mostReach = remembered((values) => {
  const few = Math.max(FEW, SHARE * values.length);
  for (let reach2 = Infinity; ; ) {
    let [most, beyond] = [0, 0];
    for (let i = 0; i < values.length; i++) {
      const size = Math.abs(values[i]);
      if (size <= reach2 && size > most) most = size;
    }
    for (let i = 0; i < values.length; i++) if (Math.abs(values[i]) > most / TIMES) beyond++;
    if (most === 0 || beyond > few) return most;
    reach2 = most / TIMES;
  }
});
var mostLimits = remembered((one, other) => {
  const columns = [one, other];
  const few = Math.max(FEW, SHARE * columns[0].length);
  let [low, high] = within(columns, -Infinity, Infinity);
  const whole = (
    /** @type {[number, number]} */
    [low, high]
  );
  while (low < high) {
    const quarter = 0.25 * (high - low);
    let [above, below] = [0, 0];
    for (const y of columns) {
      for (let i = 0; i < y.length; i++) {
        if (y[i] > high - quarter) above++;
        else if (y[i] < low + quarter) below++;
      }
    }
    if (above > few && below > few) break;
    [low, high] = within(columns, below > few ? low : low + quarter, above > few ? high : high - quarter);
  }
  return whole[1] - whole[0] > TIMES * (high - low) ? [low, high] : whole;
});
function within(columns, low, high) {
  let [least, most] = [Infinity, -Infinity];
  for (const y of columns) {
    for (let i = 0; i < y.length; i++) {
      if (y[i] < low || y[i] > high) continue;
      if (y[i] < least) least = y[i];
      if (y[i] > most) most = y[i];
    }
  }
  return least <= most ? [least, most] : [NaN, NaN];
}
function beyondWords(y, low, high) {
  let count = 0;
  for (let i = 0; i < y.length; i++) if (y[i] < low || y[i] > high) count++;
  return count === 0 ? "" : ` (${thousands(count)} ${count === 1 ? "sample" : "samples"} beyond, at the edge)`;
}

// src/contents.js
var AXES = (
  /** @type {Record<Along, AxisOf>} */
  {
    position: { words: "position", column: "theta", part: "position_part", units: ["rad", "m"] },
    velocity: { words: "velocity", column: "omega", part: "velocity_part", units: ["rad/s", "m/s"] },
    acceleration: { words: "acceleration", column: "alpha", part: null, units: ["rad/s²", "m/s²"] },
    load: { words: "modelled torque", column: null, part: null, units: null },
    history: { words: "distance since reversal", column: "history", part: null, units: ["rad", "m"] },
    time: { words: "time", column: "t", part: null, units: ["s", "s"] },
    frequency: { words: "frequency", column: null, part: null, units: ["Hz", "Hz"] }
  }
);
var USUAL = ["position", "velocity", "time"];
var NAME = 32;
function columnsOf(view) {
  const needed = ["t", "theta", "omega", "tau", "residual"];
  for (const { column } of view.axes.map((along) => AXES[along])) if (column && !needed.includes(column)) needed.push(column);
  if (view.axes.includes("time")) needed.push("masked");
  if (view.isolated) needed.push("position_part", "velocity_part");
  if (view.band) needed.push("band");
  return needed;
}
function reachOf({ columns, beside: beside2, noise }) {
  const shown2 = beside2 ? [columns.residual, beside2.residual] : [columns.residual];
  return Math.max(...shown2.map((one) => mostReach(one)), 2 * (noise ?? 0)) || 1;
}
function rowsOf(data, view, widest) {
  const { columns, beside: beside2 } = data;
  const word = torqueWord(data.unit);
  const slow = data.below_hz ? ` below ${number(data.below_hz)} Hz` : "";
  const model = modelOf(columns.residual, columns.tau);
  const fitted = counted(model, columns.tau);
  const unfitted = notCounted(fitted, columns.tau, columns.masked ?? fitted);
  const other = beside2 ? modelOf(beside2.residual, columns.tau) : null;
  const scale = torqueScale(data);
  const [ownLabel, besideLabel] = [columns, beside2].map((one) => one ? `residual, ${scale.unit}${beyondWords(one.residual, -1.04 * widest, 1.04 * widest)}` : "");
  return view.axes.map((along) => {
    if (along === "frequency") return { torque: null, residual: alongFrequency(data), beside: null };
    const axis2 = AXES[along];
    const x = axis2.column ? columns[axis2.column] : model;
    const common = { x, xAxis: axisOf(along, along === "time" ? span(x) : spanOf(model)(x), data), picked: 0 };
    const part = view.isolated && axis2.part ? columns[axis2.part] : null;
    const { measured: measured2, modelled } = part ? isolated(columns, part) : { measured: fitted, modelled: model };
    const series = [
      ...along === "time" ? [{ colour: "--masked", chosen: "--chosen", y: unfitted, strength: 1 }] : [],
      { colour: "--measured", chosen: "--chosen", y: measured2, strength: 0.4 },
      ...view.band && columns.band ? band(modelled, columns.band) : [],
      ...other && !part ? [{ colour: "--beside", chosen: "--beside", y: other, strength: 0.35 }] : [],
      { colour: "--modelled", chosen: "--modelled", y: modelled, strength: 0.35 }
    ];
    const [lowest, highest] = limits([Float32Array.from(mostLimits(modelled, measured2))]);
    const torque = {
      ...common,
      picked: series.findIndex(({ colour }) => colour === "--measured"),
      // what is not fitted is not taken by a brush
      xAxis: { ...common.xAxis, label: "" },
      // where it is chosen it stands already
      yAxis: { low: lowest, high: highest, factor: scale.factor, label: `${word}${slow}, ${scale.unit}${beyondWords(measured2, lowest, highest)}` },
      title: part ? `what depends on ${along} alone` : `${word} over ${axisWord(along, data.unit)}`,
      series,
      noise: null
    };
    const rest = (y, label, colour, title) => ({
      ...common,
      yAxis: { low: -1.04 * widest, high: 1.04 * widest, factor: scale.factor, label },
      title,
      series: [{ colour, chosen: "--chosen", y, strength: 0.3 }],
      noise: data.noise && 2 * data.noise
    });
    const own = beside2 && data.name ? `residual, ${short(data.name)}` : "measured − modelled";
    return {
      torque,
      residual: rest(columns.residual, ownLabel, "--wrong", own),
      beside: beside2 ? rest(beside2.residual, besideLabel, "--beside", `residual, ${short(beside2.name)}`) : null
    };
  });
}
function alongFrequency({ splits, unit, peak, fitted }) {
  const spectrum = spectrumOf(splits?.find(({ axis: axis2 }) => axis2 === "frequency"));
  const [least, most] = spectrum ? limits([spectrum.y, spectrum.chance].map((one) => Float32Array.from(one))) : [-4, -2];
  const [low, high] = spectrum ? [spectrum.x[0], spectrum.x[spectrum.x.length - 1]] : [0, 3];
  const scale = torqueScale({ unit, peak });
  return {
    ...{ x: new Float32Array(0), series: [], picked: 0, noise: null, spectrum },
    title: fitted ? "residual over frequency, beside what chance stays below" : "over frequency: of a fit only",
    xAxis: { low, high, factor: 1, label: "", log: true },
    yAxis: { low: least, high: most, factor: scale.factor, label: `RMS per bin, ${scale.unit}`, log: true }
  };
}
function axisOf(along, [low, high], data) {
  return { low, high, factor: 1, label: labelOf(along, data) };
}
function axisWord(along, unit) {
  return along === "load" ? `modelled ${torqueWord(unit)}` : AXES[
    /** @type {Along} */
    along
  ]?.words ?? along;
}
function labelOf(along, { unit, coordinate }) {
  const { units } = AXES[along];
  return `${axisWord(along, unit)}, ${units ? units[coordinate === "linear" ? 1 : 0] : unit}`;
}
function samplesIn({ columns }, { axis: axis2, low, high, direction }) {
  if (axis2 === "frequency") return null;
  const { column } = AXES[axis2];
  const x = column ? columns[column] : modelOf(columns.residual, columns.tau);
  const found2 = [];
  for (let i = 0; i < x.length; i++) {
    const counts = columns.residual[i] === columns.residual[i] && x[i] >= low && x[i] <= high;
    if (counts && (direction === 0 || Math.sign(columns.omega[i]) === direction)) found2.push(i);
  }
  return Uint32Array.from(found2);
}
var modelOf = remembered((residual, tau) => {
  const model = new Float32Array(tau.length);
  for (let i = 0; i < tau.length; i++) model[i] = tau[i] - residual[i];
  return model;
});
function counted(model, tau) {
  const known2 = lastCounted.get(tau);
  if (known2 && sameGaps(known2, tau, model)) return known2;
  const found2 = new Float32Array(tau.length);
  for (let i = 0; i < tau.length; i++) found2[i] = model[i] === model[i] ? tau[i] : NaN;
  lastCounted.set(tau, found2);
  return found2;
}
var lastCounted = /* @__PURE__ */ new WeakMap();
function sameGaps(found2, tau, model) {
  for (let i = 0; i < tau.length; i++) if (tau[i] === tau[i] && found2[i] === found2[i] !== (model[i] === model[i])) return false;
  return true;
}
var notCounted = remembered((fitted, tau, masked) => {
  const found2 = new Float32Array(tau.length);
  for (let i = 0; i < tau.length; i++) found2[i] = fitted[i] === fitted[i] ? NaN : masked[i] === masked[i] ? masked[i] : tau[i];
  return found2;
});
var AIR = 0.01;
var span = remembered((x) => limits([x], { air: AIR }));
var spanOf = remembered(
  (model) => remembered((x) => {
    let [low, high] = [NaN, NaN];
    for (let i = 0; i < x.length; i++) {
      if (model[i] !== model[i]) continue;
      if (!(x[i] >= low)) low = x[i] === x[i] ? x[i] : low;
      if (!(x[i] <= high)) high = x[i] === x[i] ? x[i] : high;
    }
    return limits([Float32Array.of(low, high)], { air: AIR });
  })
);
function short(name2) {
  return name2.length > NAME ? `${name2.slice(0, NAME)}…` : name2;
}
function isolated({ residual }, part) {
  return { measured: part.map((value, i) => value + residual[i]), modelled: part };
}
function band(modelled, half) {
  return [-1, 1].map((side) => ({
    colour: "--band",
    chosen: null,
    y: modelled.map((value, i) => value + side * half[i]),
    strength: 0.6
  }));
}

// src/said.js
function aboutOf({ unit, peak, captures, active }) {
  return { unit, peak, coordinate: captures.find(({ id }) => active.includes(id))?.coordinate ?? "rotary" };
}
var DIRECTIONS = /* @__PURE__ */ new Map([[1, " forward"], [-1, " backward"]]);
var AGAIN = "open the file once more and";
var WAYS = {
  columns: `if a column is something else, ${AGAIN} say which is which`,
  unit: `if it is in another unit, ${AGAIN} choose that`,
  minus: `${AGAIN} write a minus before that column`,
  unwrap: `if the angle wraps around, ${AGAIN} write unwrap(…) around that column`,
  parts: "if the log was joined, open its parts as files of their own",
  drive: "if that is the drive's limit, switch it off",
  command: ""
};
function wordsOfPart(part, about2) {
  if (typeof part === "string") return part.replaceAll(/(?<=^|[\s(])-(?=\d)/g, "−").replaceAll("<=", "≤");
  if ("text" in part) return measured(part, about2);
  if ("low" in part) return stretch(part, about2);
  if ("along" in part) return axisWord(part.along, about2.unit);
  if ("effect" in part) return titleOf(part.effect);
  if ("param" in part) return paramOf(part.param);
  if ("column" in part) return columnWord(part.column, about2);
  if ("topic" in part) return part.words;
  return adviceOf(part);
}
function sentence(parts, about2) {
  return parts.map((part) => wordsOfPart(part, about2)).join("");
}
function nodes(parts, about2) {
  return parts.map((part) => {
    const words4 = wordsOfPart(part, about2);
    if (typeof part === "object" && "effect" in part) return named(words4, part.effect);
    return typeof part === "object" && "param" in part ? named(words4, part.param) : words4;
  });
}
function adviceOf({ advice, way }) {
  return WAYS[way] ?? advice;
}
function measured({ value, unit, text }, about2) {
  const scale = scaleOf(unit, about2);
  const shown2 = scale.factor === 1 ? text.replaceAll("-", "−") : number(value * scale.factor);
  return `${shown2} ${unbroken(scale.unit)}`;
}
function stretch({ ends: ends2, unit, direction, words: words4 }, about2) {
  if (words4) return words4;
  const scale = scaleOf(unit, about2);
  const [from, to] = ends2.map((end) => number(end * scale.factor, 4));
  return `${from} to ${to} ${unbroken(scale.unit)}${DIRECTIONS.get(direction) ?? ""}`;
}
function unbroken(unit) {
  return unitWords(unit).replaceAll(" ", " ");
}
function columnWord(column, about2) {
  const { theta, omega, alpha } = motionWords(about2);
  const words4 = { t: "time", theta: theta.name, omega: omega.name, alpha: alpha.name, tau: torqueWord(about2.unit) };
  return words4[column] ?? column;
}

// src/captures.js
var FEW2 = 2;
var SHORT2 = 5;
var PLURAL = { note: "notes", warning: "warnings" };
function showCaptures(place4, state, { use, close }) {
  const { captures, active } = state;
  const about2 = aboutOf(state);
  const key2 = JSON.stringify([captures, active, about2]);
  if (place4.dataset.shown === key2) return;
  place4.dataset.shown = key2;
  if (captures.length === 1) {
    const [only] = captures;
    place4.replaceChildren(make("span", { class: "capture", title: `${only.name}:${facts(only)}` }, ...words(only, about2, only.name), make("span", { class: "facts", text: facts(only) })));
    return;
  }
  const short2 = shortNames(captures.map(({ name: name2 }) => name2));
  const toggled = (id) => active.includes(id) ? active.filter((one) => one !== id) : [...active, id];
  const buttons = captures.map((capture, at) => {
    const alone = active.length === 1 && active[0] === capture.id;
    const chosen = make(
      "button",
      {
        ...{ type: "button", class: "capture", title: `fit to ${capture.name} too, or not:${facts(capture)}` },
        "aria-pressed": String(active.includes(capture.id)),
        disabled: alone,
        on: { click: () => use(toggled(capture.id)) }
      },
      ...words(capture, about2, short2[at])
      // beside others there is no room for more
    );
    const away = make("button", {
      ...{ type: "button", class: "away", text: "×", "aria-label": `close ${capture.name}`, disabled: alone },
      ...{ title: alone ? "the model is fitted to it alone" : `close ${capture.name}`, on: { click: () => close(capture.id) } }
    });
    return make("span", { class: "held-capture" }, chosen, away);
  });
  place4.replaceChildren(...buttons);
  buttons[captures.findIndex(({ id }) => active.includes(id))]?.scrollIntoView({ block: "nearest", inline: "nearest" });
}
function sharedHead(names) {
  const [first = "", ...others] = names;
  let alike = 0;
  while (alike < first.length && others.every((name2) => name2[alike] === first[alike])) alike++;
  const word = /^.*[-_ .]/.exec(first.slice(0, alike))?.[0].length ?? 0;
  return alike < first.length && names.every((name2) => name2.length > word) && word > SHORT2 ? word : 0;
}
function shortNames(names) {
  const shared = sharedHead(names);
  if (shared === 0) return names;
  const kind = /\.\w+$/.exec(names[0])?.[0] ?? "";
  const alike = names.every((name2) => name2.endsWith(kind) && name2.length > shared + kind.length);
  return names.map((name2) => `…${name2.slice(shared, alike ? name2.length - kind.length : name2.length)}`);
}
function facts({ samples, rate_hz }) {
  return ` ${thousands(samples)} samples, ${Math.round(rate_hz)} Hz`;
}
function words({ findings }, about2, name2) {
  const doubtful = findings.filter((one) => !isNote(one));
  const doubt = make("span", { class: "doubt", text: "⚠ ", title: doubtful.map((one) => textOf(one, about2)).join("\n") });
  return [...doubtful.length > 0 ? [doubt] : [], make("strong", { text: name2 })];
}
var isNote = ({ severity, overruled }) => severity === "note" && !overruled;
function textOf({ severity, said, advice }, about2) {
  const way = advice && adviceOf(advice);
  return `${severity}: ${sentence(said, about2)}${way ? `; ${way}` : ""}`;
}
function showFindings(place4, { captures, active, limitations, disagreements, notes, job }, about2, deeds) {
  const key2 = JSON.stringify([captures, active, limitations, disagreements, notes, about2, job === null]);
  if (place4.dataset.shown === key2) return;
  place4.dataset.shown = key2;
  const focused = document.activeElement?.getAttribute("data-finding");
  const fitted = captures.filter(({ id }) => active.includes(id));
  const every = alikeInAll(fitted);
  const short2 = new Map(shortNames(fitted.map(({ name: name2 }) => name2)).map((name2, at) => [fitted[at].id, name2]));
  const [several, all] = [fitted.length > 1, { id: "", name: "all: ", job }];
  const apart2 = fitted.map((one) => ({ ...one, findings: one.findings.filter((found3) => !isNote(found3) || !every.has(keyOf(found3))) }));
  const told = [...apart2.flatMap(({ findings }) => findings), ...every.values()];
  const found2 = apart2.flatMap(({ id, findings }) => {
    const own2 = [...findings.filter((one) => !isNote(one)), ...findings.filter(isNote)];
    return own2.map((one) => finding(one, { id, name: several ? `${short2.get(id)}: ` : "", job }, about2, deeds));
  });
  found2.push(...[...every.values()].map((one) => finding(one, all, about2, deeds)));
  const openOnes = new Set([...place4.querySelectorAll("details[data-at][open]")].map((one) => one.getAttribute("data-at")));
  const missing = limitations.map(({ said, sharpen }) => make("li", { class: "soft" }, "Cannot be told: ", ...nodes(said, about2), ...sharpening(sharpen, deeds.sharpen)));
  const apartFrom = disagreements.map((one, at) => disagreement(one, about2, at, openOnes.has(String(at))));
  const noted = notes.map((text) => make("li", { class: "doubt", text: `⚠ ${text}` }));
  const open = place4.querySelector("details:not([data-at])")?.hasAttribute("open") ?? false;
  const own = waits(told) ? [folded(found2, told, open)] : found2;
  place4.replaceChildren(...noted, ...apartFrom, ...missing, ...own);
  const again = focused && place4.querySelector(`[data-finding="${CSS.escape(focused)}"]`);
  if (again instanceof HTMLElement) again.focus();
}
function sharpening(param, sharpen) {
  if (param === null) return [];
  const title = `the motion that makes it known best: ${paramOf(param)}`;
  return [". ", make("button", { type: "button", text: "Design that motion…", title, on: { click: () => sharpen(param) } })];
}
function disagreement({ param, said }, about2, at, open) {
  const summary = make("summary", { class: "doubt" }, "⚠ The captures disagree: ", named(paramOf(param), param));
  return make("li", {}, make("details", { open, "data-at": String(at) }, summary, make("p", { class: "doubt" }, ...nodes(said, about2), ".")));
}
function alikeInAll([first, ...others]) {
  if (!first || others.length === 0) return /* @__PURE__ */ new Map();
  const alike = first.findings.filter(
    (note) => isNote(note) && !note.seen && others.every(({ findings }) => findings.some((one) => isNote(one) && keyOf(one) === keyOf(note)))
  );
  return new Map(alike.map((one) => [keyOf(one), one]));
}
var keyOf = ({ said }) => JSON.stringify(said);
function waits(told) {
  return told.length > FEW2 || told.length > 0 && told.every(isNote);
}
function countedWords(told) {
  const kinds = told.map(({ severity, overruled }) => overruled ? "overruled" : severity);
  const counted2 = [...new Set(kinds)].map((kind) => (
    /** @type {const} */
    [kind, kinds.filter((one) => one === kind).length]
  ));
  const words4 = counted2.map(([kind, many]) => `${many} ${many > 1 ? PLURAL[kind] ?? kind : kind}`).join(", ");
  return told.every(isNote) ? `${words4} on the log` : `${isDoubtful(told) ? "⚠ " : ""}${told.length} findings: ${words4}`;
}
var isDoubtful = (told) => told.some((one) => !isNote(one) && !one.overruled);
function folded(items, told, open) {
  const summary = make("summary", { class: isDoubtful(told) ? "doubt" : "soft", text: countedWords(told) });
  return make("li", {}, make("details", { open }, summary, make("ul", {}, ...items)));
}
function finding(found2, { id, name: name2, job }, about2, { see, overrule }) {
  const { key: key2, overruled, stands, seen: seen2 } = found2;
  const [text, note] = [textOf(found2, about2), isNote(found2)];
  const said = `${note || overruled ? "" : "⚠ "}${name2}${text}`;
  const words4 = seen2 ? make("button", { type: "button", class: "leads", title: "show its samples", text: said, on: { click: () => see(id, key2) } }) : make("span", { text: said });
  const box = make("input", {
    ...{ type: "checkbox", role: "switch", checked: !overruled, disabled: stands !== "", "data-finding": `${name2}${key2}` },
    "aria-label": `applied: ${name2}${text}`,
    // While something is done it waits, but keeps the focus.
    ...{ "aria-disabled": job !== null ? "true" : null },
    on: { click: (event) => job !== null && event.preventDefault(), change: () => overrule(id, key2, !overruled) }
  });
  const why = stands || "off: nothing is done about it, the samples are taken as they were recorded, and the model is fitted anew";
  const own = note ? null : make("label", { title: why }, box, overruled ? "overruled" : "applied");
  return make("li", { class: `finding ${note || overruled ? "soft" : "doubt"}` }, words4, own);
}
async function samplesOf(capture, finding2, { captures, active }) {
  const before = active.slice(0, active.indexOf(capture));
  const start = before.reduce((sum, one) => sum + (captures.find(({ id }) => id === one)?.samples ?? 0), 0);
  const { runs } = await ask("finding", { capture, finding: finding2 });
  return Uint32Array.from(runs.flatMap(([first, last]) => Array.from({ length: last - first + 1 }, (_, at) => start + first + at)));
}

// src/formula.js
var LETTERS = /* @__PURE__ */ new Set(["alpha", "delta", "theta", "mu", "sigma", "tau", "psi", "omega", "pi"]);
var WRITTEN = {
  abs: (of) => `\\left|${of}\\right|`,
  exp: (of) => `e^{${of}}`,
  sign: (of) => `\\operatorname{sgn}${bracketed(of)}`
};
var FUNCTIONS = /* @__PURE__ */ new Set(["sin", "cos", "tan", "log", "tanh", "min", "max"]);
function latexOf(law) {
  const tokens = law.match(/dv\/dt\b|[A-Za-z_]\w*|\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+|\S/g) ?? [];
  try {
    const reader = new Reader(tokens);
    const { tex } = reader.sum();
    return reader.at === tokens.length ? tex : null;
  } catch {
    return null;
  }
}
var Reader = class {
  /** @param {string[]} tokens */
  constructor(tokens) {
    this.tokens = tokens;
    this.at = 0;
  }
  /** Whether a token is next, which is taken then. @param {string} wanted */
  took(wanted2) {
    if (this.tokens[this.at] !== wanted2) return false;
    this.at++;
    return true;
  }
  /** @param {string} wanted */
  take(wanted2) {
    if (!this.took(wanted2)) throw new Error(`${wanted2} is missing`);
  }
  /** @returns {Part} */
  sum() {
    let found2 = this.product();
    for (; ; ) {
      const sign = this.took("+") ? "+" : this.took("-") ? "-" : "";
      if (!sign) return found2;
      found2 = { tex: `${found2.tex} ${sign} ${factor(this.product())}`, kind: "sum" };
    }
  }
  /** @returns {Part} */
  product() {
    if (this.took("-")) return { tex: `-${factor(this.product())}`, kind: "sum" };
    let found2 = this.power();
    for (; ; ) {
      if (this.took("/")) {
        const below = this.power();
        found2 = { tex: `\\frac{${found2.bare ?? found2.tex}}{${below.bare ?? below.tex}}`, kind: "product" };
      } else if (this.took("*") || /^[\w.(]/.test(this.tokens[this.at] ?? "")) {
        const more = this.power();
        const between3 = /^[\d.]/.test(more.tex) ? "\\cdot " : "\\,";
        found2 = { tex: `${factor(found2)}${between3}${factor(more)}`, kind: "product" };
      } else {
        return found2;
      }
    }
  }
  /** @returns {Part} */
  power() {
    const base = this.atom();
    if (!this.took("^")) return base;
    const high = this.tokens[this.at] === "-" ? this.product() : this.power();
    return { tex: `${base.kind === "atom" ? base.tex : bracketed(base.bare ?? base.tex)}^{${high.bare ?? high.tex}}`, kind: "product" };
  }
  /** @returns {Part} */
  atom() {
    const token2 = this.tokens[this.at++] ?? "";
    if (token2 === "(") {
      const within4 = this.sum();
      this.take(")");
      return { ...within4, bare: within4.tex };
    }
    if (token2 === "|") {
      const within4 = this.sum();
      this.take("|");
      return { tex: `\\left|${within4.tex}\\right|`, kind: "atom" };
    }
    if (/^[\d.]/.test(token2)) return number2(token2);
    if (!/^[A-Za-z_]/.test(token2)) throw new Error(`${token2} has nothing to stand for`);
    if (this.tokens[this.at] !== "(" || !(token2 in WRITTEN || FUNCTIONS.has(token2))) return name(token2);
    const of = this.list();
    const tex = token2 in WRITTEN ? WRITTEN[token2](of) : `\\operatorname{${token2}}${bracketed(of)}`;
    return { tex, kind: token2 === "exp" || FUNCTIONS.has(token2) || token2 === "sign" ? "product" : "atom" };
  }
  /** What stands in the brackets of a function. */
  list() {
    this.take("(");
    const found2 = [this.sum().tex];
    while (this.took(",")) found2.push(this.sum().tex);
    this.take(")");
    return found2.join(",\\ ");
  }
};
function factor({ tex, kind, bare }) {
  return kind === "sum" ? bracketed(bare ?? tex) : tex;
}
function bracketed(tex) {
  return `{\\left(${tex}\\right)}`;
}
function number2(token2) {
  const [digits, power] = token2.toLowerCase().split("e");
  return power === void 0 ? { tex: digits, kind: "atom" } : { tex: `${digits}\\cdot 10^{${Number(power)}}`, kind: "product" };
}
function name(token2) {
  if (token2 === "dv/dt") return { tex: "\\dot v", kind: "atom" };
  if (["spline", "sqrt"].includes(token2)) throw new Error(`${token2} is read as it is typed`);
  const [, letters, digits] = /^([A-Za-z]+)_?(\d*)$/.exec(token2) ?? [];
  if (letters === void 0) throw new Error(`${token2} is read as it is typed`);
  const tex = LETTERS.has(letters) ? `\\${letters}` : letters.length > 1 ? `\\text{${letters}}` : letters;
  return { tex: digits ? `${tex}_{${digits}}` : tex, kind: "atom" };
}

// src/math.js
var SIGNS = {
  ...{ alpha: "α", delta: "δ", theta: "θ", mu: "μ", sigma: "σ", tau: "τ", varphi: "φ", psi: "ψ", omega: "ω", pi: "π" },
  ...{ Delta: "Δ", infty: "∞" }
};
var OPERATORS = { mp: "∓", pm: "±", le: "≤", ge: "≥", neq: "≠", in: "∈", cdot: "⋅", times: "×", sum: "∑", int: "∫" };
var SPACES = { quad: 1, ",": 0.17, ";": 0.28, " ": 0.25, "!": -0.17 };
var NAMES = ["sin", "cos", "tan", "exp", "log", "max", "min"];
var FENCES = ["left", "right", "bigl", "bigr", "Bigl", "Bigr", "big", "Big"];
var IGNORED = ["textstyle", "displaystyle", "limits"];
var LARGE = ["sum", "int"];
function typeset(latex) {
  const tree = latex.trim() === "" ? null : parsed(latex);
  return tree && element(["math", { displaystyle: "true" }, ["mrow", {}, ...tree]]);
}
function lawOf({ latex, law }) {
  const typed = typeset(latex || (latexOf(law) ?? ""));
  return typed ? make("div", { class: "formula" }, typed) : make("code", { class: "formula", text: law });
}
var WRITTEN2 = {
  ...{ rise: "r", vs: "v_s", dv: "\\Delta v", gap: "g", lag: "T", tau: "T", delay: "t_d", limit: "\\tau_{\\max}", noise: "\\sigma" },
  ...{ lo: "\\theta_{\\text{lo}}", hi: "\\theta_{\\text{hi}}", k_lo: "k_{\\text{lo}}", k_hi: "k_{\\text{hi}}", D_neg: "D_{-}", D_pos: "D_{+}" }
};
function letterOf(name2, latex) {
  const written = letter(name2);
  const [turns] = /^\\(theta|tau)/.exec(written) ?? [];
  return turns && !latex.includes(turns) ? written.replace(turns, turns === "\\tau" ? "F" : "x") : written;
}
function letter(name2) {
  if (name2 in WRITTEN2) return WRITTEN2[name2];
  const [, base, index] = /^([A-Za-z]|alpha|delta|theta|mu|tau|phi)(?:_?(\d+|theta|alpha))?$/.exec(name2) ?? [];
  if (!base) return `\\text{${name2}}`;
  const sign = (word) => word === "phi" ? "\\varphi" : word in SIGNS ? `\\${word}` : word;
  return index ? `${sign(base)}_{${sign(index)}}` : sign(base);
}
var OTHERS = [
  [/C_\{\\pm\}/, "C_{\\pm}", "dry friction of each direction"],
  [/\\theta(?!_|\s*_)/, "\\theta", "angle"],
  [/^(?!.*\\theta).*(?<![A-Za-z\\])x(?!_)/, "x", "position"],
  [/\\omega/, "\\omega", "velocity"],
  [/(?<![A-Za-z\\])v(?!_)/, "v", "velocity"],
  [/\\alpha/, "\\alpha", "acceleration"],
  [/\\delta(?!\})/, "\\delta", "twist of the joint"]
];
function othersIn(latex, own) {
  const letters = new Set(own.map((name2) => letterOf(name2, latex)));
  return OTHERS.filter(([there, tex]) => there.test(latex) && !letters.has(tex)).map(([, tex, meaning]) => (
    /** @type {const} */
    [tex, meaning]
  ));
}
function printed(tex) {
  return typeset(tex) ?? tex;
}
function lettersOf(names, latex) {
  const [first, last] = [names[0], names[names.length - 1]].map((name2) => letterOf(name2, latex));
  return make("span", {}, typeset(first) ?? names[0], ...names.length > 1 ? [" … ", typeset(last) ?? last] : []);
}
function parsed(latex) {
  const tokens = latex.match(/\\[A-Za-z]+|\\.|[0-9.]+|\s+|[^\s]/g) ?? [];
  try {
    return new Reader2(tokens).row(() => false);
  } catch {
    return null;
  }
}
var Reader2 = class {
  /** @param {string[]} tokens */
  constructor(tokens) {
    this.tokens = tokens;
    this.at = 0;
  }
  /** The next token that is no space. */
  get next() {
    while (/^\s+$/.test(this.tokens[this.at] ?? "")) this.at++;
    return this.tokens[this.at];
  }
  /** @param {string} [wanted] @returns {string} */
  take(wanted2) {
    const token2 = this.next;
    if (token2 === void 0 || wanted2 !== void 0 && token2 !== wanted2) throw new Error(`${wanted2} is missing`);
    this.at++;
    return token2;
  }
  /** All up to where `ends` holds. @param {(token: string) => boolean} ends */
  row(ends2) {
    const found2 = [];
    while (this.next !== void 0 && !ends2(this.next)) {
      const one = this.scripted();
      if (one) found2.push(one);
    }
    return found2;
  }
  /** In braces as they are, without their structure. */
  words() {
    this.take("{");
    let text = "";
    while (this.tokens[this.at] !== "}") {
      if (this.at >= this.tokens.length) throw new Error("} is missing");
      text += this.tokens[this.at++];
    }
    this.at++;
    return text;
  }
  /** One thing with what stands above and below it. @returns {Node_ | null} */
  scripted() {
    const large = LARGE.includes(this.next.slice(1));
    const base = this.one();
    const scripts = {};
    while (base && (this.next === "_" || this.next === "^")) scripts[this.take()] = this.argument();
    const { _: low, "^": high } = scripts;
    if (!base || !low && !high) return base;
    const kind = large ? ["munderover", "munder", "mover"] : ["msubsup", "msub", "msup"];
    if (low && high) return [kind[0], {}, base, low, high];
    return low ? [kind[1], {}, base, low] : [kind[2], {}, base, high];
  }
  /** What a command or a script takes: one thing, or a row in braces. @returns {Node_} */
  argument() {
    if (this.next === "{") return this.braced();
    const one = this.one();
    if (!one) throw new Error("an argument is missing");
    return one;
  }
  /** @returns {Node_} */
  braced() {
    this.take("{");
    const row = this.row((token2) => token2 === "}");
    this.take("}");
    return ["mrow", {}, ...row];
  }
  /** @returns {Node_ | null} */
  one() {
    const token2 = this.next;
    if (token2 === "{") return this.braced();
    this.at++;
    if (!token2.startsWith("\\")) return plain2(token2);
    const name2 = token2.slice(1);
    if (name2 in SIGNS) return ["mi", {}, SIGNS[name2]];
    if (name2 in OPERATORS) return ["mo", {}, OPERATORS[name2]];
    if (name2 in SPACES) return space(name2);
    if (NAMES.includes(name2)) return this.named(name2);
    if (IGNORED.includes(name2)) return null;
    if (FENCES.includes(name2)) return fence(this.take());
    if (name2 === "frac" || name2 === "tfrac") return ["mfrac", {}, this.argument(), this.argument()];
    if (name2 === "dot") return ["mover", { accent: "true" }, this.argument(), ["mo", {}, "˙"]];
    if (name2 === "text") return ["mtext", {}, this.words()];
    if (name2 === "operatorname") return this.named(this.words());
    if (name2 === "mathbb") return ["mi", {}, this.words().replace("N", "ℕ")];
    if (name2 === "begin") return this.cases();
    throw new Error(`${token2} is unknown`);
  }
  /** A function by its name, at a distance from what it is of. @param {string} name @returns {Node_} */
  named(name2) {
    const of = ["(", "^", "_", "\\!", "\\left"].includes(this.next) ? [] : [space(",")];
    return ["mrow", {}, ["mi", { mathvariant: "normal" }, name2], ...of];
  }
  /** @returns {Node_} */
  cases() {
    if (this.words() !== "cases") throw new Error("an environment is unknown");
    const rows = [];
    let cells = [];
    for (; ; ) {
      cells.push(["mtd", {}, ...this.row((token2) => ["&", "\\\\", "\\end"].includes(token2))]);
      const end = this.take();
      if (end === "&") continue;
      rows.push(["mtr", {}, ...cells]);
      cells = [];
      if (end === "\\end") break;
    }
    this.words();
    return ["mrow", {}, ["mo", { stretchy: "true", form: "prefix" }, "{"], ["mtable", {}, ...rows]];
  }
};
var SMALLEST = 0.62;
function fitFormulas(place4) {
  const every = [...place4.querySelectorAll(".formula")].filter((one) => one instanceof HTMLElement);
  for (const one of every) one.style.fontSize = "";
  const shares = every.map((one) => one.clientWidth > 0 ? one.clientWidth / one.scrollWidth : 1);
  for (const [at, share] of shares.entries()) {
    if (share < 1) every[at].style.fontSize = `${Math.max(SMALLEST, 0.98 * share).toFixed(3)}em`;
  }
}
function fence(token2) {
  return token2 === "." ? null : ["mo", { stretchy: "true" }, token2];
}
function space(name2) {
  return ["mspace", { width: `${SPACES[name2]}em` }];
}
function plain2(token2) {
  if (/^[0-9.]+$/.test(token2)) return ["mn", {}, token2];
  if (/^[A-Za-z]$/.test(token2)) return ["mi", {}, token2];
  if (/^[()[\]|]$/.test(token2)) return ["mo", { stretchy: "false" }, token2];
  if (/^[-+=<>,/]$/.test(token2)) return ["mo", {}, token2 === "-" ? "−" : token2];
  throw new Error(`${token2} is unknown`);
}
var namespace = once(() => new DOMParser().parseFromString("<math>", "text/html").querySelector("math")?.namespaceURI ?? null);
function once(make2) {
  let known2 = null;
  return () => (known2 ??= { made: make2() }).made;
}
function element([tag, attributes, ...children]) {
  const made = document.createElementNS(namespace(), tag);
  for (const [name2, value] of Object.entries(attributes)) made.setAttribute(name2, value);
  made.append(...children.map((child) => typeof child === "string" ? child : element(child)));
  return made;
}

// src/untold.js
function tellsNext({ candidates, concluded, node }) {
  return node !== null && (candidates.ready || concluded.length > 0);
}
function insteadOf({ candidates, record, shown_along: along, untold }) {
  if (untold.length > 0 && along === null) return "";
  if (candidates.rows.some(({ could_be: could }) => could)) return "What to record next is known once what is missing is in the model.";
  return record ? `What to record next, to see what it is: ${record}.` : "";
}
function purposeOf(state) {
  const known2 = "For the motion after which that is known better which is known least.";
  return insteadOf(state) || (state.untold.length > 0 ? "For the motion that tells apart what these captures cannot." : known2);
}
function waitsFor(state) {
  return insteadOf(state) !== "" && state.shown_along === null;
}
function alikeOf({ candidates, untold }) {
  const first = untold.length > 0 ? void 0 : candidates.rows.find(({ could_be: could }) => could);
  return first && first.equivalent.length > 0 ? [first.effect, ...first.equivalent] : [];
}
function apartButton(effects, apart2, whose = "") {
  const [text, label] = ["Tell apart…", `Tell apart… ${whose}`.trim()];
  return make("button", { type: "button", text, title: "design the motion that would tell", "aria-label": label, on: { click: () => apart2(effects) } });
}
function boundsButton(effects, bounds, whose) {
  const title = "the limits of your rig, within which it is designed";
  return make("button", { type: "button", text: "Limits…", title, "aria-label": `Limits… ${whose}`, on: { click: () => bounds(effects) } });
}
function showUntold(place4, { untold, needless, active }, apart2, drop) {
  const these = active.length === 1 ? "this capture" : "these captures";
  const rows = untold.map(
    (effects) => make(
      "li",
      {},
      ...listed([effects[0]], ""),
      ` came in; ${these} cannot tell it from `,
      ...listed(effects.slice(1), ", "),
      ". ",
      apartButton(effects, apart2)
    )
  );
  const out = needless.map((effect) => {
    const click = () => drop(effect);
    const button = make("button", { type: "button", text: "Take it out", "aria-label": `Take out ${titleOf(effect)}`, on: { click } });
    return make("li", {}, ...listed([effect], ""), " is needless by now: what came in since does the same. ", button);
  });
  place4.replaceChildren(...rows, ...out);
}

// src/candidates.js
var NOTHING = "No effect that was weighed explains enough of what is left.";
var NO_MORE = "Nothing that was weighed is still missing.";
var FEW3 = 4;
var NAMED = 0.01;
var ALONE = "Weighed one at a time; Find everything weighs sets too, from the first model on, and may end elsewhere.";
var Candidates = class {
  /**
   * @param {HTMLElement} place
   * @param {{look: (effect: string | null) => void, take: (effect: string) => void, ask?: () => void,
   *   about?: (row: Candidate) => void, apart?: (effects: string[]) => void,
   *   bounds?: (effects: string[]) => void}} deeds
   * @param {string} taking what it is called to take one
   */
  constructor(place4, deeds, taking) {
    this.place = place4;
    this.deeds = deeds;
    this.taking = taking;
    this.shown = "";
    this.at = 0;
    this.inside = false;
    this.several = false;
    this.items = [];
    this.rows = [];
    place4.tabIndex = -1;
    place4.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => fitFormulas(place4)).observe(place4);
  }
  /** @param {Pick<State, "candidates" | "concluded" | "node" | "job" | "searched" | "active">} state @param {import("./said.js").About} about */
  show({ candidates, concluded, node, job, searched, active }, about2) {
    const shown2 = JSON.stringify([candidates, concluded, node, job?.id, searched, active.length, about2]);
    if (shown2 === this.shown) return;
    this.shown = shown2;
    this.inside ||= this.place.contains(document.activeElement);
    this.at = 0;
    const could = candidates.rows.filter((row) => row.could_be);
    const rest = candidates.rows.filter((row) => !row.could_be);
    const ruledOut = rest.filter((row) => row.word === "implausible");
    this.rows = [...could, ...ruledOut, ...rest.filter((row) => row.word !== "implausible")];
    this.several = active.length > 1;
    this.items = this.rows.map((row, at) => this.item(row, at, about2));
    const [out, others] = [this.items.slice(could.length, could.length + ruledOut.length), this.items.slice(could.length + ruledOut.length)];
    const ask2 = make("button", {
      ...{ type: "button", text: "What is missing?", disabled: job !== null || node === null },
      on: { click: () => this.deeds.ask?.() }
    });
    this.place.replaceChildren(
      ...candidates.ready ? [] : [make("p", { class: "soft" }, job ? `${sentence(job.what, about2)} …` : ask2)],
      candidates.ready && !searched && could.length > 0 ? make("p", { class: "soft alone", text: ALONE }) : "",
      ...candidates.ready && this.items.length === 0 ? [make("p", { class: "well", text: "Nothing is left to be weighed." })] : [],
      candidates.ready && could.length === 0 && this.items.length > 0 ? make("p", { class: "soft", text: candidates.unexplained ? NOTHING : NO_MORE }) : "",
      make("ul", { "aria-label": "candidates", class: "candidates" }, ...this.items.slice(0, could.length)),
      out.length > 0 ? folded2(out, `${out.length} ruled out by values that none can have: ${outWords(ruledOut)}`) : "",
      others.length > 0 ? folded2(others, `${restWords(others.length, this.items.length)}: no better than chance, or too little to matter`) : "",
      ...concluded.length > 0 ? [] : remainder(candidates.unexplained, about2)
      // where it stands first already
    );
    fitFormulas(this.place);
    if (this.inside && document.activeElement === document.body) this.place.focus();
    if (this.items.length > 0) this.inside = false;
  }
  /** @param {Candidate} row @param {number} at @param {import("./said.js").About} about */
  item(row, at, about2) {
    const bar2 = make("span", { class: "bar" });
    bar2.style.width = `${100 * Math.min(1, Math.max(0, row.error_fall))}%`;
    const take = make("button", {
      ...{ type: "button", text: this.taking, tabindex: -1, "aria-label": `${this.taking} ${titleOf(row.effect)}` },
      on: { click: () => this.deeds.take(row.effect) }
    });
    const what = make("button", {
      ...{ type: "button", text: "?", tabindex: -1, "aria-label": `about ${titleOf(row.effect)}`, title: "what it is (key: ?)" },
      on: { click: () => this.deeds.about?.(row) }
    });
    const chance = row.could_be ? "" : " chance";
    return make(
      "li",
      {
        ...{ class: `candidate${chance}`, tabindex: at === 0 ? 0 : -1, "data-effect": row.effect },
        "aria-label": `${titleOf(row.effect)}, ${row.name}: error falls by ${percent(Math.max(0, row.error_fall))}, ${evidence(row, about2)}`,
        on: {
          pointerenter: () => this.deeds.look(row.effect),
          pointerleave: () => this.deeds.look(null),
          focus: () => this.focused(at),
          blur: () => this.deeds.look(null)
        }
      },
      make("span", { class: "label", text: titleOf(row.effect), title: row.effect }),
      make("span", { class: "track" }, bar2),
      make("span", { class: "figure", text: percent(-Math.max(0, row.error_fall)), title: "fall of the RMS error" }),
      make("span", { class: "deeds" }, this.deeds.about ? what : null, take),
      make("span", { class: "alike", text: row.name }),
      ...row.could_be ? [make("span", { class: "alike law-of" }, lawOf(row)), meant(row)] : [],
      make("span", { class: "evidence soft", text: evidence(row, about2) }),
      this.untold(row),
      ...remarks(row).map((words4) => make("span", { class: "alike soft" }, ...words4)),
      row.could_be && row.unsettled ? make("span", { class: "alike doubt", text: `⚠ ${row.unsettled}` }) : null,
      ...row.implausible.map((why) => make("span", { class: "alike doubt" }, "⚠ ", ...nodes(why, about2)))
    );
  }
  /**
   * What this one cannot be told from, with the button that designs the motion which would tell.
   * @param {Candidate} row
   */
  untold({ effect, equivalent }) {
    if (equivalent.length === 0) return null;
    const { apart: apart2, bounds } = this.deeds;
    const [all, title] = [[effect, ...equivalent], titleOf(effect)];
    const buttons = apart2 && bounds ? [apartButton(all, apart2, title), " ", boundsButton(all, bounds, title)] : [];
    return make("span", { class: "alike soft" }, `${this.several ? "these captures" : "this capture"} cannot tell it from `, ...listed(equivalent, ", "), " ", ...buttons);
  }
  /** Go to an effect. @param {string} effect */
  go(effect) {
    const item = this.items.find(({ dataset }) => dataset.effect === effect);
    const fold = item?.closest("details");
    if (fold) fold.open = true;
    item?.focus();
  }
  /** @param {number} at */
  focused(at) {
    this.at = at;
    for (const [other, item] of this.items.entries()) {
      item.tabIndex = other === at ? 0 : -1;
      if (other === at) item.setAttribute("aria-current", "true");
      else item.removeAttribute("aria-current");
    }
    this.deeds.look(this.items[at].dataset.effect ?? null);
  }
  /** @param {KeyboardEvent} event */
  key(event) {
    const at = event.target === this.place ? -1 : this.at;
    const moves = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: this.items.length - 1 };
    if (event.key in moves) {
      const to = moves[
        /** @type {keyof typeof moves} */
        event.key
      ];
      const item = this.items[Math.min(this.items.length - 1, Math.max(0, to))];
      if (item) this.go(item.dataset.effect ?? "");
      event.preventDefault();
    } else if (event.key === "Enter" && event.target === this.items[this.at]) {
      this.deeds.take(this.items[this.at].dataset.effect ?? "");
      event.preventDefault();
    } else if (event.key === "?") {
      if (this.rows[this.at]) this.deeds.about?.(this.rows[this.at]);
    }
  }
};
function folded2(items, words4) {
  return make("details", {}, make("summary", { class: "soft", text: words4 }), make("ul", { class: "candidates" }, ...items));
}
function restWords(rest, all) {
  return rest < all ? `${rest} more` : `${rest} weighed`;
}
function outWords(rows) {
  const some = rows.filter(({ error_fall: fall }) => fall >= NAMED);
  const named2 = (some.length > 0 ? some : rows.slice(0, 1)).map(({ effect, error_fall: fall }) => `${titleOf(effect)} (${percent(-Math.max(0, fall))})`);
  return [...named2, ...named2.length < rows.length ? [`${rows.length - named2.length} that would take off less than 1 %`] : []].join(", ");
}
function evidence(row, about2) {
  const chance = row.p_value <= 1e-3 ? "p ≤ 0.001" : `p = ${number(row.p_value, 2)}`;
  return `${sentence(row.said, about2)} (${chance})`;
}
function meant({ letters, latex }) {
  if (letters.length === 0 || letters.length > FEW3) return null;
  const friction = othersIn(latex, []).filter(([tex]) => tex.startsWith("C_"));
  const parts = [...letters.map(({ names, meaning }) => [lettersOf(names, latex), meaning]), ...friction.map(([tex, meaning]) => [printed(tex), meaning])];
  return make("span", { class: "alike soft meant" }, ...parts.flatMap(([letter2, meaning], at) => [at > 0 ? " · " : "", letter2, ` ${meaning}`]));
}
function remarks({ equivalent, confused, note }) {
  const others = confused.filter((effect) => !equivalent.includes(effect));
  return [...others.length > 0 ? [["often confused with ", ...listed(others, ", ")]] : [], ...note ? [[note]] : []];
}
function remainder(unexplained, about2) {
  if (!unexplained) return [];
  const { axis: axis2, share, hint } = unexplained;
  const where = sentence(hint, about2);
  const words4 = `Unexplained over ${sentence([{ along: axis2 }], about2)}: ${percent(share)} of what remains${where ? ` (${where})` : ""}.`;
  return [make("p", { class: "soft", text: words4 })];
}

// src/section.js
var SIZE = { width: 260, height: 120 };
var BINS = 96;
var FREE = 0.02;
var KINDS = { joint, gap, gauge, bristles, fluid, hills, spring, weight, poles, stops, mass };
function kindOf({ place: place4, friction, over, section }) {
  if (section && section in KINDS) return section;
  if (place4 === "coupling") return "joint";
  if (place4 === "sensor") return "gauge";
  if (friction) return "bristles";
  return over === "acceleration" ? "mass" : "hills";
}
var SEEN2 = {
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
  mass: "the mass that has to be set going and stopped"
};
function drawSection(canvas, effect, motion, at, look) {
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
var Motion = class {
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
    const part = (value, most) => value === value ? value / most : 0;
    return {
      theta: theta[i],
      along: (theta[i] - this.low) / this.span,
      omega: part(omega[i], this.most.omega),
      level: part(tau[i], this.most.tau),
      bare: this.added ? part(tau[i] - this.added[i], this.most.tau) : part(tau[i], this.most.tau),
      torque: this.added ? part(this.added[i], this.most.added) : 0,
      hills: this.hills
    };
  }
};
function hillsOf(theta, torque, low, span4) {
  const [sum, count] = [new Float32Array(BINS), new Float32Array(BINS)];
  for (let i = 0; i < theta.length; i++) {
    const bin = Math.min(BINS - 1, Math.floor(BINS * (theta[i] - low) / span4));
    if (!(bin >= 0) || torque[i] !== torque[i]) continue;
    sum[bin] += torque[i];
    count[bin]++;
  }
  let [work, last] = [0, 0];
  const found2 = sum.map((value, bin) => {
    last = count[bin] > 0 ? value / count[bin] : last;
    return work += last;
  });
  const [least, most] = reach(found2);
  return found2.map((value) => most > least ? (value - least) / (most - least) : 0.5);
}
function reach(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}
function largest(values) {
  const [low, high] = reach(values);
  return Math.max(-low, high) || 1;
}
function bar(brush, torque, { soft, shade, colour }) {
  brush.fillStyle = shade;
  brush.fillRect(240, 6, 14, 108);
  brush.fillStyle = colour;
  brush.fillRect(240, 60, 14, -54 * torque);
  brush.fillStyle = soft;
  brush.fillRect(237, 59, 20, 2);
}
function line(brush, points) {
  brush.beginPath();
  for (const [x, y] of points) brush.lineTo(x, y);
  brush.stroke();
}
function bristles(brush, { along, omega, torque }, { ink, shade, soft, colour }) {
  brush.fillStyle = shade;
  brush.fillRect(0, 92, 230, 28);
  brush.fillRect(0, 8, 230, 34);
  brush.strokeStyle = soft;
  for (let x = -40 + 240 * along % 20; x < 230; x += 20) line(brush, [[x + 10, 8], [x + 24, 42]].map(([a, b]) => [Math.max(0, Math.min(230, a)), b]));
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
function hills(brush, { along, hills: heights }, { ink, soft, colour }) {
  const up = (share) => {
    const bin = Math.min(BINS - 1, Math.max(0, Math.round(share * (BINS - 1))));
    return 100 - 66 * (heights ? heights[bin] : 0.3);
  };
  brush.strokeStyle = heights ? ink : soft;
  line(brush, Array.from({ length: BINS }, (_, bin) => [6 + 218 * bin / (BINS - 1), up(bin / (BINS - 1))]));
  brush.fillStyle = colour;
  brush.beginPath();
  brush.arc(6 + 218 * along, up(along) - 10, 9, 0, 2 * Math.PI);
  brush.fill();
}
function joint(brush, { along, torque }, { ink, shade, colour }) {
  const shaft = 24 + 70 * along;
  const knob2 = shaft + 84 + 22 * torque;
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  for (const [x, width] of [[shaft, 30], [knob2, 44]]) {
    brush.fillRect(x, 34, width, 52);
    brush.strokeRect(x, 34, width, 52);
  }
  brush.strokeStyle = colour;
  const step = (knob2 - shaft - 30) / 10;
  line(brush, Array.from({ length: 11 }, (_, n) => [shaft + 30 + n * step, n % 10 === 0 ? 60 : n % 2 ? 48 : 72]));
}
function gap(brush, { along, torque, omega }, { ink, shade, colour }) {
  const fork = 20 + 90 * along;
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
function fluid(brush, { along, omega, torque }, { ink, shade, colour }) {
  const plate = 20 + 120 * along;
  brush.fillStyle = shade;
  brush.fillRect(0, 50, 230, 70);
  brush.strokeStyle = colour;
  for (let row = 0; row < 5; row++) {
    const y = 60 + 12 * row;
    const way = 70 * omega * (1 - row / 5);
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
function spring(brush, { along }, { ink, soft, shade, colour }) {
  const end = 70 + 110 * along;
  brush.strokeStyle = soft;
  line(brush, [[6, 96], [226, 96]]);
  brush.strokeStyle = ink;
  line(brush, [[8, 20], [8, 96]]);
  brush.strokeStyle = colour;
  line(brush, Array.from({ length: 15 }, (_, n) => [8 + n * (end - 8) / 14, n % 14 === 0 ? 66 : n % 2 ? 50 : 82]));
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  brush.fillRect(end, 38, 40, 56);
  brush.strokeRect(end, 38, 40, 56);
}
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
function poles(brush, { along, torque }, { ink, soft, shade, colour }) {
  const apart2 = 46;
  brush.strokeStyle = ink;
  brush.fillStyle = shade;
  brush.fillRect(0, 100, 230, 20);
  for (let x = 0; x < 230; x += apart2) {
    brush.fillRect(x + 8, 74, 26, 26);
    brush.strokeRect(x + 8, 74, 26, 26);
  }
  const moved = 3 * apart2 * along;
  brush.fillStyle = colour;
  brush.strokeStyle = soft;
  for (let n = -3; n < 5; n++) {
    const x = n * apart2 + moved;
    const [left, right] = [Math.max(0, x), Math.min(230, x + 30)];
    if (right > left) brush.fillRect(left, 28, right - left, 22);
    if (x > 0 && x < 200) line(brush, [[x + 15, 52], [x + 15 + 14 * torque, 72]]);
  }
}
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
function gauge(brush, { level: level2, bare }, { ink, soft, colour }) {
  brush.strokeStyle = soft;
  brush.beginPath();
  brush.arc(115, 108, 92, Math.PI, 2 * Math.PI);
  brush.stroke();
  for (const [value, needle] of [[bare, soft], [level2, colour]]) {
    const way = Math.PI / 2 - 1.3 * Number(value);
    brush.strokeStyle = String(needle);
    line(brush, [[115, 108], [115 + 84 * Math.cos(way), 108 - 84 * Math.sin(way)]]);
  }
  brush.fillStyle = ink;
  brush.fillRect(110, 103, 10, 10);
}
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

// src/acting.js
var PACE = 0.35;
function momentWords(seconds2, torque, { factor: factor2, unit }) {
  const at = `${String(Number(seconds2.toPrecision(4))).replace("-", "−")} s: `;
  if (torque === null) return `${at}what it adds is not weighed here`;
  return at + (Number.isFinite(torque) ? `adds ${number(torque * factor2)} ${unit}` : "nothing is fitted to this moment");
}
function firstFitted(column) {
  return Math.max(0, column.findIndex((one) => Number.isFinite(one)));
}
function acting(effect, { data, at, added }) {
  const { t } = data.columns;
  const canvas = make("canvas", { class: "section", role: "img", "aria-label": SEEN2[kindOf(effect)] });
  const slider = make("input", { type: "range", min: 0, max: t.length - 1, step: 1, value: at ?? 0, "aria-label": "moment" });
  const play = make("button", { type: "button", text: "Play", "aria-pressed": "false" });
  const words4 = make("span", { class: "soft figure" });
  const element2 = make(
    "div",
    { class: "acting" },
    ...[canvas, make("div", {}, make("p", { class: "soft", text: SEEN2[kindOf(effect)] }), words4), make("div", { class: "along" }, play, slider)]
  );
  let motion = new Motion(data.columns, null);
  let [playing, begun] = [false, { clock: 0, time: 0 }];
  const draw2 = () => {
    const now = Number(slider.value);
    const named2 = { ink: "--ink", soft: "--soft", shade: "--shade", colour: "--signature" };
    const colours = Object.fromEntries(Object.entries(named2).map(([name2, style]) => [name2, styleValue(style, canvas)]));
    drawSection(
      canvas,
      effect,
      motion,
      now,
      /** @type {import("./section.js").Look} */
      colours
    );
    const scale = torqueScale(data);
    words4.textContent = momentWords(t[now], motion.added ? motion.added[now] : null, scale);
  };
  const frame = (clock2) => {
    if (!playing || !canvas.isConnected || !canvas.closest("dialog[open]")) return run(false);
    const time = begun.time + PACE * (clock2 - begun.clock) / 1e3;
    let now = Number(slider.value);
    while (now < t.length - 1 && t[now] < time) now++;
    slider.value = String(now);
    draw2();
    if (now >= t.length - 1) return run(false);
    return requestAnimationFrame(frame);
  };
  const run = (on) => {
    playing = on;
    play.textContent = on ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(on));
    if (!on) return;
    if (Number(slider.value) >= t.length - 1) slider.value = "0";
    begun = { clock: performance.now(), time: t[Number(slider.value)] };
    requestAnimationFrame(frame);
  };
  play.addEventListener("click", () => run(!playing));
  slider.addEventListener("input", () => {
    run(false);
    draw2();
  });
  added().then(
    (column) => {
      motion = new Motion(data.columns, column);
      if (at === null && column && slider.value === "0") slider.value = String(firstFitted(column));
      if (playing) run(true);
      draw2();
    },
    () => {
    }
    // without it the motion is still shown
  );
  requestAnimationFrame(() => {
    draw2();
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) run(true);
  });
  return element2;
}

// src/effects.js
var pictures = /* @__PURE__ */ new Map();
var PLACES = { load: "moving part itself", coupling: "joint between what drives and what is moved", sensor: "reading" };
var AnyEffect = class {
  /** @param {(effect: string) => void} add @param {(effect: Effect) => void} tell what it is */
  constructor(add, tell) {
    this.select = /** @type {HTMLSelectElement} */
    byId("any-effect");
    this.absent = [];
    byId("any").addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.select.value) add(this.select.value);
    });
    byId("any-about").addEventListener("click", () => {
      const chosen = this.absent.find(({ effect }) => effect === this.select.value);
      if (chosen) tell(chosen);
    });
    byId("about-close").addEventListener("click", () => dialog().close());
  }
  /** @param {Effect[]} absent */
  show(absent) {
    byId("any").hidden = absent.length === 0;
    const names = (effects) => effects.map(({ effect }) => effect).join();
    if (names(absent) !== names(this.absent)) {
      const none = make("option", { value: "", text: "choose one" });
      this.select.replaceChildren(none, ...absent.map(({ effect, name: name2 }) => make("option", { value: effect, text: `${titleOf(effect)}: ${name2}`, title: effect })));
    }
    this.absent = absent;
  }
};
function about(effect, shown2, torque) {
  const { effect: id, place: place4, source, shows, name: name2, about: sentence2, causes, remedies } = effect;
  const drawing = make("p", { class: "soft", text: "The picture is being drawn …" });
  const frame = make("div", { class: "picture", role: "status" }, drawing);
  const example = `Below, an example: what it adds to a small knob that turns, with torques in mNm${torque === "N m" ? "" : `; the captures here are in ${torque}`}.`;
  byId("about-title").textContent = `${titleOf(id)}: ${name2}`;
  byId("about-title").title = id;
  byId("about-text").replaceChildren(
    make("p", { text: sentence2 }),
    lawOf(effect),
    meanings2(effect, torque),
    shown2 ? acting(effect, shown2) : "",
    make("div", { class: "columns-of-two" }, listed2("Usual causes", causes), listed2("What helps", remedies)),
    make("p", { class: "soft", text: `Acts on the ${PLACES[place4] ?? place4}. Shows ${shows}. Source: ${source}.` }),
    make("p", { class: "soft", text: example }),
    frame
  );
  dialog().showModal();
  fitFormulas(byId("about-text"));
  const alt = `${name2}: what it adds to a small model's torque; it shows ${shows}`;
  const drawn = () => frame.replaceChildren(make("img", { alt, src: pictures.get(id) }));
  if (pictures.has(id)) return drawn();
  fetchPicture(id).then(
    (blob) => {
      pictures.set(id, URL.createObjectURL(blob));
      drawn();
    },
    (reason2) => frame.replaceChildren(make("p", { class: "wrong", text: wordsOf(reason2) }))
  );
}
function meanings2({ letters, latex }, torque) {
  const written = (unit) => unitWords(unitOf(unit, torque));
  const rows = letters.map(({ names, meaning, unit }) => make("li", {}, lettersOf(names, latex), ` ${meaning}`, written(unit) ? `, ${written(unit)}` : ""));
  const own = letters.flatMap(({ names }) => names);
  rows.push(...othersIn(latex, own).map(([tex, words4]) => make("li", {}, printed(tex), ` ${words4}`)));
  return rows.length > 0 ? make("ul", { class: "letters soft", "aria-label": "letters of the law" }, ...rows) : "";
}
function listed2(title, phrases) {
  if (phrases.length === 0) return null;
  return make("div", {}, make("h3", { text: title }), make("ul", {}, ...phrases.map((text) => make("li", { text }))));
}
function dialog() {
  return (
    /** @type {HTMLDialogElement} */
    byId("about")
  );
}

// src/evidence.js
var LEAST_D = 0.1;
var MOST_D = 100;
function limitWords(about2) {
  const { theta, omega, alpha } = motionWords(about2);
  return {
    torque_Nm: `${torqueWord(about2.unit)}, ${torqueScale(about2).unit}`,
    omega_rad_s: `${omega.name}, ${omega.unit}`,
    alpha_rad_s2: `${alpha.name}, ${alpha.unit}`,
    theta_min_rad: `from ${theta.name}, ${theta.unit}`,
    theta_max_rad: `to ${theta.name}, ${theta.unit}`,
    duration_s: "at most, s",
    sample_rate_hz: "recorded at, Hz"
  };
}
function limitFactor(name2, about2) {
  return name2 === "torque_Nm" ? torqueScale(about2).factor : 1;
}
function enoughWords({ theta_min_rad: from, ...wider2 }, about2) {
  const { theta } = motionWords(about2);
  if (from !== void 0) return `${theta.name} from ${number(from)} to ${number(wider2.theta_max_rad)} ${theta.unit}`;
  const [[name2, to]] = Object.entries(wider2);
  if (name2 === "duration_s") return `at most ${number(to)} s`;
  const [called2, unit] = (limitWords(about2)[name2] ?? name2).split(", ");
  return `${called2} up to ${number(to * limitFactor(name2, about2), 4)} ${unit}`;
}
function ofLimits(said, about2) {
  return said.startsWith("limits") ? inFormWords(said, about2) : said;
}
function inFormWords(said, about2) {
  const pairs = Object.entries(limitWords(about2));
  const own = said.replaceAll(/(?<=torque_Nm: (?:is )?)-?\d[\d.e+-]*\d|(?<=torque_Nm: (?:is )?)-?\d/g, (value) => String(Number((Number(value) * limitFactor("torque_Nm", about2)).toPrecision(6))));
  return pairs.reduce((words4, [name2, called2]) => words4.replaceAll(name2, `“${called2}”`), own);
}
function bars({ names, d, standard_d, wrong_choice, came }, about2, told) {
  const share = (value) => `${100 * Math.log(Math.min(Math.max(value, LEAST_D), MOST_D) / LEAST_D) / Math.log(MOST_D / LEAST_D)}%`;
  const row = (words4, value, name2) => {
    const bar2 = make("span", { class: `bar ${name2}` });
    const line2 = make("span", { class: "told" });
    bar2.style.width = share(value);
    line2.style.left = share(told);
    return make(
      "div",
      { class: "evidence-line" },
      make("span", { class: "label", text: words4 }),
      make("span", { class: "track" }, bar2, line2),
      make("span", { class: "figure", text: value > MOST_D ? `> ${MOST_D}` : number(value), title: number(value) })
    );
  };
  const wrong = wrong_choice < 1e-4 ? "less than 0.01 %" : `${number(100 * wrong_choice, 2)} %`;
  return [
    make("p", {}, make("strong", {}, ...nodes(names[0], about2), " or ", ...nodes(names[1], about2)), `: the wrong one is chosen in ${wrong} of cases`),
    row("this motion", d, "promised"),
    row("best standard motion", standard_d, "standard"),
    ...came === null ? [] : [row("what came", came, "came")]
  ];
}

// src/mapping.js
var MOTOR = ["A", "mA", "V", "duty"];
var COUNTS = "counts";
var PER = { rotary: { words: "turn", unit: "turn" }, linear: { words: "millimetre", unit: "mm" } };
var ROWS = "rows/s";
var RATE = 20;
var TARGETS = {
  t: { words: "Time", units: { rotary: ["s", "ms", "us", "min", ROWS], linear: ["s", "ms", "us", "min", ROWS] }, needed: true },
  theta: {
    words: "Angle or position",
    ...{ units: { rotary: ["rad", "deg", "turn", COUNTS], linear: ["m", "mm", "um", COUNTS] }, needed: true }
  },
  tau: {
    words: "Torque or force, or motor current",
    ...{ units: { rotary: ["N m", "mNm", ...MOTOR], linear: ["N", "mN", ...MOTOR] }, needed: true }
  },
  omega: {
    words: "Velocity, if there is one",
    ...{ units: { rotary: ["rad/s", "deg/s", "rpm"], linear: ["m/s", "mm/s"] }, needed: false }
  },
  alpha: {
    words: "Acceleration, if there is one",
    ...{ units: { rotary: ["rad/s^2", "deg/s^2"], linear: ["m/s^2", "mm/s^2"] }, needed: false }
  }
};
var KINDS2 = (
  /** @type {Kind[]} */
  ["rotary", "linear"]
);
var DEGREES = { rad: 180 / Math.PI, turn: 360 };
var TURNS = 3;
var SPELT = {
  "°": "deg",
  "°/s": "deg/s",
  "°/s²": "deg/s^2",
  "rad/s²": "rad/s^2",
  Nm: "N m",
  "1/min": "rpm",
  "U/min": "rpm",
  "mN m": "mNm",
  "µs": "us",
  "µm": "um"
};
var SIZE2 = { width: 110, height: 34 };
var Mapping = class {
  /** @param {HTMLElement} place of the fields @param {HTMLElement} found place of the file's columns */
  constructor(place4, found2) {
    this.found = found2;
    this.columns = [];
    this.counts = make("input", { ...{ name: "counts", type: "number", min: 0, step: "any", inputmode: "decimal" }, list: "counts-usual" });
    this.counts.addEventListener("input", () => this.tell());
    this.perWhat = make("span", {});
    this.per = make("label", { class: "per", hidden: true }, this.perWhat, this.counts);
    this.fields = Object.entries(TARGETS).map(([name2, target]) => {
      const text = make("input", { name: name2, type: "text", autocomplete: "off", spellcheck: "false", "aria-label": target.words });
      const unit = make("select", { "aria-label": `unit of ${target.words}`, name: `${name2}-unit` });
      const range2 = make("span", { class: "range soft" });
      const field3 = { name: name2, target, text, unit, range: range2 };
      text.addEventListener("focus", () => this.at = text);
      text.addEventListener("input", () => this.tell());
      unit.addEventListener("change", () => {
        if (name2 === "theta") this.follow(unit.value);
        this.chose(unit.value);
      });
      place4.append(make("div", {}, make("span", { text: target.words }), text, unit, name2 === "theta" ? this.per : null, range2));
      return field3;
    });
    this.at = this.fields[0].text;
    this.kinds = KINDS2.map((kind) => (
      /** @type {HTMLInputElement} */
      byId(`open-${kind}`)
    ));
    for (const box of this.kinds) box.addEventListener("change", () => this.tell());
    this.tell();
  }
  /** Rotary or linear; null until it is said. @returns {Kind | null} */
  get kind() {
    return KINDS2.find((_, at) => this.kinds[at].checked) ?? null;
  }
  /** What the import is to be told; nothing where nothing is filled in. */
  options() {
    const filled = this.fields.filter(({ text }) => text.value.trim());
    const rate = filled.find(({ unit }) => unit.value === ROWS);
    const map = filled.filter((one) => one !== rate).map(({ name: name2, text, unit }) => {
      const written = text.value.trim();
      if (saysUnit(written) || !unit.value) return `${name2}=${written}`;
      if (unit.value !== COUNTS) return `${name2}=${written} [${unit.value}]`;
      return `${name2}=(${written})/${this.counts.value.trim()} [${PER[this.kind ?? "rotary"].unit}]`;
    });
    const options = map.length > 0 ? { map: map.join(", ") } : {};
    if (map.length > 0 && this.kind) options.coordinate = this.kind;
    if (rate) options.rate_hz = rate.text.value.trim();
    return options;
  }
  /**
   * What has still to be said; the first field of it has the focus then. Nothing where nothing is filled in.
   * @returns {string}
   */
  lacking() {
    const filled = this.fields.filter(({ text }) => text.value.trim());
    if (filled.length === 0) return "";
    if (!this.kind) {
      this.kinds[0].focus();
      return "Does it turn or slide? Metres must not be taken for radians.";
    }
    const without = filled.find(({ text, unit }) => !unit.value && !saysUnit(text.value.trim()));
    if (without) {
      without.unit.focus();
      return `In which unit is ${without.text.value}? (${without.target.words.toLowerCase()})`;
    }
    const absent = this.fields.find(({ target, text }) => target.needed && !text.value.trim());
    if (absent) {
      absent.text.focus();
      if (absent.name !== "t") return `Which column is it? (${absent.target.words.toLowerCase()})`;
      return `Which column is the time? Where there is none, type how many rows a second has, in ${ROWS}.`;
    }
    if (this.per.hidden || Number(this.counts.value) > 0) return "";
    this.counts.focus();
    return `How many counts has a ${PER[this.kind].words}? The data sheet of the encoder says; often it is four times its lines.`;
  }
  clear() {
    for (const { text } of this.fields) text.value = "";
    for (const box of this.kinds) box.checked = false;
    for (const { unit } of this.fields) unit.value = "";
    this.counts.value = "";
    this.columns = [];
    this.found.replaceChildren();
    this.tell();
  }
  /**
   * Show the columns of a file; what they are taken for is filled in where nothing is yet.
   * @param {FileColumn[]} columns
   * @param {Record<string, import("./types.js").Guess>} guess
   */
  show(columns, guess) {
    this.columns = columns;
    this.found.replaceChildren(...columns.map((column) => this.tile(column)));
    for (const field3 of this.fields) {
      const known2 = guess[field3.name];
      const same = columns.some(({ name: name2 }) => name2 === field3.name) ? field3.name : "";
      if (field3.text.value) continue;
      field3.text.value = known2 ? plain3(known2.expression.replace(/^`([^`]*)`$/, "$1")) : same;
      const unit = known2?.unit ?? (field3.name === "t" && known2 ? this.seconds(field3.text.value) : "");
      if (unit) this.measure(field3, unit);
    }
    this.at = this.fields.find(({ text }) => !text.value)?.text ?? this.at;
    this.tell();
  }
  /** The second, where a time without a unit can hardly be in another one. @param {string} written */
  seconds(written) {
    const column = this.columns.find(({ name: name2 }) => plain3(name2) === written);
    return column && rateOf(column) >= RATE ? "s" : "";
  }
  /** @param {FileColumn} column */
  tile({ name: name2, low, high, outline }) {
    const range2 = `${number(low)} … ${number(high)}`;
    const canvas = make("canvas", { "aria-hidden": "true", ...SIZE2 });
    draw(canvas, outline);
    return make(
      "button",
      {
        ...{ type: "button", title: "put into the chosen field" },
        on: { click: () => this.put(name2) }
      },
      make("strong", { text: name2 }),
      " ",
      canvas,
      make("span", { class: "soft", text: range2 })
    );
  }
  /** @param {string} column name that goes into the field, of which the next free one is then chosen */
  put(column) {
    const field3 = this.fields.find(({ text }) => text === this.at);
    this.at.value = plain3(column);
    if (field3) this.measure(field3, /[[(]([^\])]+)[\])]\s*$/.exec(column)?.[1] ?? "");
    this.at = this.fields.find(({ text }) => !text.value)?.text ?? this.at;
    this.at.focus();
    this.tell();
  }
  /** @param {Mapping["fields"][number]} field @param {string} written a unit, or what is none of the list */
  measure(field3, written) {
    const unit = SPELT[written] ?? written;
    const known2 = KINDS2.some((kind) => field3.target.units[kind].includes(unit));
    field3.unit.value = known2 ? unit : "";
    this.chose(field3.unit.value);
  }
  /** What a position is in is most often what its velocity is in a second: filled in where nothing is yet. @param {string} unit */
  follow(unit) {
    for (const [name2, following] of [["omega", `${unit}/s`], ["alpha", `${unit}/s^2`]]) {
      const field3 = this.fields.find((one) => one.name === name2);
      if (field3 && field3.text.value.trim() && !field3.unit.value) this.measure(field3, following);
    }
  }
  /** A unit was chosen: one of a length says that the axis slides. @param {string} unit */
  chose(unit) {
    for (const [at, kind] of KINDS2.entries()) {
      const only = (one) => Object.values(TARGETS).some(({ units }) => units[one].includes(unit));
      if (unit && only(kind) && !only(KINDS2[1 - at])) this.kinds[at].checked = true;
    }
    this.tell();
  }
  /** Offer the units of the kind of axis, and say what each column would be in them. */
  tell() {
    const kind = this.kind;
    const counted2 = this.fields.find(({ name: name2 }) => name2 === "theta");
    this.per.hidden = counted2?.unit.value !== COUNTS || saysUnit(counted2.text.value.trim());
    this.perWhat.textContent = `counts in a ${PER[kind ?? "rotary"].words}${kind ? "" : " (or a millimetre)"}`;
    for (const { target, text, unit, range: range2 } of this.fields) {
      const offered = [...new Set(kind ? target.units[kind] : KINDS2.flatMap((one) => target.units[one]))];
      const chosen = unit.value;
      const options = [make("option", { value: "", text: "unit?" }), ...offered.map((one) => make("option", { value: one, text: one }))];
      if (unit.options.length !== options.length || unit.options[1].value !== offered[0]) unit.replaceChildren(...options);
      unit.value = offered.includes(chosen) ? chosen : "";
      const column = this.columns.find(({ name: name2 }) => plain3(name2) === text.value.trim());
      range2.textContent = column ? spread(column, unit.value, Number(this.counts.value), kind) : "";
    }
  }
};
function spread(column, unit, counts, kind) {
  const { low, high } = column;
  if (low === null || high === null) return "no value at all";
  const ends2 = `${number(low)} … ${number(high)}`;
  if (unit === COUNTS) {
    const way = (high - low) / counts;
    const felt2 = kind === "linear" ? `${number(way)} mm` : `${number(360 * way)} degrees`;
    return `${ends2} counts${counts > 0 ? `, over ${felt2}` : ""}`;
  }
  if (unit === "s") return `${ends2} s, ${number(rateOf(column))} rows a second`;
  const degrees = (high - low) * DEGREES[unit];
  const felt = degrees > TURNS * 360 ? `${number(degrees / 360)} turns` : `${number(degrees)} degrees`;
  return `${ends2} ${unit}${unit in DEGREES ? `, over ${felt}` : ""}`;
}
function rateOf({ rows, low, high }) {
  return (rows - 1) / ((high ?? 0) - (low ?? 0));
}
function plain3(column) {
  return /^[A-Za-z_]\w*$/.test(column) ? column : `\`${column}\``;
}
function saysUnit(written) {
  return written.endsWith("]");
}
function draw(canvas, outline) {
  const brush = canvas.getContext("2d");
  if (!brush) return;
  const step = SIZE2.width / Math.max(1, outline.length);
  brush.fillStyle = "#0072b2";
  for (const [at, [low, high]] of outline.entries()) {
    const top = (1 - high) * (SIZE2.height - 3);
    brush.fillRect(at * step, top, Math.max(1, step), Math.max(2, (high - low) * (SIZE2.height - 3)));
  }
}

// src/files.js
function opening(heard) {
  const dialog3 = (
    /** @type {HTMLDialogElement} */
    byId("open-dialog")
  );
  const chosen = (
    /** @type {HTMLInputElement} */
    byId("open-file")
  );
  const path = (
    /** @type {HTMLInputElement} */
    byId("open-path")
  );
  const told = byId("open-said");
  const same = (
    /** @type {HTMLInputElement} */
    byId("open-same")
  );
  let waiting = [];
  let alike = [];
  const mapping = new Mapping(byId("open-map"), byId("open-columns"));
  const opened = (name2) => {
    dialog3.close();
    told.textContent = "";
    heard.say(`opened ${name2}`);
    heard.done();
  };
  const refused = (reason2) => {
    heard.say("");
    told.textContent = wordsOf(reason2);
    if (reason2 instanceof Refusal && reason2.columns) {
      mapping.show(reason2.columns, reason2.guess);
      byId("open-more").setAttribute("open", "");
    }
    if (!dialog3.open) dialog3.showModal();
  };
  const each = async (given, read) => {
    try {
      for (const [at, one] of given.entries()) opened(await read(one, at > 0 || same.checked, at));
    } catch (reason2) {
      refused(reason2);
    }
  };
  const take = (files) => {
    waiting = files;
    return each(files, async (file, together) => {
      heard.say(`reading ${file.name} …`);
      await upload(file, { ...mapping.options(), together: String(together) });
      waiting = waiting.filter((one) => one !== file);
      return file.name;
    });
  };
  const byPath = (paths) => each(paths, async (one, together, at) => {
    [path.value, alike] = [one, paths.slice(at + 1)];
    await post("open", { path: one, together, ...mapping.options() });
    path.value = "";
    return one;
  });
  const fresh = (files) => {
    mapping.clear();
    [path.value, alike] = ["", []];
    byId("open-named").textContent = `chosen: ${files.map(({ name: name2 }) => name2).join(", ")}`;
    return take(files);
  };
  byId("open").addEventListener("click", () => {
    mapping.clear();
    [waiting, alike] = [[], []];
    told.textContent = byId("open-named").textContent = "";
    dialog3.showModal();
  });
  byId("open-close").addEventListener("click", () => dialog3.close());
  chosen.addEventListener("change", () => {
    fresh([...chosen.files ?? []]);
    chosen.value = "";
  });
  byId("open-map").addEventListener("input", () => told.textContent = "");
  byId("open-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const named2 = path.value.trim();
    told.textContent = mapping.lacking();
    if (told.textContent) return void 0;
    if (!named2 && waiting.length === 0) {
      told.textContent = "Choose a file, or type its path.";
      return void 0;
    }
    if (!named2) return take(waiting);
    return byPath([named2, ...alike]);
  });
  const zone = byId("drop");
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    zone.hidden = false;
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) zone.hidden = true;
  });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    zone.hidden = true;
    fresh([...event.dataTransfer?.files ?? []]);
  });
  return byPath;
}
function saving(heard) {
  for (const button of document.querySelectorAll("[data-save]")) {
    button.addEventListener("click", async () => {
      const what = button.getAttribute("data-save") ?? "";
      byId("save").removeAttribute("open");
      try {
        heard.say(`making the ${what} …`);
        const { name: name2, blob } = await download(what);
        const link2 = make("a", { href: URL.createObjectURL(blob), download: name2 });
        link2.click();
        setTimeout(() => URL.revokeObjectURL(link2.href), 1e4);
        heard.say(`saved ${name2}`);
      } catch (reason2) {
        heard.failed(reason2);
      }
    });
  }
}

// src/hidden.js
var hiding = [];
var asked = 0;
var level = "";
function unhiding({ failed, done }) {
  byId("unhide").addEventListener("click", async () => {
    try {
      const told = await Promise.all(hiding.map((capture) => post("hidden", { capture })));
      byId("unhidden").textContent = [...new Set(told.map(({ hidden }) => (hidden ?? []).map(titleOf).join(" and ")))].join("; ");
    } catch (reason2) {
      failed(reason2);
    }
  });
  const hint = (whole) => post("hint", { capture: hiding[0], whole }).catch(failed);
  byId("hint").addEventListener("click", () => hint(false));
  byId("unseal").addEventListener("click", () => hint(true));
  byId("next-challenge").addEventListener("click", () => post("simulate", { level }).then(done, failed));
}
async function showHidden({ captures, active }) {
  const now = captures.filter(({ id, hides }) => hides && active.includes(id)).map(({ id }) => id);
  byId("hides").hidden = now.length === 0;
  if (now.join() !== hiding.join()) byId("unhidden").textContent = "";
  hiding = now;
  if (now.length === 0) {
    document.body.classList.remove("sealed");
    return;
  }
  const mine = ++asked;
  const told = await ask("challenge", { capture: now[0] }).catch(() => null);
  if (told && mine === asked) showStanding(told);
}
function showStanding({ hints, more, wrong, found: found2, hidden, solved, given_up, graded, level: of, sealed, score }) {
  const over = solved || given_up;
  level = of;
  document.body.classList.toggle("sealed", sealed);
  byId("unseal").hidden = !sealed;
  byId("challenge-said").classList.toggle("well", solved && !given_up);
  byId("challenge-score").textContent = graded ? `${score} points` : "";
  byId("challenge-said").textContent = graded ? standingWords({ wrong, found: found2, hidden, solved, given_up }) : surpriseWords({ found: found2, hidden, solved });
  byId("hint").hidden = !graded || over;
  byId("unhide").hidden = graded && solved && !given_up;
  byId("next-challenge").hidden = !graded || !over;
  byId("challenge-hints").replaceChildren(...hints.map((text) => make("li", { text })));
  byId("hint").disabled = !more;
}
function surpriseWords({ found: found2, hidden, solved }) {
  const [what, is] = hidden === 1 ? ["What was hidden", "one effect is"] : [`All ${hidden} effects that were hidden`, `${hidden} effects are`];
  if (solved) return `${what} ${hidden === 1 ? "is" : "are"} in the model, and nothing that was not.`;
  if (found2 === hidden) return `${what} ${hidden === 1 ? "is" : "are"} in the model, but so is something that was not.`;
  return `In this knob ${is} hidden${found2 > 0 ? `, ${found2} of them found` : ""}: see whether it is found.`;
}
function standingWords({ wrong, found: found2, hidden, solved, given_up }) {
  const many = hidden === 1 ? "one effect is hidden" : `${hidden} effects are hidden`;
  const costs = wrong.length > 0 ? `; not there: ${wrong.map(titleOf).join(", ")}` : "";
  if (given_up) return `Given up: ${solved ? "what was hidden is in the model, after it was told" : "add what was hidden, and see the residual become noise"}${costs}.`;
  if (solved) return `Solved: what was hidden is in the model, and nothing that was not${costs}.`;
  if (found2 === hidden) return `All that is hidden is in the model, but so is something else${costs}.`;
  return `In this knob ${many}${found2 > 0 ? `, ${found2} of them found` : ""}. Look where the residual has structure, and add what explains it${costs}.`;
}

// src/job.js
var NOTHING2 = { unit: "N m", peak: 0, coordinate: "rotary" };
function jobButtons(ask2, say) {
  byId("cancel").addEventListener("click", async () => {
    const answer = await ask2("cancel");
    if (answer?.cancelled === false) say("too late to cancel: it is done");
  });
  byId("enough").addEventListener("click", () => ask2("enough"));
}
var LONG_S = 2;
var since = 0;
var clock;
function showJob(job, about2) {
  byId("job").hidden = job === null;
  clearInterval(clock);
  if (!job) return;
  byId("job-what").textContent = sentence(job.what, about2 ?? NOTHING2);
  byId("enough").hidden = !job.stops;
  const bar2 = (
    /** @type {HTMLProgressElement} */
    byId("job-done")
  );
  if (job.done === null) bar2.removeAttribute("value");
  else bar2.value = job.done;
  since = performance.now() - 1e3 * job.seconds;
  const tick = () => void (byId("job-time").textContent = timeWords((performance.now() - since) / 1e3, job.takes_s));
  tick();
  clock = setInterval(tick, 1e3);
}
function timeWords(seconds2, takes) {
  const usual = takes ? `, usually ${number(takes[0], 1)} to ${number(takes[1], 1)} s` : "";
  return seconds2 < LONG_S && !usual ? "" : `${Math.floor(seconds2)} s${usual}`;
}

// src/keys.js
var WITHOUT_LETTERS = /* @__PURE__ */ new Set(["range", "checkbox", "radio"]);
function keys({ stop, clear, closer }) {
  document.addEventListener("keydown", (event) => {
    const typed = event.target instanceof HTMLInputElement && !WITHOUT_LETTERS.has(event.target.type);
    const control = event.ctrlKey || event.metaKey;
    const chosen = event.target instanceof HTMLSelectElement && !control;
    if ((typed || chosen) && event.key !== "Escape") return;
    const key2 = event.key.toLowerCase();
    if (event.key === "Escape") {
      if (!stop() && !closeMenu(true) && !closePanel()) clear();
    } else if (!control && !event.altKey && key2 === "z") {
      closer();
    } else if (control && (key2 === "y" || key2 === "z" && event.shiftKey)) {
      event.preventDefault();
      byId("redo").click();
    } else if (control && key2 === "z") {
      event.preventDefault();
      byId("undo").click();
    }
  });
  document.addEventListener("pointerdown", ({ target }) => {
    if (!(target instanceof Element && target.closest("details.menu"))) closeMenu(false);
  });
}
function closePanel() {
  const close = ["lead-close", "next-close"].map(byId).find((button) => button.offsetParent !== null);
  close?.click();
  return close !== void 0;
}
function closeMenu(focus) {
  const menu = document.querySelector("details.menu[open]");
  menu?.removeAttribute("open");
  if (focus) menu?.querySelector("summary")?.focus();
  return menu !== null;
}

// src/ladder.js
var FLOOR = "What noise alone would leave. It is read from the torque and from what the model leaves of it, where that is quieter: an error that is the same in every stretch passes for noise until the model has what makes it, and then the floor falls.";
var SAME = 0.1;
function showLadder(place4, state) {
  const branch = state.branches.find(({ id }) => id === state.branch);
  const key2 = JSON.stringify([branch, state.carried, state.rmse, state.noise_floor, state.unit, state.peak]);
  if (place4.dataset.shown === key2) return;
  place4.dataset.shown = key2;
  const { steps, at: here } = broughtAlong(sameCaptures(branch?.steps ?? [], branch?.at ?? 0), state.carried);
  const errors = steps.flatMap(({ rmse, rmse_heldout }) => [rmse, rmse_heldout]).concat(state.rmse);
  const floor = state.noise_floor;
  const widest = Math.max(...errors.map((error) => error ?? 0), ...steps.map((step) => step.noise_floor ?? 0)) * 1.02;
  const scale = torqueScale(state);
  const shown2 = (value) => figure(value === null ? null : value * scale.factor);
  const lines = steps.map(({ added, along, dropped, rmse, rmse_heldout, noise_floor }, at) => {
    const now = at === here;
    const undone = at > here;
    const label = changeOf({ added, along, dropped }) || (at === 0 ? "first model" : "fitted anew");
    const bar2 = make("span", { class: "bar" });
    const held = make("span", { class: "held" });
    bar2.style.width = `${100 * rmse / widest}%`;
    if (now && at > 0) bar2.style.setProperty("--from", `${100 * steps[at - 1].rmse / widest}%`);
    if (rmse_heldout !== null) held.style.left = `${100 * rmse_heldout / widest}%`;
    const track = make("span", { class: "track" }, bar2, rmse_heldout === null ? null : held, floorMark(noise_floor, widest));
    return make(
      "li",
      { class: `ladder-line${now ? " now" : ""}${undone ? " undone" : ""}`, "aria-current": now ? "step" : null },
      make("span", { class: "label", text: label, title: [added, ...along, ...dropped].filter(Boolean).join(", ") || label }),
      make("span", { class: "figure", text: shown2(rmse), title: "RMS error" }),
      make("span", { class: "figure soft", text: shown2(rmse_heldout), title: "on blocks that the fit did not see" }),
      track
    );
  });
  const head2 = make(
    "div",
    { class: "ladder-line head" },
    make("span", { class: "legend", text: floor === null ? "noise floor unknown" : `▖noise floor ${floorWords(steps, here, shown2)}`, title: FLOOR }),
    make("span", { class: "figure", text: `RMS, ${scale.unit}` }),
    make("span", { class: "figure", text: "unseen" })
  );
  place4.replaceChildren(head2, make("ol", {}, ...lines));
  const dragged = state.params.some((param) => param.dragged);
  if (dragged) place4.append(make("p", { class: "soft", text: `as dragged: ${shown2(state.rmse)} ${scale.unit}` }));
}
function sameCaptures(steps, at) {
  const of = (step) => steps[step]?.captures.join();
  let [first, end] = [at, at + 1];
  while (first > 0 && !steps[first].anew && of(first - 1) === of(at)) first--;
  while (end < steps.length && !steps[end].anew && of(end) === of(at)) end++;
  return { steps: steps.slice(first, end), at: at - first };
}
function broughtAlong({ steps, at }, carried) {
  const brought = carried.map((one) => ({ ...steps[0], along: [], dropped: [], ...one }));
  return brought.length > 1 ? { steps: [...brought, ...steps.slice(1)], at: at + brought.length - 1 } : { steps, at };
}
function floorWords(steps, here, shown2) {
  const [now, first] = [steps[here].noise_floor ?? 0, steps[0].noise_floor ?? 0];
  const other = now > 0 && first > 0 && Math.abs(now / first - 1) > SAME;
  return other ? `${shown2(now)} (${shown2(first)} seen by the first model)` : shown2(now);
}
function floorMark(floor, widest) {
  if (floor === null) return null;
  const mark = make("span", { class: "floor" });
  mark.style.left = `${100 * floor / widest}%`;
  return mark;
}

// src/latest.js
function latest(work) {
  const next = [];
  let busy = false;
  return async (argument) => {
    next.splice(0, next.length, argument);
    if (busy) return;
    busy = true;
    try {
      for (let one = next.pop(); one !== void 0; one = next.pop()) await work(one);
    } finally {
      busy = false;
    }
  };
}

// src/leaving.js
var MOST = 1e3;
var REST_MS = 150;
function leaving(linked, state, leave) {
  const button = (
    /** @type {HTMLButtonElement} */
    byId("leave-out")
  );
  const now = () => {
    const known2 = state();
    return known2 && linked.data && linked.chosen ? runsOf(linked.chosen, linked.data.columns.t, stretchOf(linked), known2) : {};
  };
  button.addEventListener("click", () => {
    const runs = now();
    if (Object.keys(runs).length > 0) leave(runs);
  });
  const offer = () => {
    const runs = now();
    const every = Object.values(runs);
    button.hidden = every.length === 0;
    button.disabled = every.some((one) => one.length > MOST);
    button.textContent = linked.data ? words2(every.flat(), linked.data) : "";
    button.title = button.disabled ? "too many single samples: brush a stretch of time" : "nothing is fitted to them any more, and the model is fitted anew; Undo takes them in again";
  };
  let rest = 0;
  return () => {
    clearTimeout(rest);
    if (!linked.chosen?.length) return offer();
    rest = setTimeout(offer, REST_MS);
  };
}
function stretchOf(linked) {
  const { brushed } = linked;
  return brushed && linked.axes[Math.floor(brushed.plot / 3)] === "time" ? brushed.x : null;
}
function runsOf(chosen, t, stretch2, { captures, active }) {
  const runs = {};
  const out = new Uint8Array(t.length);
  if (stretch2) for (let i = 0; i < t.length; i++) out[i] = Number(t[i] >= stretch2[0] && t[i] <= stretch2[1]);
  else for (const at of chosen) out[at] = 1;
  let start = 0;
  for (const id of active) {
    const end = start + (captures.find((one) => one.id === id)?.samples ?? 0);
    for (let i = start; i < end; i++) {
      if (!out[i]) continue;
      const first = i;
      while (i + 1 < end && out[i + 1]) i++;
      (runs[id] ??= []).push([first - start, i - start]);
    }
    start = end;
  }
  return runs;
}
function words2(runs, { several, columns: { t } }) {
  if (runs.length > 1) return `Leave out ${thousands(runs.length)} stretches`;
  if (several || runs.length === 0) return "Leave these out";
  const [from, to] = runs[0].map((at) => number(t[at], 4));
  return `Leave out ${from} to ${to} s`;
}

// src/legend.js
function showLegend({ below_hz: edge, unit }, { masked, residual }, beside2) {
  byId("beside").hidden = beside2 === null;
  byId("beside-name").textContent = beside2 ?? "";
  byId("masked").hidden = !(masked && residual.some((value) => value !== value));
  byId("measured").title = edge === null ? "as it was recorded" : `the recorded ${torqueWord(unit)} below ${number(edge)} Hz: a filter takes off what is faster, of the modelled one too`;
}

// src/curve.js
var ALONG = { t: "time", theta: "position", omega: "velocity", alpha: "acceleration", s: "history", load: "load" };
function drawCurve(canvas, curve, about2, looked) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const brush = canvas.getContext("2d");
  if (!brush || width === 0) return;
  const scale = globalThis.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
  brush.scale(scale, scale);
  const { x, value, band: band2, laws } = curve;
  const edges = [-1, 1].map((side) => value.map((one, at) => one === null ? NaN : one + side * (band2[at] ?? NaN)));
  const drawn = laws.map((law) => law?.map((one) => one ?? NaN) ?? null);
  const [low, high] = limits([...edges, ...drawn.filter((law) => law !== null)].map((one) => Float32Array.from(one)), { around: 0 });
  const shown2 = curve.times ? { factor: 1, unit: "" } : torqueScale(about2);
  const y = { low, high, factor: shown2.factor, label: `left over${curve.times ? ` / ${factorOf(curve.times)}` : `, ${shown2.unit}`}` };
  const names = { ink: "--ink", soft: "--soft", line: "--grid", band: "--band", wrong: "--wrong", law: "--signature", rest: "--measured" };
  const colours = Object.fromEntries(Object.entries(names).map(([name2, style]) => [name2, styleValue(style, canvas)]));
  const first = { low: x[0], high: x[x.length - 1], factor: 1, label: overWords(curve.over, about2) };
  drawAxes(brush, { width, height }, { x: first, y, title: "", colours: (
    /** @type {any} */
    colours
  ), noise: null });
  const [left, right, top, bottom] = [MARGIN.left, width - MARGIN.right, MARGIN.top, height - MARGIN.bottom];
  const across = (one) => left + (one - first.low) / (first.high - first.low) * (right - left);
  const up = (one) => bottom - (one - low) / (high - low) * (bottom - top);
  brush.globalAlpha = 0.45;
  brush.fillStyle = colours.band;
  for (let at = 1; at < x.length; at++) {
    const corners = [edges[0][at - 1], edges[0][at], edges[1][at], edges[1][at - 1]];
    if (corners.some(Number.isNaN)) continue;
    brush.beginPath();
    for (const [n, one] of corners.entries()) brush.lineTo(across(x[n === 0 || n === 3 ? at - 1 : at]), up(one));
    brush.fill();
  }
  brush.globalAlpha = 1;
  const line2 = (values, colour, thick, dashes) => {
    [brush.strokeStyle, brush.lineWidth] = [colour, thick];
    brush.setLineDash(dashes);
    brush.beginPath();
    let down = false;
    for (const [at, one] of values.entries()) {
      if (one === null || Number.isNaN(one)) down = false;
      else if (down) brush.lineTo(across(x[at]), up(one));
      else brush.moveTo(across(x[at]), up(one));
      down = one !== null && !Number.isNaN(one);
    }
    brush.stroke();
  };
  line2(value, colours.ink, 1.5, []);
  for (const [at, law] of drawn.entries()) if (law && at + 1 !== looked) line2(law, colours.rest, 1, [2, 3]);
  const mine = drawn[looked - 1];
  if (mine) line2(mine, colours.law, 2.5, [7, 4]);
}
function curveWords({ over, laws }, looked) {
  const law = laws[looked - 1] ? `; green: law ${looked}` : "";
  return `Black: what is left over ${wordOf(over)}, with its 95 % band${law}. What the model's parameters can take is off all of them.`;
}
function wordOf(over) {
  const inside = over.replace(/^abs\((.*)\)$/, "$1");
  const word = ALONG[inside] ? AXES[ALONG[inside]].words : over;
  return inside === over ? word : `the magnitude of ${word}`;
}
function overWords(over, about2) {
  const inside = over.replace(/^abs\((.*)\)$/, "$1");
  const along = ALONG[inside];
  if (!along) return over;
  const label = labelOf(along, about2);
  return inside === over ? label : `|${label.replace(", ", "|, ")}`;
}
function factorOf(times2) {
  return times2 in ALONG ? variableOf(times2) : `(${times2})`;
}
var TURNS2 = { t: "t", theta: "θ", omega: "ω", alpha: "α", s: "s" };
var SLIDES = { ...TURNS2, theta: "x", omega: "v", alpha: "dv/dt" };
function lettered(variables, { coordinate }) {
  const letters = coordinate === "linear" ? SLIDES : TURNS2;
  return variables.map((one) => one in letters ? `${variableOf(one)} ${letters[one]}` : variableOf(one)).join(", ");
}
function variableOf(variable) {
  const along = (
    /** @type {Record<string, import("./contents.js").Along>} */
    ALONG[variable]
  );
  return along ? AXES[along].words : variable;
}

// src/surface.js
function drawSurface(canvas, surface, about2, law) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const brush = canvas.getContext("2d");
  if (!brush || width === 0) return;
  const scale = globalThis.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
  brush.scale(scale, scale);
  const names = { ink: "--ink", soft: "--soft", line: "--grid", band: "--band", wrong: "--wrong", low: "--modelled" };
  const colours = Object.fromEntries(Object.entries(names).map(([name2, style]) => [name2, styleValue(style, canvas)]));
  const [x, y] = [surface.x, surface.y].map((places, at) => ({
    ...ends(places),
    ...{ factor: 1, label: overWords(surface.over[at], about2) }
  }));
  const title = law === null ? "what is left" : `law ${law}`;
  drawAxes(brush, { width, height }, { x, y, title, colours: (
    /** @type {any} */
    colours
  ), noise: null });
  const shown2 = law === null ? surface.value : surface.laws[law - 1];
  if (!shown2) return;
  const most = largest2(surface);
  const [left, right, top, bottom] = [MARGIN.left, width - MARGIN.right, MARGIN.top, height - MARGIN.bottom];
  const [wide, high] = [(right - left) / surface.x.length, (bottom - top) / surface.y.length];
  for (const [row, values] of shown2.entries()) {
    for (const [column, value] of values.entries()) {
      if (value === null) continue;
      brush.globalAlpha = Math.min(1, Math.abs(value) / most);
      brush.fillStyle = value < 0 ? colours.low : colours.wrong;
      brush.fillRect(left + column * wide, bottom - (row + 1) * high, wide + 0.5, high + 0.5);
    }
  }
  brush.globalAlpha = 1;
}
function ends(places) {
  const half = places.length > 1 ? 0.5 * (places[1] - places[0]) : 0.5;
  return { low: places[0] - half, high: places[places.length - 1] + half };
}
function largest2({ value }) {
  return Math.max(...value.flat().map((one) => Math.abs(one ?? 0))) || 1;
}
function surfaceWords(surface, about2) {
  const scale = surface.times ? { factor: 1, unit: `${about2.unit} / (${surface.times})` } : torqueScale(about2);
  const most = `${number(largest2(surface) * scale.factor)} ${scale.unit}`;
  return `Over two variables: orange up to ${most}, blue as far below zero; blank where the motion did not go.`;
}

// src/laws.js
var TYPED_MS = 350;
var Laws = class {
  /**
   * @param {HTMLElement} place
   * @param {{ask: () => void, look: (number: number | null) => void, take: (number: number, name: string) => void,
   *   add: (formula: object) => Promise<boolean>, attempt: (formula: object, tried: (tried: Law) => void) => Promise<string>}} deeds
   */
  constructor(place4, deeds) {
    this.place = place4;
    this.deeds = deeds;
    this.shown = "";
    this.of = "";
    this.about = null;
    new ResizeObserver(() => this.draw()).observe(byId("curve"));
    new ResizeObserver(() => this.draw()).observe(byId("surface"));
    new ResizeObserver(() => fitFormulas(place4)).observe(place4);
    const form = (
      /** @type {HTMLFormElement} */
      byId("own-form")
    );
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      clearTimeout(this.typing);
      if (await this.deeds.add(Object.fromEntries(new FormData(form)))) form.reset();
      byId("own-tried").textContent = "";
    });
    form.addEventListener("input", ({ target }) => {
      if (!(target instanceof HTMLInputElement && target.name === "name")) this.typed(form);
    });
    this.typing = void 0;
  }
  /** Of other captures what was typed says nothing. @param {string} captures */
  another(captures) {
    if (this.of !== "") byId("own-form").reset();
    clearTimeout(this.typing);
    byId("own-tried").textContent = "";
    this.of = captures;
  }
  /** Fit what is typed, once nothing more comes, and say what it would leave. @param {HTMLFormElement} form */
  typed(form) {
    clearTimeout(this.typing);
    const said = byId("own-tried");
    this.typing = setTimeout(async () => {
      const formula = Object.fromEntries(new FormData(form));
      if (String(formula.law).trim() === "") {
        said.textContent = "";
        return this.deeds.look(null);
      }
      const now = this.typing;
      const words4 = await this.deeds.attempt(formula, ({ rmse, rmse_heldout, words: params, doubt }) => {
        if (now !== this.typing || !this.about) return;
        const scale = torqueScale(this.about);
        const unseen = rmse_heldout === null ? "" : `, ${number(rmse_heldout * scale.factor)} on unseen blocks`;
        said.className = "";
        said.textContent = `would leave ${number(rmse * scale.factor)} ${scale.unit}${unseen}; ${[...params, ...doubt ? [`⚠ ${doubt}`] : []].join("; ")}`;
      });
      if (now !== this.typing || words4 === "") return void 0;
      said.className = "doubt";
      said.textContent = words4;
      return void 0;
    }, TYPED_MS);
  }
  /** Draw the curve, with one of the laws before the others, and the map beside that of the law. @param {number} [looked] from 1 */
  draw(looked = 1) {
    this.drawMaps(looked);
    const curve = this.about?.curve ?? null;
    byId("curve").hidden = curve === null;
    if (!curve || !this.about) return;
    const canvas = (
      /** @type {HTMLCanvasElement} */
      byId("curve-plot")
    );
    drawCurve(canvas, curve, this.about, looked);
    const words4 = curveWords(curve, looked);
    byId("curve-words").textContent = words4;
    canvas.setAttribute("aria-label", words4);
  }
  /** @param {number} looked from 1; of a law of fewer variables, the first that has a map stays beside */
  drawMaps(looked) {
    const surface = this.about?.surface ?? null;
    byId("surface").hidden = surface === null;
    if (!surface || !this.about) return;
    const law = surface.laws[looked - 1] ? looked : surface.laws.findIndex((one) => one !== null) + 1;
    const words4 = surfaceWords(surface, this.about);
    byId("surface-words").textContent = words4;
    for (
      const [id, shown2] of
      /** @type {const} */
      [["surface-left", null], ["surface-law", law]]
    ) {
      const canvas = (
        /** @type {HTMLCanvasElement} */
        byId(id)
      );
      drawSurface(canvas, surface, this.about, shown2);
      canvas.setAttribute("aria-label", `${shown2 === null ? "what is left" : `what law ${shown2} makes of it`}. ${words4}`);
    }
  }
  /** @param {State} state */
  show(state) {
    const { candidates, proposed, proposed_said, node, job, curve, surface, active } = state;
    if (active.join() !== this.of) this.another(active.join());
    const shown2 = JSON.stringify([candidates.ready, proposed, node, job === null]);
    if (shown2 === this.shown) return;
    this.shown = shown2;
    byId("own").hidden = node === null;
    this.about = { curve, surface, ...aboutOf(state) };
    showHow(this.about);
    this.draw();
    const nothing = candidates.unexplained === null && !candidates.rows.some((row) => row.could_be);
    if (!candidates.ready || node === null || proposed === null && nothing) {
      this.place.replaceChildren();
    } else if (proposed === null) {
      const ask2 = make("button", {
        ...{ type: "button", text: "Look for a law…", disabled: job !== null },
        ...{ title: "formulas that would explain what is left, where no effect does", on: { click: () => this.deeds.ask() } }
      });
      this.place.replaceChildren(make("p", {}, ask2));
    } else {
      const list = proposed.map((law, at) => this.item(law, at + 1));
      this.place.replaceChildren(
        make("p", { class: "soft small", role: "status" }, ...nodes(proposed_said, this.about)),
        ...list.length > 0 ? [make("ul", { class: "laws", "aria-label": "laws that are proposed" }, ...list)] : []
      );
      fitFormulas(this.place);
    }
  }
  /** @param {Law} row @param {number} number */
  item({ label, law, variables, words: words4, doubt, fall, start }, number3) {
    const of = `over ${this.about ? lettered(variables, this.about) : ""}`;
    const edit = make("button", {
      ...{ type: "button", text: "Edit…", "aria-label": `edit law ${number3}`, title: "as a formula of your own" },
      on: { click: () => edited(law, start) }
    });
    const take = make("button", {
      ...{ type: "submit", text: "Add", "aria-label": `add law ${number3}` },
      ...{ title: "fit it with the model, as an effect of this name" }
    });
    const name2 = make("input", {
      ...{ type: "text", name: "name", size: 8, placeholder: "its name", title: "what it is called in the model; law where nothing is typed", spellcheck: "false", autocomplete: "off" },
      "aria-label": `name of law ${number3}`
    });
    const form = make("form", {}, edit, name2, take);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.deeds.take(
        number3,
        /** @type {HTMLInputElement} */
        name2.value
      );
    });
    const look = () => {
      this.draw(number3);
      this.deeds.look(number3);
    };
    const away = () => {
      this.draw();
      this.deeds.look(null);
    };
    return make(
      "li",
      { class: "law", on: { pointerenter: look, pointerleave: away, focusin: look, focusout: away } },
      // What is drawn by splines has a name, and no formula that anybody reads.
      make("div", { class: "written", title: `typed as ${law}` }, `${number3}.`, label === law ? lawOf({ latex: "", law }) : make("span", { text: label })),
      make("span", { class: "figure", text: percent(-fall), title: "fall of the RMS error, beside the model that it was looked for beside" }),
      make("span", { class: "soft", text: [...words4, of].join("; ") }),
      doubt ? make("span", { class: "doubt", text: `⚠ ${doubt}` }) : null,
      form
    );
  }
};
function showHow(about2) {
  const slides = about2.coordinate === "linear";
  const [place4, speed, change] = slides ? ["x", "v", "dv/dt"] : ["theta", "omega", "alpha"];
  const word = torqueWord(about2.unit);
  byId("own-word").textContent = `${word.slice(0, 1).toUpperCase()}${word.slice(1)}`;
  byId("own-how").textContent = `It answers the ${word} in ${about2.unit}, of t, ${place4}, ${speed}, ${change}, direction and s, the way since a reversal; abs(load)*sign(${speed}) is friction under a load; every other name is a parameter.`;
  const law = (
    /** @type {HTMLInputElement} */
    /** @type {HTMLFormElement} */
    byId("own-form").elements.namedItem("law")
  );
  law.placeholder = `2 a (${speed}/w) / (1 + (${speed}/w)^2)`;
}
function edited(law, start) {
  const form = (
    /** @type {HTMLFormElement} */
    byId("own-form")
  );
  byId("own").open = true;
  for (const [name2, value] of Object.entries({ law, guess: start, name: "" })) {
    const typed = form.elements.namedItem(name2);
    if (typed instanceof HTMLInputElement) typed.value = value;
  }
  form.elements.namedItem("law").focus();
  form.dispatchEvent(new Event("input"));
}

// src/going.js
var REST_MS2 = 300;
function showLeft(left, { go, anew }) {
  byId("left-behind").hidden = left.length === 0;
  const rows = left.map(
    (one) => one.wrong === null ? make(
      "li",
      { title: one.captures.join("\n") },
      make("button", { type: "button", class: "main", on: { click: () => go(one.id) } }, "Continue"),
      make("span", {}, make("strong", { text: called(one) }), " ", make("span", { class: "soft", text: words3(one) }))
    ) : make("li", { class: "wrong", text: one.wrong })
  );
  const other = make("button", { type: "button", on: { click: anew } }, "Start anew");
  byId("left-rows").replaceChildren(...rows, make("li", {}, other));
}
var FEW4 = 2;
function called({ captures }) {
  const more = captures.length - FEW4;
  return more > 1 ? `${captures.slice(0, FEW4).join(", ")} and ${more} more` : captures.join(", ");
}
function words3({ steps, ended, when }) {
  const at = when === null ? "" : ` ${new Date(1e3 * when).toLocaleString([], { dateStyle: "medium", timeStyle: "short" })}`;
  return `${steps === 1 ? "one fit" : `${steps} fits`}, ${ended ? "ended" : "broken off"}${at}`;
}
var Looking = class {
  /** @param {() => Looked} now */
  constructor(now) {
    this.now = now;
    this.kept = "";
    this.timer = void 0;
  }
  changed() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      const now = this.now();
      if (JSON.stringify(now) === this.kept) return;
      this.kept = JSON.stringify(now);
      post("look", now).catch(() => {
      });
    }, REST_MS2);
  }
};

// src/brush.js
var SMALLEST2 = 4;
function brushable(plot) {
  byPointer(plot);
  plot.element.addEventListener("keydown", (event) => byKeys(plot, event));
}
function byPointer(plot) {
  const { element: element2 } = plot;
  let start = null;
  const spot = (event) => {
    const edge = element2.getBoundingClientRect();
    const wide = edge.width - MARGIN.left - MARGIN.right;
    const high = edge.height - MARGIN.top - MARGIN.bottom;
    const [x, y] = [event.clientX - edge.left - MARGIN.left, event.clientY - edge.top - MARGIN.top];
    return { x: clamped(x / wide), y: clamped(y / high), wide, high };
  };
  element2.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !plot.contents) return;
    element2.setPointerCapture(event.pointerId);
    plot.sorted();
    const { x, y } = spot(event);
    const box = plot.region && plot.boxInside(plot.region);
    const inside = box && x > box.left && x < box.left + box.width && y > box.top && y < box.top + box.height;
    start = { x, y, moved: inside ? plot.region : null };
  });
  element2.addEventListener("pointermove", (event) => {
    if (!start) return;
    const { x, y, wide, high } = spot(event);
    if (start.moved) {
      plot.brushed(plot, shifted(plot, start.moved, x - start.x, y - start.y));
    } else if (Math.abs(x - start.x) * wide >= SMALLEST2 && Math.abs(y - start.y) * high >= SMALLEST2) {
      plot.brushed(plot, between(plot, start, { x, y }));
    }
  });
  element2.addEventListener("pointerup", (event) => {
    const { x, y, wide, high } = spot(event);
    if (start && Math.hypot((x - start.x) * wide, (y - start.y) * high) < SMALLEST2) plot.brushed(plot, null);
    start = null;
  });
  element2.addEventListener("pointercancel", () => start = null);
}
function byKeys(plot, event) {
  const step = 0.02;
  const ways = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  if (!(event.key in ways) || !plot.contents || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  const [x, y] = ways[
    /** @type {keyof typeof ways} */
    event.key
  ];
  if (!plot.region) {
    plot.brushed(plot, between(plot, { x: 0.4, y: 0.02 }, { x: 0.6, y: 0.98 }));
  } else if (event.shiftKey) {
    const box = plot.boxInside(plot.region);
    const [right, bottom] = [box.left + box.width + x, box.top + box.height + y];
    plot.brushed(plot, between(plot, { x: box.left, y: box.top }, { x: clamped(right), y: clamped(bottom) }));
  } else {
    plot.brushed(plot, shifted(plot, plot.region, x, y));
  }
}
function clamped(share) {
  return Math.min(1, Math.max(0, share));
}
function between(plot, one, other) {
  const { x, y } = plot.frame;
  const [left, right] = [Math.min(one.x, other.x), Math.max(one.x, other.x)];
  const [top, bottom] = [Math.min(one.y, other.y), Math.max(one.y, other.y)];
  return {
    x: [x[0] + left * (x[1] - x[0]), x[0] + right * (x[1] - x[0])],
    y: [y[1] - bottom * (y[1] - y[0]), y[1] - top * (y[1] - y[0])]
  };
}
function shifted(plot, region, right, down) {
  const { x, y } = plot.frame;
  const [across, up] = [right * (x[1] - x[0]), -down * (y[1] - y[0])];
  return { x: [region.x[0] + across, region.x[1] + across], y: [region.y[0] + up, region.y[1] + up] };
}

// src/cursor.js
var NEAR = 14;
var PARTS = 200;
function pointing(plots, times2, told) {
  let now = null;
  const go = (at) => {
    if (at === now) return;
    now = at;
    for (const plot of plots) plot.mark(at);
    told(at);
  };
  for (const plot of plots) {
    plot.element.addEventListener("pointermove", (event) => {
      if (event.buttons !== 0) return;
      const edge = plot.element.getBoundingClientRect();
      const at = nearest(plot, event.clientX - edge.left - MARGIN.left, event.clientY - edge.top - MARGIN.top);
      if (at !== null) go(at);
    });
    plot.element.addEventListener("keydown", (event) => {
      const t = times2();
      if (!t || event.key !== "," && event.key !== ".") return;
      const step = Math.max(1, Math.round(t.length / PARTS)) * (event.key === "." ? 1 : -1);
      go(Math.min(t.length - 1, Math.max(0, (now ?? 0) + step)));
    });
  }
  return { none: () => go(null) };
}
function nearest(plot, x, y) {
  const pixels = plot.pixels(plot.contents?.picked ?? 0);
  if (!pixels || pixels.length === 0) return null;
  const { width, height } = plot.frame;
  const [column, row, reach2] = [x, y, NEAR].map((length) => Math.round(length * plot.scale));
  const rect = {
    ...{ left: Math.max(0, column - reach2), right: Math.min(width - 1, column + reach2) },
    ...{ top: Math.max(0, row - reach2), bottom: Math.min(height - 1, row + reach2) }
  };
  if (rect.left > rect.right || rect.top > rect.bottom) return null;
  let best = null;
  let least = Infinity;
  for (const at of plot.sorted().inside(rect)) {
    const above = pixels[at] / width | 0;
    const away = (above - row) ** 2 + (pixels[at] - above * width - column) ** 2;
    if (away < least) [best, least] = [at, away];
  }
  return best;
}

// src/pick.js
var CELL = 16;
var MANY = 1 / 32;
var Pick = class {
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
      const row = pixel / width | 0;
      of[i] = (row / CELL | 0) * this.columns + ((pixel - row * width) / CELL | 0);
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
          const y = pixel / this.width | 0;
          const x = pixel - y * this.width;
          if (x >= left && x <= right && y >= top && y <= bottom) this.found[count++] = this.order[at];
        }
      }
    }
    const found2 = this.found.subarray(0, count);
    if (count > MANY * this.taken.length) this.inOrder(found2);
    return found2;
  }
  /** Put points in the order of their numbers: what is looked up of each then lies side by side in memory. @param {Uint32Array} found */
  inOrder(found2) {
    const { taken } = this;
    for (let at = 0; at < found2.length; at++) taken[found2[at]] = 1;
    for (let i = 0, at = 0; at < found2.length; i++) {
      if (taken[i] === 0) continue;
      found2[at++] = i;
      taken[i] = 0;
    }
  }
};

// src/raster.js
function place(xs, ys, frame, pixels = new Int32Array(xs.length), every = 1) {
  const { width, height, dot: dot2 } = frame;
  const [right, bottom] = [width - dot2, height - dot2];
  const xStep = right / (frame.x[1] - frame.x[0]);
  const yStep = bottom / (frame.y[1] - frame.y[0]);
  const [xLow, yHigh] = [frame.x[0], frame.y[1]];
  const { x: cutX, y: cutY } = frame.part ?? { x: false, y: false };
  for (let i = 0; i < xs.length; i += every) {
    let column = (xs[i] - xLow) * xStep;
    let row = (yHigh - ys[i]) * yStep;
    if (!(column >= 0 && column <= right && row >= 0 && row <= bottom)) {
      const hidden = cutX && (column < 0 || column > right) || cutY && (row < 0 || row > bottom);
      if (column - column !== 0 || row - row !== 0 || hidden) {
        pixels[i] = -1;
        continue;
      }
      column = Math.min(right, Math.max(0, column));
      row = Math.min(bottom, Math.max(0, row));
    }
    pixels[i] = (row + 0.5 | 0) * width + (column + 0.5 | 0);
  }
  return pixels;
}
var scratch = new Int32Array(0);
var MANY2 = 0.25;
var USUAL2 = 4;
function cloudOf(xs, ys, frame, every = 1) {
  const { dot: dot2, width, height } = frame;
  const corners = new Uint32Array(width * height);
  let points = 0;
  if (scratch.length < xs.length) scratch = new Int32Array(xs.length);
  const pixels = place(xs, ys, frame, scratch, every);
  for (let i = 0; i < xs.length; i += every) {
    if (pixels[i] < 0) continue;
    corners[pixels[i]]++;
    points++;
  }
  const counts = new Uint32Array(corners.length);
  let hit = 0;
  for (let pixel = 0; pixel < corners.length; pixel++) {
    const more = corners[pixel];
    if (more === 0) continue;
    for (let row = 0; row < dot2; row++) {
      const first = pixel + row * width;
      for (let at = first; at < first + dot2; at++) {
        if (counts[at] === 0) hit++;
        counts[at] += more;
      }
    }
  }
  return { counts, every, full: Math.max(2, Math.ceil(USUAL2 * dot2 * dot2 * points / Math.max(1, hit))) };
}
function drawCloud(image, { counts, full }, colour, strength) {
  const rise = (1 - strength) / Math.log(full);
  const weights = Float32Array.from({ length: full + 1 }, (_, n) => strength + rise * Math.log(Math.max(1, n)));
  const ground = image[0];
  const alone = Uint32Array.from(weights, (weight2) => mixed(ground, colour, weight2));
  for (let at = 0; at < counts.length; at++) {
    if (counts[at] === 0) continue;
    const many = counts[at] < full ? counts[at] : full;
    image[at] = image[at] === ground ? alone[many] : mixed(image[at], colour, weights[many]);
  }
}
function drawPoints(image, pixels, chosen, frame, colour, every = 1) {
  const { dot: dot2, width } = frame;
  const count = chosen ? chosen.length : pixels.length;
  if (count < MANY2 * image.length) {
    for (let i = 0; i < count; i += every) drawDot(image, pixels[chosen ? chosen[i] : i], { dot: dot2, width }, colour);
    return;
  }
  const corners = new Uint8Array(image.length + 1);
  if (chosen) for (let i = 0; i < count; i += every) corners[pixels[chosen[i]] + 1] = 1;
  else for (let i = 0; i < count; i += every) corners[pixels[i] + 1] = 1;
  for (let at = 1; at < corners.length; at++) if (corners[at] === 1) drawDot(image, at - 1, { dot: dot2, width }, colour);
}
function drawDot(image, pixel, { dot: dot2, width }, colour) {
  if (pixel < 0) return;
  for (let row = 0, first = pixel; row < dot2; row++, first += width) {
    for (let at = first; at < first + dot2; at++) image[at] = colour;
  }
}
function drawFew(image, pixels, chosen, { dot: dot2, width, height }, colour) {
  for (const at of chosen) {
    const pixel = pixels[at];
    if (pixel < 0) continue;
    const [across, down] = [pixel % width, Math.floor(pixel / width)];
    const [left, right] = [Math.max(0, across - dot2), Math.min(width, across + 2 * dot2)];
    const bottom = Math.min(height, down + 2 * dot2);
    for (let row = Math.max(0, down - dot2); row < bottom; row++) image.fill(colour, row * width + left, row * width + right);
  }
}
function mixed(under, over, share) {
  const [some, rest] = [Math.round(256 * share), 256 - Math.round(256 * share)];
  const redBlue = Math.imul(under & 16711935, rest) + Math.imul(over & 16711935, some) >>> 8;
  const green = Math.imul(under & 65280, rest) + Math.imul(over & 65280, some) >>> 8;
  return (4278190080 | redBlue & 16711935 | green & 65280) >>> 0;
}
function pixelColour(text) {
  const value = Number.parseInt(text.slice(1), 16);
  return (4278190080 | (value & 255) << 16 | value & 65280 | value >> 16) >>> 0;
}

// src/timing.js
var times = [];
var KEPT = 500;
function timed(what, draw2, start = performance.now()) {
  requestAnimationFrame(() => {
    const began = performance.now();
    draw2();
    const script = performance.now() - began;
    requestAnimationFrame(() => {
      times.push({ what, start, script, painted: performance.now() });
      if (times.length > KEPT) times.shift();
    });
  });
}
function idle(work) {
  if ("requestIdleCallback" in globalThis) requestIdleCallback(work);
  else setTimeout(work, 50);
}

// src/plot.js
var FEW5 = 8e3;
var FEW_CHOSEN = 20;
var CLOUDS = 8;
var AT_ONCE = 5e4;
var LIT_AT_ONCE = 2e5;
var REST_MS3 = 150;
var Plot = class {
  /**
   * @param {string} name in words, for those who hear the page
   * @param {(plot: Plot, region: Region | null) => void} brushed
   */
  constructor(name2, brushed) {
    this.brushed = brushed;
    this.base = make("canvas", { class: "points" });
    this.light = make("canvas", { class: "points light" });
    this.axes = make("canvas", { class: "axes" });
    this.box = make("div", { class: "brush", hidden: true });
    this.dot = make("div", { class: "moment", hidden: true });
    this.marked = null;
    this.element = make(
      "div",
      { class: "plot", tabindex: 0, role: "img", "aria-label": name2 },
      ...[this.base, this.light, this.axes, this.box, this.dot]
    );
    this.contents = null;
    this.frame = { width: 0, height: 0, x: [0, 1], y: [0, 1], dot: 2 };
    this.placed = [];
    this.clouds = [];
    this.rest = 0;
    this.unlit = 0;
    this.pick = null;
    this.region = null;
    this.scale = 1;
  }
  /** @param {string} name of a colour in the style sheet */
  colour(name2) {
    return styleValue(name2, this.element);
  }
  /** @param {Contents} contents */
  show(contents) {
    this.drawAll(contents);
  }
  /**
   * Draw everything anew: the data, the size or the colours have changed.
   * @param {Contents | null} [contents]
   */
  drawAll(contents = this.contents) {
    const { clientWidth: width, clientHeight: height } = this.element;
    this.contents = contents;
    if (!contents || width < 100 || height < 80) return;
    const { x, xAxis, yAxis } = contents;
    this.scale = globalThis.devicePixelRatio || 1;
    const inner = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    const [columns, rows] = inner.map((length) => Math.max(8, Math.round(length * this.scale)));
    const part = { x: xAxis.part ?? false, y: yAxis.part ?? false };
    const many = x.length > FEW5 && !(part.x && fewBetween(x, xAxis));
    const dot2 = Math.max(1, Math.round((many ? 2 : 3) * this.scale));
    this.frame = { width: columns, height: rows, x: [xAxis.low, xAxis.high], y: [yAxis.low, yAxis.high], dot: dot2, part };
    this.pick = null;
    for (const canvas of [this.base, this.light]) {
      if (canvas.width !== columns || canvas.height !== rows) [canvas.width, canvas.height] = [columns, rows];
      canvas.style.width = `${inner[0]}px`;
      canvas.style.height = `${inner[1]}px`;
    }
    this.drawBase(contents);
    this.drawFrame(width, height);
    this.drawBox();
    this.mark(this.marked);
  }
  /** @param {Contents} contents @param {number} [every] of how many points one is drawn, until all of them are */
  drawBase(contents, every = Math.ceil(contents.x.length / AT_ONCE)) {
    const { x, series } = contents;
    const image = new ImageData(this.frame.width, this.frame.height);
    const pixels = new Uint32Array(image.data.buffer);
    pixels.fill(pixelColour(this.colour("--paper")));
    const clouds2 = series.map(({ y }) => this.cloud(x, y, every));
    for (const [at, { colour, strength }] of series.entries()) {
      drawCloud(pixels, clouds2[at], pixelColour(this.colour(colour)), strength);
    }
    this.base.getContext("2d")?.putImageData(image, 0, 0);
    clearTimeout(this.rest);
    const whole = () => this.contents === contents && this.drawBase(contents, 1);
    if (clouds2.some((cloud) => cloud.every > 1)) this.rest = setTimeout(() => idle(whole), REST_MS3);
  }
  /**
   * How many dots each pixel has, of all points where that is known.
   * @param {Float32Array} x
   * @param {Float32Array} y
   * @param {number} every
   */
  cloud(x, y, every) {
    const frame = JSON.stringify(this.frame);
    const at = this.clouds.findIndex((one) => one.x === x && one.y === y && one.frame === frame);
    if (at < 0 && every > 1) return cloudOf(x, y, this.frame, every);
    const [known2] = at < 0 ? [{ x, y, frame, cloud: cloudOf(x, y, this.frame) }] : this.clouds.splice(at, 1);
    this.clouds = [...this.clouds.slice(1 - CLOUDS), known2];
    return known2.cloud;
  }
  /** The pixel of each point of a series, by its number; none where it is not there. @param {number} at */
  pixels(at) {
    const { x, series } = this.contents ?? { x: null, series: [] };
    const y = series[at]?.y;
    if (!x || !y || this.frame.width === 0) return new Int32Array(0);
    const frame = JSON.stringify(this.frame);
    const known2 = this.placed[at];
    if (known2?.x === x && known2.y === y && known2.frame === frame) return known2.pixels;
    const pixels = place(x, y, this.frame);
    this.placed[at] = { x, y, frame, pixels };
    return pixels;
  }
  /** @param {number} width @param {number} height */
  drawFrame(width, height) {
    this.axes.width = Math.round(width * this.scale);
    this.axes.height = Math.round(height * this.scale);
    const brush = this.axes.getContext("2d");
    if (!brush || !this.contents) return;
    const { title, xAxis, yAxis, noise, bins, spectrum } = this.contents;
    const names = ["--ink", "--soft", "--grid", "--band", "--wrong"];
    const [ink, soft, line2, band2, wrong] = names.map((name2) => this.colour(name2));
    const colours = { ink, soft, line: line2, band: band2, wrong };
    brush.scale(this.scale, this.scale);
    drawAxes(brush, { width, height }, { x: xAxis, y: yAxis, title, colours, noise, bins, spectrum });
  }
  /**
   * Draw the second layer.
   * @param {Uint32Array | null} chosen indices of samples
   * @param {{y: Float32Array, colour: string} | null} above a cloud over the others: what an effect would explain
   * @param {number} [every] of how many chosen points one is drawn, until all of them are
   */
  drawLight(chosen, above, every = Math.max(1, Math.ceil((chosen?.length ?? 0) / LIT_AT_ONCE))) {
    clearTimeout(this.unlit);
    if (!this.contents || this.frame.width === 0) return;
    if (every > 1) this.unlit = setTimeout(() => this.drawLight(chosen, above, 1), REST_MS3);
    this.element.classList.toggle("dimmed", chosen !== null);
    const image = new ImageData(this.frame.width, this.frame.height);
    const pixels = new Uint32Array(image.data.buffer);
    if (chosen) {
      for (const [at, { chosen: name2 }] of this.contents.series.entries()) {
        if (!name2) continue;
        const colour = pixelColour(this.colour(name2));
        if (chosen.length <= FEW_CHOSEN) drawFew(pixels, this.pixels(at), chosen, this.frame, colour);
        else drawPoints(pixels, this.pixels(at), chosen, this.frame, colour, every);
      }
    }
    if (above) {
      const spots = place(this.contents.x, above.y, this.frame);
      drawPoints(pixels, spots, null, this.frame, pixelColour(this.colour(above.colour)));
    }
    this.light.getContext("2d")?.putImageData(image, 0, 0);
  }
  /** Sort the points for the brush, once per change of the data: when it is put on, before it moves. */
  sorted() {
    const picked = this.pixels(this.contents?.picked ?? 0);
    this.pick ??= new Pick(picked, this.frame.width, this.frame.height);
    return this.pick;
  }
  /**
   * The samples in the brushed region; valid until the next call.
   * @returns {Uint32Array | null}
   */
  chosen() {
    if (!this.region || !this.contents || this.frame.width === 0) return null;
    const { left, top, width, height } = this.boxInside(this.region);
    const [wide, high] = [this.frame.width, this.frame.height];
    const half = this.frame.dot / 2;
    return this.sorted().inside({
      left: Math.max(0, Math.ceil(left * wide - half)),
      right: Math.min(wide - 1, Math.floor((left + width) * wide - half)),
      top: Math.max(0, Math.ceil(top * high - half)),
      bottom: Math.min(high - 1, Math.floor((top + height) * high - half))
    });
  }
  /**
   * Where a region lies, in shares of the drawn area from the upper left.
   * @param {Region} region
   */
  boxInside(region) {
    const { x, y } = this.frame;
    const [left, right] = region.x.map((value) => (value - x[0]) / (x[1] - x[0]));
    const [bottom, top] = region.y.map((value) => (y[1] - value) / (y[1] - y[0]));
    return { left, top, width: right - left, height: bottom - top };
  }
  /** Mark where a sample is; nowhere, if it is not drawn. @param {number | null} at */
  mark(at) {
    this.marked = at;
    const pixel = at === null ? -1 : this.pixels(this.contents?.picked ?? 0)[at] ?? -1;
    this.dot.hidden = pixel < 0;
    if (pixel < 0) return;
    const { width, dot: dot2 } = this.frame;
    const row = pixel / width | 0;
    const [x, y] = [pixel - row * width, row].map((one) => (one + dot2 / 2) / this.scale);
    this.dot.style.transform = `translate(${MARGIN.left + x}px, ${MARGIN.top + y}px)`;
  }
  /** @param {Region | null} region */
  setRegion(region) {
    this.region = region;
    this.drawBox();
  }
  /** Put the rectangle where the region is. */
  drawBox() {
    this.box.hidden = this.region === null;
    if (!this.region) return;
    const wide = this.element.clientWidth - MARGIN.left - MARGIN.right;
    const high = this.element.clientHeight - MARGIN.top - MARGIN.bottom;
    const box = this.boxInside(this.region);
    const [left, right] = [box.left, box.left + box.width].map((share) => Math.min(1, Math.max(0, share)));
    const [top, bottom] = [box.top, box.top + box.height].map((share) => Math.min(1, Math.max(0, share)));
    this.box.style.transform = `translate(${MARGIN.left + left * wide}px, ${MARGIN.top + top * high}px)`;
    this.box.style.width = `${(right - left) * wide}px`;
    this.box.style.height = `${(bottom - top) * high}px`;
  }
};
function fewBetween(x, { low, high }) {
  let count = 0;
  for (let i = 0; i < x.length && count <= FEW5; i++) if (x[i] >= low && x[i] <= high) count++;
  return count <= FEW5;
}

// src/settling.js
var LASTS_MS = 700;
var MOST2 = 6e4;
function movesFrom(before, now) {
  const from = before?.columns.residual;
  const same = before?.columns.t === now.columns.t && from !== now.columns.residual && before?.fitted && now.fitted;
  const still = globalThis.matchMedia?.("(prefers-reduced-motion: reduce)").matches ?? true;
  return from && same && !still && from.length <= MOST2 ? from : null;
}
function between2(from, to, share) {
  return to.map((value, i) => from[i] === from[i] ? from[i] + share * (value - from[i]) : value);
}
function settle(from, to, show) {
  let start = NaN;
  const frame = (now) => {
    if (Number.isNaN(start)) start = now;
    const left = 1 - Math.min(1, (now - start) / LASTS_MS);
    const wanted2 = show(left > 0 ? between2(from, to, 1 - left ** 3) : to);
    if (wanted2 && left > 0) requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

// src/squares.js
var squaresOf = remembered((residual) => {
  let sum = 0;
  for (let i = 0; i < residual.length; i++) if (residual[i] === residual[i]) sum += residual[i] * residual[i];
  return sum;
});
function chosenSquares(residual, chosen) {
  let [sum, count] = [0, 0];
  for (let at = 0; at < chosen.length; at++) {
    const value = residual[chosen[at]];
    if (value !== value) continue;
    sum += value * value;
    count++;
  }
  return { sum, count };
}

// src/zoom.js
var CLOSEST = 1e-4;
var WHEEL = 15e-4;
var LINE = 16;
var KEY = 1.5;
function toScroll(plot) {
  const column = plot.parentElement?.parentElement;
  return column != null && column.scrollHeight > column.clientHeight + 1 && document.activeElement !== plot;
}
function zoomable(plot, deeds) {
  const { element: element2 } = plot;
  element2.addEventListener(
    "wheel",
    (event) => {
      if (!plot.contents || event.ctrlKey || toScroll(element2)) return;
      event.preventDefault();
      const edge = element2.getBoundingClientRect();
      const wide = edge.width - MARGIN.left - MARGIN.right;
      const at = Math.min(1, Math.max(0, (event.clientX - edge.left - MARGIN.left) / wide));
      const unit = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE;
      const across = event.shiftKey ? event.deltaX || event.deltaY : event.deltaX;
      if (Math.abs(across) > Math.abs(event.deltaY) || event.shiftKey) deeds.pan(plot, unit * across / wide);
      else deeds.zoom(plot, at, Math.exp(WHEEL * unit * event.deltaY));
    },
    { passive: false }
  );
  element2.addEventListener("dblclick", () => deeds.whole(plot));
  element2.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "+" || event.key === "=") deeds.zoom(plot, 0.5, 1 / KEY);
    else if (event.key === "-") deeds.zoom(plot, 0.5, KEY);
    else if (event.key === "0") deeds.whole(plot);
    else return;
    event.preventDefault();
  });
}
function zoomed([low, high], whole, at, factor2) {
  const all = whole[1] - whole[0];
  const span4 = Math.max(CLOSEST * all, factor2 * (high - low));
  if (!(span4 < all)) return null;
  const fixed2 = low + at * (high - low);
  return within2([fixed2 - at * span4, fixed2 + (1 - at) * span4], whole);
}
function panned([low, high], whole, share) {
  const step = share * (high - low);
  return within2([low + step, high + step], whole);
}
function within2([low, high], [lowest, highest]) {
  const back = Math.max(0, lowest - low) - Math.max(0, high - highest);
  return [low + back, high + back];
}

// src/linked.js
var Linked = class {
  /**
   * @param {(words: string | null) => void} told about the chosen samples; null when none are
   * @param {(axes: Along[]) => void} picked what the rows shall be drawn over; they are once they are shown
   * @param {{fetched?: boolean, pointed?: (data: Data | null, at: number | null) => void}} [more] `fetched`: there is a
   * column for every axis, as soon as it is asked for; `pointed`: told which sample is pointed at
   */
  constructor(told, picked, { fetched = false, pointed = () => {
  } } = {}) {
    this.told = told;
    this.fetched = fetched;
    const brushed = (plot, region) => this.brush(plot, region);
    const column = () => USUAL.map(() => new Plot("", brushed));
    this.torques = column();
    this.residuals = column();
    this.besides = column();
    this.rows = USUAL.map((_, at) => [this.torques[at], this.residuals[at], this.besides[at]]);
    this.plots = this.rows.flat();
    this.pickers = USUAL.map((_, at) => picker(at, (along) => picked(this.axes.with(at, along))));
    this.element = make("div", { class: "linked" }, ...this.plots.map(({ element: element2 }) => element2), ...this.pickers);
    for (const [at, { element: element2 }] of this.plots.entries()) {
      element2.classList.toggle("beside", at % 3 === 2);
      put(element2, Math.floor(at / 3) + 1, at % 3 + 1);
    }
    const deeds = {
      zoom: (plot, at, factor2) => this.look(plot, (seen2, whole) => zoomed(seen2, whole, at, factor2)),
      pan: (plot, share) => this.look(plot, (seen2, whole) => panned(seen2, whole, share)),
      whole: (plot) => this.look(plot, () => null)
    };
    for (const plot of this.plots) {
      brushable(plot);
      zoomable(plot, deeds);
    }
    this.moment = pointing(this.plots, () => this.data?.columns.t ?? null, (at) => pointed(this.data, at));
    this.data = null;
    this.shown = [];
    this.axes = USUAL;
    this.seen = USUAL.map(() => null);
    this.heights = /* @__PURE__ */ new Map();
    this.chosen = null;
    this.signature = null;
    this.waiting = /* @__PURE__ */ new Set();
    this.widest = 0;
    this.squares = 0;
    this.sized = new ResizeObserver(() => this.redraw());
    this.sized.observe(this.element);
  }
  /**
   * Show data; the same samples stay chosen where there are as many as before.
   * @param {Data} data
   * @param {View} view
   */
  show(data, view) {
    const { columns } = data;
    if (this.data && (this.data.columns.t.length !== columns.t.length || this.data.of !== data.of)) {
      this.clear();
      this.moment.none();
      this.seen.fill(null);
      this.heights.clear();
      this.widest = 0;
    }
    this.drawOver(view.axes, data);
    const from = movesFrom(this.data, data);
    this.data = data;
    this.signature = null;
    this.squares = squaresOf(columns.residual);
    const reach2 = reachOf(data);
    if (data.fitted) this.widest = Math.max(this.widest, reach2);
    this.element.classList.toggle("both", Boolean(data.beside));
    if (!data.beside) for (const plot of this.besides) plot.setRegion(null);
    this.shown = rowsOf(data, view, view.held ? Math.max(this.widest, reach2) : reach2);
    if (from) this.put(from);
    for (const at of this.rows.keys()) this.drawRow(at);
    this.tell();
    this.drawLight();
    this.prepare(data);
    if (from) settle(from, columns.residual, (residual) => this.shows(data) && this.moved(residual));
  }
  /** Whether these samples are still shown; their bins may have come in meanwhile. @param {Data} data */
  shows = ({ columns }) => this.data?.columns === columns;
  /** Work out, while nothing else is to be done, where each point of what a brush lights up is. @param {Data} data */
  prepare(data) {
    const left = this.plots.flatMap((plot) => (plot.contents?.series ?? []).map(({ chosen }, at) => chosen ? { plot, at } : null));
    const go = () => {
      const one = left.shift();
      if (one === void 0 || !this.shows(data)) return;
      if (one && !one.plot.element.hidden) one.plot.pixels(one.at);
      idle(go);
    };
    idle(go);
  }
  /** Let the residuals be these, though others come. @param {Float32Array} residual */
  put(residual) {
    for (const row of this.shown) if (row.torque) row.residual = { ...row.residual, series: [{ ...row.residual.series[0], y: residual }] };
  }
  /** Draw residuals that are on their way. @param {Float32Array} residual */
  moved(residual) {
    this.put(residual);
    for (const at of this.rows.keys()) this.drawRow(at);
    this.drawLight();
    return true;
  }
  /**
   * Let the rows be drawn over these axes: of another one everything is seen, and no rectangle is on it.
   * @param {Along[]} axes
   * @param {Data} data
   */
  drawOver(axes, data) {
    const kinds = ["torque over %, measured and modelled", "residual over %", "residual over % of the branch beside"];
    const all = (
      /** @type {Along[]} */
      Object.keys(AXES)
    );
    const there = (one) => one !== "frequency" && (AXES[one].column ?? "tau") in data.columns;
    const offered = all.filter((one) => this.fetched || there(one));
    for (const [at, along] of axes.entries()) {
      showPicked(this.pickers[at], offered, { along, data });
      for (const element2 of [this.residuals[at].element, this.pickers[at]]) element2.classList.toggle("wide", along === "frequency");
      for (const kind of [0, 2]) this.rows[at][kind].element.toggleAttribute("hidden", along === "frequency");
      for (const [kind, plot] of this.rows[at].entries()) {
        plot.element.setAttribute("aria-label", kinds[kind].replace("%", axisWord(along, data.unit)));
        if (along === this.axes[at]) continue;
        plot.setRegion(null);
        this.heights.delete(plot);
      }
      if (along !== this.axes[at]) this.seen[at] = null;
    }
    this.axes = axes;
  }
  /**
   * Choose what lies where a verdict says that the model fails, and mark it on the residuals over that axis.
   * @param {import("./types.js").Stretch} place
   */
  mark(place4) {
    const at = this.axes.indexOf(place4.axis);
    if (!this.data || at < 0) return;
    this.choose(samplesIn(this.data, place4));
    const { xAxis, yAxis } = this.shown[at].residual;
    const x = [place4.low, place4.high].map((value) => xAxis.log ? Math.max(xAxis.low, Math.log10(value)) : value);
    this.residuals[at].setRegion({ x: [x[0], x[1]], y: [yAxis.low, yAxis.high] });
  }
  /** Choose samples, and see their time from near. @param {Uint32Array} chosen */
  find(chosen) {
    this.choose(chosen);
    const at = this.axes.indexOf("time");
    if (!this.data || at < 0 || chosen.length === 0) return;
    const { t } = this.data.columns;
    const { low, high } = this.shown[at].residual.xAxis;
    const [first, last] = [t[chosen[0]], t[chosen[chosen.length - 1]]];
    const half = Math.max(0.7 * (last - first), 0.01 * (high - low));
    const middle = Math.min(high - half, Math.max(low + half, 0.5 * (first + last)));
    this.seen[at] = 2 * half < 0.5 * (high - low) ? [middle - half, middle + half] : null;
    this.later("zoom", () => {
      this.drawRow(at);
      this.drawLight();
    });
  }
  /** @param {number} at which row */
  drawRow(at) {
    const row = this.shown[at];
    const along = this.data?.splits?.find(({ axis: axis2 }) => axis2 === this.axes[at]) ?? null;
    const own = this.axes[at] === "time" && this.data?.several;
    const bins = row.residual.spectrum === void 0 && !own ? along : null;
    for (const [column, contents] of [row.torque, { ...row.residual, bins }, row.beside].entries()) {
      const plot = this.rows[at][column];
      const [xAxis, yAxis] = [within3(contents?.xAxis, this.seen[at]), within3(contents?.yAxis, this.heights.get(plot))];
      if (contents && xAxis && yAxis) plot.show({ ...contents, xAxis, yAxis });
    }
  }
  /**
   * Draw where the error lies, in bins beside what chance gives them, over the residuals.
   * @param {import("./types.js").Split[]} splits
   */
  lay(splits) {
    if (!this.data) return;
    this.data = { ...this.data, splits };
    for (const row of this.shown) if (!row.torque) row.residual = alongFrequency(this.data);
    for (const at of this.rows.keys()) this.drawRow(at);
    this.drawLight();
  }
  /** Draw everything anew, for another size or other colours. */
  redraw() {
    for (const plot of this.plots) plot.drawAll();
    this.drawLight();
  }
  /**
   * Look at another part of the x axis that a plot shares with its row.
   * @param {Plot} plot
   * @param {(seen: Range, whole: Range) => Range | null} change
   */
  look(plot, change) {
    const at = this.rows.findIndex((row) => row.includes(plot));
    if (!this.shown[at]) return;
    const { low, high } = this.shown[at].residual.xAxis;
    this.seen[at] = change(this.seen[at] ?? [low, high], [low, high]);
    if (!this.seen[at]) for (const other of this.rows[at]) this.heights.delete(other);
    this.later("zoom", () => {
      this.drawRow(at);
      this.drawLight();
    });
  }
  /** Look at the brushed region as near as it fits; at everything, where none is brushed. */
  lookCloser() {
    const plot = this.plots.find(({ region }) => region);
    const at = this.rows.findIndex((row) => plot && row.includes(plot));
    if (plot?.region) {
      this.seen[at] = plot.region.x;
      this.heights.set(plot, plot.region.y);
      for (const one of this.plots) one.setRegion(null);
    } else {
      this.seen.fill(null);
      this.heights.clear();
    }
    this.later("zoom", () => {
      if (this.data) for (const row of this.rows.keys()) this.drawRow(row);
      this.drawLight();
    });
  }
  /**
   * Choose what lies in a region of one plot; the next frame shows it.
   * @param {Plot} plot
   * @param {Region | null} region
   */
  brush(plot, region) {
    for (const other of this.plots) other.setRegion(other === plot ? region : null);
    this.later("brush", () => {
      const brushed = this.plots.find((one) => one.region);
      this.chosen = brushed?.chosen() ?? null;
      this.drawLight();
      this.tell();
    });
  }
  /** The rectangle that is brushed, by the number of its plot. @returns {import("./types.js").Brush | null} */
  get brushed() {
    const plot = this.plots.findIndex(({ region: region2 }) => region2);
    const region = this.plots[plot]?.region;
    return region ? { plot, ...region } : null;
  }
  /** @param {import("./types.js").Brush} brush */
  brushAgain({ plot, x, y }) {
    if (this.plots[plot]) this.brush(this.plots[plot], { x, y });
  }
  /**
   * Draw in the next frame; what comes meanwhile is drawn with it.
   * @param {string} what
   * @param {() => void} draw
   */
  later(what, draw2) {
    if (this.waiting.has(what)) return;
    this.waiting.add(what);
    timed(what, () => {
      this.waiting.delete(what);
      draw2();
    });
  }
  /** Choose nothing. */
  clear() {
    this.choose(null);
  }
  /**
   * Choose samples that no rectangle on this page has chosen.
   * @param {Uint32Array | null} chosen indices
   */
  choose(chosen) {
    for (const plot of this.plots) plot.setRegion(null);
    this.chosen = chosen;
    this.drawLight();
    this.tell();
  }
  /**
   * Lay what an effect would explain over the residuals.
   * @param {Float32Array | null} signature
   */
  overlay(signature) {
    this.signature = signature;
    this.drawLight();
  }
  drawLight() {
    const besides = this.data?.beside ? this.besides : [];
    for (const plot of [...this.torques, ...besides]) plot.drawLight(this.chosen, null);
    const above = this.signature && { y: this.signature, colour: "--signature" };
    for (const plot of this.residuals) plot.drawLight(this.chosen, above);
  }
  /** The part of the squared error that the chosen samples have, and their RMS; null where none are chosen. */
  get share() {
    if (!this.chosen || !this.data) return null;
    const { residual } = this.data.columns;
    const { sum, count } = chosenSquares(residual, this.chosen);
    return { ofError: this.squares > 0 ? sum / this.squares : 0, rms: Math.sqrt(sum / Math.max(1, count)), counted: count };
  }
  tell() {
    const { chosen, data, share } = this;
    if (!chosen || !data || !share) return this.told(null);
    const part = percent(chosen.length / data.columns.t.length);
    const scale = torqueScale(data);
    const rms = (value) => `RMS ${number(value * scale.factor)} ${scale.unit}`;
    const count = `${thousands(chosen.length)} ${chosen.length === 1 ? "sample" : "samples"} chosen, ${part} of all`;
    if (share.counted === 0 && chosen.length > 0) return this.told(`${count}: nothing is fitted to them`);
    const own = chosen.length > 0 ? ` (${rms(share.rms)})` : "";
    let words4 = `${count}: they have ${percent(share.ofError)} of the squared error${own}`;
    if (data.beside && chosen.length > 0) {
      const { sum, count: counted2 } = chosenSquares(data.beside.residual, chosen);
      words4 += `; in ${data.beside.name}: ${rms(Math.sqrt(sum / Math.max(1, counted2)))}`;
    }
    return this.told(words4);
  }
};
function picker(at, picked) {
  const choice = make("select", {
    ...{ class: "along", "aria-label": `axis of row ${at + 1}`, title: "what this row is drawn over" },
    on: { change: () => picked(
      /** @type {Along} */
      choice.value
    ) }
  });
  put(choice, at + 1, 1);
  return choice;
}
function put(element2, row, column) {
  element2.style.setProperty("--row", String(row));
  element2.style.setProperty("--column", String(column));
}
function showPicked(choice, offered, { along, data }) {
  const texts = offered.map((one) => labelOf(one, data));
  if ([...choice.options].map(({ text }) => text).join() !== texts.join()) {
    choice.replaceChildren(...offered.map((value, at) => make("option", { value, text: texts[at] })));
  }
  choice.value = along;
}
function within3(axis2, seen2) {
  return axis2 && seen2 ? { ...axis2, low: seen2[0], high: seen2[1], part: true } : axis2;
}

// src/store.js
var MOTION = /* @__PURE__ */ new Set(["t", "theta", "omega", "alpha", "tau", "history", "masked"]);
var NODES_KEPT = 32;
function decode(buffer) {
  return unpacked(buffer).columns;
}
function unpacked(buffer) {
  const end = new Uint8Array(buffer).indexOf(10);
  const head2 = JSON.parse(new TextDecoder().decode(buffer.slice(0, end)));
  const start = Math.ceil((end + 1) / 4) * 4;
  const columns = head2.names.map((name2, at) => [
    name2,
    new Float32Array(buffer, start + 4 * at * head2.n, head2.n)
  ]);
  return { head: head2, columns: Object.fromEntries(columns) };
}
var Store = class {
  constructor() {
    this.kept = /* @__PURE__ */ new Map();
    this.coming = /* @__PURE__ */ new Map();
    this.splits = /* @__PURE__ */ new Map();
  }
  /**
   * Return where the error of a node lies along every axis.
   * @param {string} node
   * @returns {Promise<import("./types.js").Split[]>}
   */
  async splitsOf(node) {
    const known2 = this.splits.get(node);
    if (known2) return known2;
    const { splits } = await ask("splits", { node });
    this.splits.set(node, splits);
    for (const old of [...this.splits.keys()].slice(0, -NODES_KEPT)) this.splits.delete(old);
    return splits;
  }
  /**
   * Return columns over all captures, one after the other.
   * @param {string} node
   * @param {string[]} captures
   * @param {string[]} names
   * @returns {Promise<Columns>}
   */
  async columns(node, captures, names) {
    const parts = await Promise.all(captures.map((capture) => this.ofCapture(node, capture, names)));
    return joined(parts, names);
  }
  /**
   * What an effect or a law would explain of the residual; kept, for a pointer comes back.
   * @param {string} node
   * @param {string[]} captures
   * @param {string} what it is called
   * @param {{verb: string, asked: Record<string, string>}} how it is asked for
   * @param {AbortSignal} [signal]
   * @returns {Promise<Float32Array>}
   */
  async explained(node, captures, what, { verb, asked: asked2 }, signal) {
    const name2 = `signature of ${what}`;
    const parts = await Promise.all(
      captures.map(async (capture) => {
        const key2 = `${capture} ${node}`;
        const known2 = this.kept.get(key2)?.[name2];
        if (known2) return { [name2]: known2 };
        const fetched = decode(await fetchBytes(`/api/${verb}`, { node, capture, ...asked2 }, signal));
        const column = Object.values(fetched)[0];
        this.keep(key2, { [name2]: column });
        return { [name2]: column };
      })
    );
    return joined(parts, [name2])[name2];
  }
  /** Forget what something would explain: it is another by now. @param {string} what */
  forget(what) {
    for (const columns of this.kept.values()) delete columns[`signature of ${what}`];
  }
  /** @param {string} node @param {string} capture @param {string[]} names */
  async ofCapture(node, capture, names) {
    const key2 = `${capture} ${node}`;
    const have = () => ({ ...this.kept.get(capture), ...this.kept.get(key2) });
    while (this.coming.has(key2)) await this.coming.get(key2)?.catch(() => {
    });
    const lacking = names.filter((name2) => !(name2 in have()));
    if (lacking.length > 0) {
      const coming = this.fetch(node, capture, lacking).finally(() => this.coming.delete(key2));
      this.coming.set(key2, coming);
      await coming;
    }
    return have();
  }
  /** @param {string} node @param {string} capture @param {string[]} names */
  async fetch(node, capture, names) {
    const there = decode(await (early(node, capture) ?? fetchBytes("/api/arrays", { node, capture, names: names.join(",") })));
    const lacking = names.filter((name2) => !(name2 in there));
    const entries = Object.entries(there);
    if (lacking.length > 0) entries.push(...Object.entries(decode(await fetchBytes("/api/arrays", { node, capture, names: lacking.join(",") }))));
    this.keep(capture, Object.fromEntries(entries.filter(([name2]) => MOTION.has(name2))));
    this.keep(`${capture} ${node}`, Object.fromEntries(entries.filter(([name2]) => !MOTION.has(name2))));
  }
  /** @param {string} key @param {Columns} columns */
  keep(key2, columns) {
    const together = { ...this.kept.get(key2), ...columns };
    this.kept.delete(key2);
    this.kept.set(key2, together);
    const nodes2 = [...this.kept.keys()].filter((one) => one.includes(" "));
    for (const old of nodes2.slice(0, Math.max(0, nodes2.length - NODES_KEPT))) this.kept.delete(old);
  }
};
function joined(parts, names) {
  if (parts.length === 1) return Object.fromEntries(names.map((name2) => [name2, parts[0][name2]]));
  const whole = {};
  for (const name2 of names) {
    whole[name2] = new Float32Array(parts.reduce((total, part) => total + part[name2].length, 0));
    let [at, elapsed] = [0, 0];
    for (const part of parts) {
      const column = part[name2];
      if (name2 === "t") {
        const start = column[0] ?? 0;
        for (let i = 0; i < column.length; i++) whole[name2][at + i] = column[i] - start + elapsed;
        elapsed += (column.at(-1) ?? start) - start;
      } else {
        whole[name2].set(column, at);
      }
      at += column.length;
    }
  }
  return whole;
}

// src/live.js
var PAUSE_MS = 120;
var PATIENCE = 8;
var PLOTS = (
  /** @type {const} */
  [
    { y: "tau", x: "t", name: "torque over time" },
    { y: "tau", x: "theta", name: "torque over position" },
    { y: "theta", x: "t", name: "angle over time" },
    { y: "omega", x: "t", name: "velocity over time" }
  ]
);
var WORDS = { tau: "torque", theta: "angle, rad", omega: "velocity, rad/s", t: "time, s" };
var Live = class {
  /**
   * @param {{done: () => void, failed: (reason: unknown) => void, say: (words: string) => void,
   *   open: (path: string) => void}} heard
   */
  constructor(heard) {
    this.heard = heard;
    this.plots = PLOTS.map(({ name: name2 }) => new Plot(`${name2}, as it is recorded`, () => {
    }));
    byId("live-plots").append(...this.plots.map(({ element: element2 }) => element2));
    this.columns = {};
    this.told = null;
    this.waiting = false;
    this.following = false;
    this.unwanted = false;
    byId("live-stop").addEventListener("click", () => this.stop(true));
    byId("live-cancel").addEventListener("click", () => this.stop(false));
    byId("live-close").addEventListener("click", () => this.close());
    byId("live-open").addEventListener("click", () => {
      this.close();
      if (this.told) heard.open(this.told.log);
    });
    new ResizeObserver(() => this.draw()).observe(byId("live-plots"));
  }
  /** Show the recording until it has ended. */
  async follow() {
    if (this.following) return byId("live-stop").focus();
    this.following = true;
    this.unwanted = false;
    this.forget();
    this.phase("");
    this.offer(["live-stop", "live-cancel"]);
    byId("live-said").textContent = "";
    byId("live").hidden = false;
    byId("live-stop").focus();
    let silent = 0;
    try {
      do {
        try {
          await this.look();
          silent = 0;
        } catch (reason2) {
          if (reason2 instanceof Refusal || ++silent > PATIENCE) throw reason2;
        }
      } while (!this.told?.ended && await pause());
      this.ended();
    } catch (reason2) {
      byId("live-said").textContent = wordsOf(reason2);
      this.offer(["live-close"]);
    } finally {
      this.following = false;
    }
  }
  /** The newest angle of what is recorded, rad; null where nothing is. */
  get angle() {
    return this.following ? this.columns.theta?.at(-1) ?? null : null;
  }
  /** Nothing is known yet of what is recorded now. */
  forget() {
    this.columns = {};
    this.told = null;
  }
  /** Fetch what came since the last time, and show it in the next frame. */
  async look() {
    const since2 = String(this.columns.t?.length ?? 0);
    const { head: head2, columns } = unpacked(await fetchBytes("/api/live", { since: since2 }));
    this.told = head2.live ?? null;
    for (const [name2, more] of Object.entries(columns)) this.columns[name2] = appended(this.columns[name2], more);
    if (this.waiting) return;
    this.waiting = true;
    timed("live", () => {
      this.waiting = false;
      this.tell();
      this.draw();
    });
  }
  /** @param {boolean} keep */
  async stop(keep) {
    this.unwanted = !keep;
    this.offer([]);
    this.phase(keep ? "stopping" : "disarming");
    try {
      await post("stop", { keep });
    } catch (reason2) {
      this.heard.failed(reason2);
    }
  }
  /** Say what is being done. @param {string} what */
  phase(what) {
    byId("live-what").textContent = what;
  }
  ended() {
    const { error, log, capture } = this.told ?? {};
    if (capture !== null || this.unwanted) {
      this.close();
      this.heard.say(error ?? `recorded ${log}`);
      this.heard.done();
      return;
    }
    this.phase("the recording has ended");
    byId("live-said").textContent = error ?? "";
    this.offer(this.told?.received ? ["live-open", "live-close"] : ["live-close"]);
    byId("live-close").focus();
  }
  close() {
    byId("live").hidden = true;
  }
  /** Show these buttons and no others. @param {string[]} ids */
  offer(ids) {
    for (const id of ["live-stop", "live-cancel", "live-open", "live-close"]) byId(id).hidden = !ids.includes(id);
  }
  /** The figures in words. */
  tell() {
    if (!this.told) return;
    const { what, log, every, done, elapsed_s, total_s, received = 0, missing = 0, rate_hz } = this.told;
    if (byId("live-what").textContent === "") this.phase(what);
    const bar2 = (
      /** @type {HTMLProgressElement} */
      byId("live-done")
    );
    if (done === null) bar2.removeAttribute("value");
    else bar2.value = done;
    byId("live-time").textContent = `${seconds(elapsed_s)} of ${seconds(total_s)}`;
    const { peak_torque: peak, torque_limit: limit = 0, temperature, clipped = {} } = this.told;
    const scale = torqueScale({ unit: "N m", peak: peak ?? 0 });
    const figures = [
      `${thousands(received)} samples`,
      `${thousands(missing)} lost`,
      `${thousands(Math.round(rate_hz ?? 0))} Hz`
    ];
    if (peak) figures.push(`peak ${number(peak * scale.factor)} ${scale.unit}, allowed ${number(limit * scale.factor)}`);
    for (const [name2, count] of Object.entries(clipped)) if (count) figures.push(`${name2} saturated ${count} times`);
    if (typeof temperature === "number") figures.push(`${Math.round(temperature)} °C`);
    byId("live-figures").textContent = figures.join(" · ");
    byId("live-figures").classList.toggle("wrong", missing > 0);
    const drawn = every > 1 ? `Drawn here: one of every ${every} samples. ` : "";
    byId("live-note").textContent = `${drawn}The wire log has everything: ${log}`;
  }
  draw() {
    const { t } = this.columns;
    if (!t || t.length === 0 || byId("live").hidden) return;
    for (const [at, { x, y, name: name2 }] of PLOTS.entries()) {
      const [low, high] = limits([this.columns[y]]);
      const across = x === "t" ? [0, span2(t[t.length - 1], this.told?.total_s)] : limits([this.columns[x]]);
      const scale = y === "tau" ? torqueScale({ unit: "N m", peak: Math.max(-low, high) }) : null;
      this.plots[at].show({
        title: name2,
        x: this.columns[x],
        xAxis: { low: across[0], high: across[1], factor: 1, label: WORDS[x] },
        yAxis: { low, high, factor: scale?.factor ?? 1, label: scale ? `${WORDS[y]}, ${scale.unit}` : WORDS[y] },
        series: [{ colour: "--measured", chosen: null, y: this.columns[y], strength: 0.6 }],
        picked: 0,
        noise: null
      });
    }
  }
};
function appended(before, more) {
  if (!before) return more;
  if (more.length === 0) return before;
  const whole = new Float32Array(before.length + more.length);
  whole.set(before);
  whole.set(more, before.length);
  return whole;
}
function span2(elapsed, total = Infinity) {
  return Math.min(total, Math.max(2, 2 ** Math.ceil(Math.log2(elapsed))));
}
function seconds(value) {
  return value === void 0 ? "–" : `${value.toFixed(1)} s`;
}
function pause() {
  return new Promise((resolve) => setTimeout(() => resolve(true), PAUSE_MS));
}

// src/moment.js
var SIZE3 = 62;
var TURNED = 2.2;
function showMoment(data, at) {
  byId("moment").classList.toggle("empty", at === null);
  const canvas = (
    /** @type {HTMLCanvasElement} */
    byId("moment-knob")
  );
  const scale = globalThis.devicePixelRatio || 1;
  canvas.width = canvas.height = Math.round(SIZE3 * scale);
  const brush = canvas.getContext("2d");
  if (!data || at === null || !brush) {
    byId("moment-words").textContent = "Point at a sample: what is measured and modelled then.";
    return;
  }
  const { t, theta, omega, tau, residual } = data.columns;
  const linear = data.coordinate === "linear";
  const { theta: way, omega: rate } = motionWords(data);
  const counts = residual[at] === residual[at];
  const modelled = tau[at] - residual[at];
  let largest3 = 0;
  for (let i = 0; i < tau.length; i++) if (Math.abs(tau[i]) > largest3) largest3 = Math.abs(tau[i]);
  const { factor: factor2, unit } = torqueScale(data);
  const shown2 = (value) => number(value * factor2);
  byId("moment-words").textContent = `${number(t[at], 4)} s, ${number(theta[at])} ${way.unit}, ${number(omega[at])} ${rate.unit}; ${torqueWord(data.unit)} ` + (counts ? `${shown2(tau[at])} measured, ${shown2(modelled)} modelled, ${shown2(residual[at])} ${unit} left` : `masked: it does not count`);
  brush.scale(scale, scale);
  brush.lineWidth = 2.5;
  const colours = ["--measured", "--modelled"].map((name2) => styleValue(name2, canvas));
  const [ink, paper] = ["--ink", "--shade"].map((name2) => styleValue(name2, canvas));
  const torques = [tau[at], modelled].map((value) => counts ? value / (largest3 || 1) : 0);
  if (linear) slide(brush, place2(theta, at), torques, { ink, paper, colours });
  else knob(brush, theta[at], torques, { ink, paper, colours });
}
function place2(values, at) {
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < values.length; i++) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  return high > low ? (values[at] - low) / (high - low) : 0.5;
}
function knob(brush, theta, torques, { ink, paper, colours }) {
  const middle = SIZE3 / 2;
  brush.fillStyle = paper;
  brush.strokeStyle = ink;
  brush.beginPath();
  brush.arc(middle, middle, 15, 0, 2 * Math.PI);
  brush.fill();
  brush.stroke();
  brush.beginPath();
  brush.moveTo(middle, middle);
  brush.lineTo(middle + 15 * Math.cos(theta), middle - 15 * Math.sin(theta));
  brush.stroke();
  for (const [n, torque] of torques.entries()) {
    const [radius, from, to] = [21 + 6 * n, Math.PI / 2, Math.PI / 2 + TURNED * torque];
    brush.strokeStyle = brush.fillStyle = colours[n];
    brush.beginPath();
    brush.arc(middle, middle, radius, -from, -to, torque > 0);
    brush.stroke();
    head(brush, [middle + radius * Math.cos(to), middle - radius * Math.sin(to)], -to - Math.PI / 2 * Math.sign(torque));
  }
}
function slide(brush, share, torques, { ink, paper, colours }) {
  brush.strokeStyle = ink;
  brush.fillStyle = paper;
  brush.strokeRect(4, 44, SIZE3 - 8, 4);
  brush.fillRect(6 + share * (SIZE3 - 28), 32, 16, 12);
  brush.strokeRect(6 + share * (SIZE3 - 28), 32, 16, 12);
  for (const [n, torque] of torques.entries()) {
    const [from, to, up] = [SIZE3 / 2, SIZE3 / 2 + 24 * torque, 10 + 11 * n];
    brush.strokeStyle = brush.fillStyle = colours[n];
    brush.beginPath();
    brush.moveTo(from, up);
    brush.lineTo(to, up);
    brush.stroke();
    head(brush, [to, up], torque < 0 ? Math.PI : 0);
  }
}
function head(brush, [x, y], way) {
  brush.beginPath();
  for (const [ahead, aside] of [[5, 0], [-2, 4], [-2, -4]]) {
    brush.lineTo(x + ahead * Math.cos(way) - aside * Math.sin(way), y + ahead * Math.sin(way) + aside * Math.cos(way));
  }
  brush.fill();
}

// src/lead.js
var COUNT_IN = 4;
var AT_ONCE2 = 0.1;
var STILL = 1e-4;
function angleAt({ t, theta }, seconds2) {
  if (!(seconds2 > t[0])) return theta[0];
  if (seconds2 >= t[t.length - 1]) return theta[theta.length - 1];
  let [low, high] = [0, t.length - 1];
  while (high - low > 1) {
    const middle = low + high >> 1;
    if (t[middle] <= seconds2) low = middle;
    else high = middle;
  }
  return theta[low] + (theta[high] - theta[low]) * (seconds2 - t[low]) / (t[high] - t[low]);
}
function turnings({ t, theta }) {
  const [low, high] = range(theta);
  const least = STILL * Math.max(high - low, 1e-9);
  const turns = [{ at: t[0], theta: theta[0], turn: true }];
  let way = 0;
  for (let i = 1; i < t.length; i++) {
    const step = theta[i] - theta[i - 1];
    const now = Math.abs(step) < least ? 0 : Math.sign(step);
    if (now === way) continue;
    const last = turns[turns.length - 1];
    if (t[i - 1] - last.at > AT_ONCE2) turns.push({ at: t[i - 1], theta: theta[i - 1], turn: true });
    way = now;
  }
  const end = t.length - 1;
  if (t[end] - turns[turns.length - 1].at > AT_ONCE2) turns.push({ at: t[end], theta: theta[end], turn: true });
  return turns;
}
function beats(motion, steps) {
  const turns = turnings(motion);
  let begun = motion.t[0];
  const times2 = steps.flatMap(({ seconds: seconds2, beats: minute }) => {
    const count = minute > 0 ? Math.max(1, Math.round(seconds2 * minute / 60)) : 1;
    const first = begun;
    begun += seconds2;
    return Array.from({ length: count }, (_, n) => first + (minute > 0 ? 60 * n / minute : 0));
  });
  times2.push(motion.t[motion.t.length - 1]);
  const apart2 = times2.filter((at, n) => n === 0 || at - times2[n - 1] > AT_ONCE2);
  const turn = (at) => turns.some((one) => Math.abs(one.at - at) < AT_ONCE2);
  return apart2.map((at) => ({ at, theta: angleAt(motion, at), turn: turn(at) }));
}
function range(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
  return [low, high];
}
function stepAt(steps, seconds2) {
  let passed = 0;
  for (const [at, step] of steps.entries()) {
    passed += step.seconds;
    if (seconds2 < passed) return at;
  }
  return steps.length - 1;
}

// src/metronome.js
var AHEAD = 3;
var BEHIND = 0.5;
var CLICK = { turn: 1100, other: 700, length: 0.04 };
var Metronome = class {
  /** @param {() => number | null} where the knob stands, rad, while it is recorded */
  constructor(where) {
    this.where = where;
    this.canvas = /** @type {HTMLCanvasElement} */
    byId("lead-way");
    this.motion = null;
    this.steps = [];
    this.beats = [];
    this.turnings = [];
    this.unit = { factor: 180 / Math.PI, name: "°" };
    this.next = 0;
    this.start = null;
    this.sound = null;
    byId("lead-start").addEventListener("click", () => this.start === null ? this.begin() : this.stop());
    byId("lead-close").addEventListener("click", () => this.close());
    new ResizeObserver(() => this.draw(this.seconds)).observe(this.canvas);
  }
  /**
   * Show it, ready to begin.
   * @param {import("./lead.js").Motion} motion
   * @param {HandStep[]} steps
   * @param {"rotary" | "linear"} coordinate
   */
  open(motion, steps, coordinate) {
    this.motion = motion;
    this.steps = steps;
    this.beats = beats(motion, steps);
    this.turnings = turnings(motion);
    this.unit = coordinate === "linear" ? { factor: 1e3, name: " mm" } : { factor: 180 / Math.PI, name: "°" };
    byId("lead").hidden = false;
    this.stop();
    byId("lead-start").focus();
  }
  close() {
    this.stop();
    byId("lead").hidden = true;
  }
  /** Count in, and lead. */
  begin() {
    this.start = performance.now() + 1e3 * COUNT_IN;
    this.next = -COUNT_IN + 1;
    byId("lead-start").textContent = "Stop";
    if (
      /** @type {HTMLInputElement} */
      byId("lead-click").checked
    ) this.sound ??= new AudioContext();
    requestAnimationFrame(() => this.go());
  }
  stop() {
    this.start = null;
    byId("lead-start").textContent = "Start";
    this.draw(0);
  }
  /** Seconds since the motion began, below 0 while it is counted in. */
  get seconds() {
    return this.start === null ? 0 : (performance.now() - this.start) / 1e3;
  }
  get length() {
    return this.motion ? this.motion.t[this.motion.t.length - 1] : 0;
  }
  go() {
    if (this.start === null) return;
    const now = this.seconds;
    this.clickUntil(now);
    this.draw(now);
    if (now > this.length + BEHIND) this.stop();
    else requestAnimationFrame(() => this.go());
  }
  /** @param {number} now */
  clickUntil(now) {
    for (; ; ) {
      const at = this.next < 0 ? this.next : this.beats[this.next]?.at;
      if (at === void 0 || at > now) return;
      this.click(this.next >= 0 && this.beats[this.next].turn);
      this.next++;
    }
  }
  /** @param {boolean} turn */
  click(turn) {
    const mark = byId("lead-beat");
    mark.classList.remove("turn", "beat");
    void mark.offsetWidth;
    mark.classList.add(turn ? "turn" : "beat");
    if (!this.sound || !/** @type {HTMLInputElement} */
    byId("lead-click").checked) return;
    const [tone, loud] = [this.sound.createOscillator(), this.sound.createGain()];
    const at = this.sound.currentTime;
    tone.frequency.value = turn ? CLICK.turn : CLICK.other;
    loud.gain.setValueAtTime(turn ? 0.4 : 0.2, at);
    loud.gain.exponentialRampToValueAtTime(1e-3, at + CLICK.length);
    tone.connect(loud).connect(this.sound.destination);
    tone.start(at);
    tone.stop(at + CLICK.length);
  }
  /** @param {number} now */
  draw(now) {
    if (!this.motion || byId("lead").hidden) return;
    this.tell(now);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width < 50 || height < 50) return;
    const scale = globalThis.devicePixelRatio || 1;
    this.canvas.width = Math.round(width * scale);
    this.canvas.height = Math.round(height * scale);
    const brush = this.canvas.getContext("2d");
    if (!brush) return;
    brush.scale(scale, scale);
    this.drawWay(brush, now, width, height);
  }
  /** @param {CanvasRenderingContext2D} brush @param {number} now @param {number} width @param {number} height */
  drawWay(brush, now, width, height) {
    const motion = (
      /** @type {import("./lead.js").Motion} */
      this.motion
    );
    const [low, high] = range(motion.theta);
    const air = 24;
    const across = (theta) => high > low ? air + (theta - low) / (high - low) * (width - 2 * air) : width / 2;
    const line2 = height - 42;
    const up = (t) => line2 - (t - now) / AHEAD * (line2 - 10);
    const colour = (name2) => styleValue(name2, this.canvas);
    brush.strokeStyle = colour("--line");
    brush.lineWidth = 1;
    for (const end of [low, high]) stroke2(brush, [[across(end), 6], [across(end), line2 + 12]]);
    stroke2(brush, [[6, line2], [width - 6, line2]]);
    brush.fillStyle = colour("--soft");
    brush.font = "13px system-ui, 'DejaVu Sans', sans-serif";
    brush.textAlign = "center";
    for (const end of high > low ? [low, high] : [low]) {
      brush.fillText(`${number(Number((end * this.unit.factor).toFixed(1)))}${this.unit.name}`, across(end), height - 10);
    }
    const points = Array.from({ length: 241 }, (_, n) => now - BEHIND + n / 240 * (AHEAD + BEHIND));
    brush.strokeStyle = colour("--signature");
    brush.lineWidth = 3;
    stroke2(brush, points.map((t) => [across(angleAt(motion, t)), up(t)]));
    for (const beat of [...this.beats.filter(({ turn }) => !turn), ...this.turnings]) {
      if (beat.at < now || beat.at > now + AHEAD) continue;
      dot(brush, across(beat.theta), up(beat.at), beat.turn ? 5 : 3, colour(beat.turn ? "--chosen" : "--soft"));
    }
    dot(brush, across(angleAt(motion, now)), line2, 11, colour("--modelled"));
    const where = this.where();
    if (where !== null) dot(brush, Math.min(width, Math.max(0, across(where))), line2, 6, colour("--wrong"));
  }
  /** What to do, and how long it still takes. @param {number} now */
  tell(now) {
    const left = Math.max(0, this.length - Math.max(0, now));
    byId("lead-left").textContent = now < 0 && this.start !== null ? `${Math.ceil(-now)}` : `${left.toFixed(1)} s`;
    byId("lead-left").classList.toggle("soon", now < 0 && this.start !== null);
    const at = stepAt(this.steps, now);
    byId("lead-now").textContent = this.steps[at]?.words ?? "";
    byId("lead-then").textContent = this.steps[at + 1] ? `then ${this.steps[at + 1].words}` : "then it is done";
  }
};
function stroke2(brush, points) {
  brush.beginPath();
  for (const [x, y] of points) brush.lineTo(x, y);
  brush.stroke();
}
function dot(brush, x, y, size, colour) {
  brush.beginPath();
  brush.arc(x, y, size, 0, 2 * Math.PI);
  brush.fillStyle = colour;
  brush.fill();
}

// src/port.js
var Port = class {
  /**
   * @param {(how: Record<string, unknown>) => Promise<unknown>} attempt to record the motion from there
   * @param {() => void} begun where a hand is to be led meanwhile
   */
  constructor(attempt, begun) {
    this.attempt = attempt;
    this.begun = begun;
    this.fault = null;
    this.by_hand = false;
    byId("rig-close").addEventListener("click", () => dialog2().close());
    byId("rig-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.record({});
    });
    byId("rig-clear").addEventListener("click", () => this.record({ clear_fault: this.fault }));
  }
  /** Ask for the port of a rig. @param {boolean} by_hand */
  async ask(by_hand) {
    this.by_hand = by_hand;
    byId("rig-said").textContent = "";
    byId("rig-fault").hidden = true;
    byId("rig-warning").hidden = by_hand;
    try {
      const known2 = await ask("sources");
      byId("rig-ports").replaceChildren(...known2.ports.map(({ port: port2, words: words4 }) => make("option", { value: port2, text: words4 })));
      const [port, folder] = ["port", "folder"].map(field);
      if (!port.value && known2.ports.length === 1) port.value = known2.ports[0].port;
      if (!folder.value) folder.value = known2.folder;
    } catch (reason2) {
      byId("rig-said").textContent = wordsOf(reason2);
    }
    dialog2().showModal();
  }
  /** @param {Record<string, unknown>} more */
  async record(more) {
    const [port, folder] = ["port", "folder"].map((name2) => field(name2).value);
    byId("rig-said").textContent = "";
    byId("rig-fault").hidden = true;
    try {
      await this.attempt({ port: port || " ", folder, by_hand: this.by_hand, ...more });
      dialog2().close();
      if (this.by_hand) this.begun();
    } catch (reason2) {
      const fault = reason2 instanceof Refusal ? reason2.fault : null;
      this.fault = fault?.code ?? null;
      byId("rig-said").textContent = fault?.told ?? wordsOf(reason2);
      byId("rig-fault").hidden = fault === null;
    }
  }
};
function dialog2() {
  return (
    /** @type {HTMLDialogElement} */
    byId("rig-dialog")
  );
}
function field(name2) {
  const { elements } = (
    /** @type {HTMLFormElement} */
    byId("rig-form")
  );
  return (
    /** @type {HTMLInputElement} */
    elements.namedItem(name2)
  );
}

// src/within.js
var DIGITS = 4;
var Within = class {
  /** @param {() => unknown} design anew, within what is `wanted` by then */
  constructor(design) {
    this.wanted = {};
    this.reached = {};
    this.unit = "";
    this.about = null;
    this.shown = "";
    this.enough = null;
    byId("next-limits").addEventListener("submit", (event) => {
      event.preventDefault();
      this.read();
      design();
    });
    byId("next-enough").addEventListener("click", () => {
      if (!this.enough) return;
      this.wanted = { ...this.wanted, ...wider(this.enough, this.all) };
      design();
    });
  }
  /** All limits as they are wanted. @returns {Record<string, number>} */
  get all() {
    return (
      /** @type {Record<string, number>} */
      { ...this.reached, ...this.wanted }
    );
  }
  /** Take what is typed; a field that is empty, or as it was filled, is for what the captures reached. */
  read() {
    this.wanted = {};
    for (const { name: name2, value, validity } of this.fields) {
      if (validity.badInput) this.wanted[name2] = "no number";
      else if (value.trim() !== "" && Number(value) !== this.shows(name2, this.reached[name2])) this.wanted[name2] = Number(value) / this.factor(name2);
    }
    this.shown = "";
  }
  /** By what a limit in SI is shown. @param {string} name */
  factor(name2) {
    return this.about ? limitFactor(name2, this.about) : 1;
  }
  /** A limit in SI as its field has it. @param {string} name @param {number} value */
  shows(name2, value) {
    return shownLimit(name2, value * this.factor(name2), this.reached);
  }
  /** @returns {HTMLInputElement[]} */
  get fields() {
    return [...byId("next-limits").querySelectorAll("input")].filter(({ type }) => type === "number");
  }
  /**
   * Show the limits; what was typed is kept as long as torques and positions are in the same units.
   * @param {State} state
   */
  show(state) {
    const about2 = aboutOf(state);
    const unit = `${about2.coordinate} ${about2.unit}`;
    if (unit !== this.unit) this.wanted = {};
    this.unit = unit;
    this.about = about2;
    this.reached = state.limits ?? {};
    const shown2 = JSON.stringify([unit, this.factor("torque_Nm"), this.all]);
    if (shown2 === this.shown) return;
    this.shown = shown2;
    const words4 = limitWords(about2);
    for (const field3 of this.fields) {
      const value = this.all[field3.name];
      field3.value = value === void 0 ? "" : String(this.shows(field3.name, value));
      if (field3.name in words4 && field3.previousElementSibling) field3.previousElementSibling.textContent = words4[field3.name];
    }
    const own = Object.keys(this.wanted).length;
    byId("next-whose").textContent = own === 0 ? ": what the captures reached" : `: ${own} of your own`;
  }
  /**
   * Take the limits of a motion that is there, unless others are wanted: those of a session that goes on, say.
   * @param {Record<string, number>} limits
   */
  adopt(limits2) {
    if (Object.keys(this.wanted).length > 0) return;
    const shown2 = (name2, value) => shownLimit(name2, value, this.reached);
    const other = Object.entries(limits2).filter(([name2, value]) => shown2(name2, value) !== shown2(name2, this.reached[name2] ?? value));
    this.wanted = Object.fromEntries(other);
  }
  /**
   * Offer the smallest change of a limit that would do.
   * @param {Enough | null} enough
   * @param {State} state
   */
  offer(enough, state) {
    this.enough = enough;
    byId("next-enough").hidden = enough === null;
    if (enough) byId("next-enough").textContent = `Design with ${enoughWords(wider(enough, this.all), aboutOf(state))}`;
  }
};
function shownLimit(name2, value, { theta_min_rad: low, theta_max_rad: high }) {
  if (!name2.startsWith("theta_") || !(high > low)) return Number(value.toPrecision(DIGITS));
  const decimals = DIGITS - 1 - Math.floor(Math.log10(high - low));
  return Number(value.toFixed(Math.min(20, Math.max(0, decimals)))) + 0;
}
function wider({ limit, to }, { theta_min_rad, theta_max_rad }) {
  return limit === "theta_max_rad" ? { theta_min_rad: theta_min_rad + theta_max_rad - to, theta_max_rad: to } : { [limit]: to };
}

// src/next.js
var COLOURS = ["--modelled", "--wrong", "--signature", "--beside", "--chosen", "--ink", "--band", "--measured"];
var MOTION2 = ["t", "theta", "omega"];
var FLAT = 0.2;
var Next = class {
  /**
   * @param {{store: import("./store.js").Store, design: (body: object) => Promise<unknown>,
   *   recording: () => void, where: () => number | null, made: () => void, drop: (effect: string) => void, failed: (reason: unknown) => void}} deeds
   */
  constructor(deeds) {
    this.deeds = deeds;
    this.metronome = new Metronome(deeds.where);
    this.within = new Within(() => this.again());
    this.port = new Port((how) => this.attempt(how), () => this.metronome.begin());
    this.plots = ["angle over time", "velocity over angle", "torques of the rivals"].map(
      (name2) => new Plot(`${name2} of the next experiment`, () => {
      })
    );
    byId("next-plots").append(...this.plots.map(({ element: element2 }) => element2));
    this.state = null;
    this.motion = null;
    this.loading = null;
    this.drawn = "";
    this.effects = void 0;
    this.sharpen = "";
    this.buttons();
    new ResizeObserver(() => this.draw()).observe(byId("next-plots"));
  }
  buttons() {
    byId("next-show").addEventListener("click", () => this.told ? this.open() : this.design([]));
    byId("next-close").addEventListener("click", () => this.close());
    byId("next-record").addEventListener("click", () => this.attempt({}));
    byId("next-port").addEventListener("click", () => this.port.ask(false));
    byId("next-hand").addEventListener("click", () => this.lead());
    byId("next-file").addEventListener("click", () => this.save());
    byId("lead-record").addEventListener("click", () => this.recordHand());
    byId("next-bounds").addEventListener("click", () => this.bounds());
  }
  /** @returns {Experiment | null} */
  get told() {
    return this.state?.experiment ?? null;
  }
  /** The effects that the motion which is shown is for; none where it is for a parameter. @returns {string[]} */
  get rivals() {
    const rivals = this.told?.rivals ?? [];
    return rivals.length > 1 ? rivals.map((rival) => effectsOf(rival).at(-1) ?? "") : [];
  }
  /** Which effects a motion would be for that is designed within other limits. @returns {string[]} */
  get asked() {
    return this.effects ?? (this.told || !this.state ? this.rivals : alikeOf(this.state));
  }
  /** Show the limits, before there is a motion as well. @param {string[]} [effects] that it would be for */
  bounds(effects) {
    if (effects) this.effects = effects;
    this.open();
    byId("next-within").open = true;
  }
  /** Design within the limits as they are now; where a motion waits for what is missing, they are kept for it. */
  again() {
    return this.waits ? this.close() : this.design(this.asked, this.sharpen);
  }
  /** Whether there is nothing yet that a motion could be designed for. */
  get waits() {
    return this.state !== null && this.told === null && !this.sharpen && this.asked.length === 0 && waitsFor(this.state);
  }
  /**
   * Design a motion for effects, and show it; for none: for what is known least. Where none is within the limits, they
   * are shown in its place.
   * @param {string[]} effects
   * @param {string} [sharpen] the parameter that it is to make known best
   * @returns {Promise<boolean>} whether there is one
   */
  async design(effects, sharpen = "") {
    [this.effects, this.sharpen] = [effects, sharpen];
    const by_hand = (
      /** @type {HTMLInputElement} */
      byId("next-only-hand").checked
    );
    this.enable(false);
    this.refuse("");
    try {
      await this.deeds.design({ effects, sharpen, limits: this.within.wanted, by_hand });
      this.open();
      return true;
    } catch (reason2) {
      const words4 = this.state ? ofLimits(wordsOf(reason2), aboutOf(this.state)) : "";
      if (!words4.startsWith("limits")) {
        this.deeds.failed(reason2);
        return false;
      }
      this.open();
      this.refuse(words4, reason2 instanceof Refusal ? reason2.enough : null);
      return false;
    } finally {
      this.enable(true);
    }
  }
  /**
   * Say why there is no motion, and with which limit there would be one; nothing where there is.
   * @param {string} words
   * @param {import("./types.js").Enough | null} [enough]
   */
  refuse(words4, enough = this.told?.change ?? null) {
    byId("next-refused").textContent = words4;
    if (words4) byId("next-within").open = true;
    if (this.state) this.within.offer(enough, this.state);
  }
  /** What makes another one waits for this one. @param {boolean} free */
  enable(free) {
    for (const id of ["next-record", "next-port", "next-again", "next-hand", "next-show", "next-enough"]) {
      byId(id).disabled = !free;
    }
  }
  open() {
    byId("next").hidden = false;
    this.drawn = "";
    if (this.state) this.show(this.state);
    byId("next-close").focus();
  }
  close() {
    this.metronome.close();
    byId("next").hidden = true;
  }
  /** @param {State} state */
  show(state) {
    if (this.state?.node !== state.node) [this.effects, this.sharpen] = [void 0, ""];
    this.state = state;
    showUntold(byId("untold"), state, (effects) => this.design(effects), this.deeds.drop);
    const { experiment, node, recording } = state;
    byId("next-line").hidden = experiment === null && !tellsNext(state);
    const instead = experiment === null ? insteadOf(state) : "";
    byId("next-show").textContent = experiment ? "Next experiment…" : instead ? "Design that motion…" : "What to record next…";
    byId("next-show").hidden = experiment === null && waitsFor(state);
    byId("next-bounds").hidden = experiment === null && state.record !== null && waitsFor(state);
    byId("next").classList.toggle("without", experiment === null);
    if (node === null) byId("next").hidden = true;
    this.within.show(state);
    if (experiment === null) {
      byId("next-said").textContent = instead;
      for (const id of ["next-time", "next-verdict"]) byId(id).textContent = "";
      const { asked: asked2 } = this;
      byId("next-headline").replaceChildren(...asked2.length > 1 ? ["For a motion that tells apart ", ...allOf(asked2), "."] : [purposeOf(state)]);
      byId("next-again").textContent = this.waits ? "Keep" : "Design";
      return;
    }
    byId("next-said").replaceChildren(...nodes(experiment.verdict ?? experiment.promises, aboutOf(state)));
    if (byId("next").hidden) return;
    this.enable(!recording);
    const shown2 = JSON.stringify([experiment, node, state.active]);
    if (shown2 === this.drawn) return;
    this.drawn = shown2;
    this.tell(experiment, state);
    this.loading = this.load(experiment, state).catch(this.deeds.failed);
  }
  /** @param {Experiment} experiment @param {State} state */
  tell(experiment, state) {
    const { headline, verdict, source, pairs, steps, by_hand, seconds: seconds2 } = experiment;
    const about2 = aboutOf(state);
    if (experiment.capture === null) this.within.adopt(experiment.limits);
    this.within.show(state);
    this.refuse("");
    byId("next-again").textContent = "Design again";
    byId("next-time").textContent = `${number(seconds2)} s`;
    const called2 = headline.map((part) => typeof part === "string" ? inFormWords(part, about2) : part);
    byId("next-headline").replaceChildren(...nodes(called2, about2));
    byId("next-verdict").replaceChildren(...nodes(verdict ?? [], about2));
    byId("next-record").hidden = source === null;
    byId("next-record").textContent = experiment.capture ? "Record it again" : "Record it";
    byId("next-record").title = source ? `from ${source}` : "";
    byId("next-source").textContent = source ? `from ${source}` : "";
    byId("next-keys").replaceChildren(...experiment.rivals.map((rival, at) => key(nodes(rival, about2), at)));
    byId("next-evidence").hidden = pairs.length === 0;
    byId("next-pairs").replaceChildren(...pairs.flatMap((pair) => bars(pair, about2, experiment.told)));
    const tempi = new Set(steps.map(({ beats: beats2 }) => Math.round(beats2)).filter(Boolean));
    const led = tempi.size === 1 ? ` at ${[...tempi][0]} beats a minute` : "";
    byId("next-can").textContent = by_hand ? `By hand, led by a metronome${led}` : "For a motor";
    byId("next-no-hand").hidden = by_hand;
    byId("next-steps").replaceChildren(...(by_hand ? steps : []).map(({ words: words4 }) => make("li", {}, sentence([words4], about2))));
  }
  /** @param {Experiment} experiment @param {State} state */
  async load(experiment, { node, active }) {
    if (node === null) return;
    const { store } = this.deeds;
    const [motion, ...parts] = await Promise.all([
      fetchBytes("/api/motion", { experiment: experiment.id }).then(decode),
      ...active.map((capture) => store.ofCapture(node, capture, MOTION2))
    ]);
    this.motion = motion;
    this.recorded = parts;
    timed("experiment", () => this.draw());
  }
  /** Draw the motion over what was recorded, and by what the rivals part on it. */
  draw() {
    const { motion, recorded = [], state } = this;
    if (!motion || !state?.experiment || byId("next").hidden) return;
    const words4 = motionWords(aboutOf(state));
    const both = (name2) => [...recorded.map((part) => part[name2]), motion[name2]];
    const since2 = recorded.map(({ t }) => t.map((value) => value - (t[0] ?? 0)));
    const [over, across] = ["theta", "omega"].map((name2) => ({ y: both(name2), name: name2 }));
    for (const [at, { y, name: name2 }] of [over, across].entries()) {
      const x = at === 0 ? [...since2, motion.t] : both("theta");
      const label = (one) => `${words4[one].name}, ${words4[one].unit}`;
      this.plots[at].show({
        title: at === 0 ? `${words4.theta.name} over time` : `velocity over ${words4.theta.name}`,
        ...clouds(x, y, ["--measured", "--signature"]),
        xAxis: at === 0 ? axis(limits(x), "time, s") : seen(x, label("theta")),
        yAxis: seen(y, label(
          /** @type {"theta" | "omega"} */
          name2
        )),
        ...{ picked: 0, noise: null }
      });
    }
    const apart2 = state.experiment.rivals.map((_, at) => motion[`rival ${at}`]);
    const [low, high] = limits(apart2);
    const scale = torqueScale(state);
    this.plots[2].show({
      title: apart2.length > 1 ? `how the ${torqueWord(state.unit)} of each rival parts from the others` : `${torqueWord(state.unit)} that it takes`,
      x: motion.t,
      series: apart2.map((y, at) => ({ colour: COLOURS[at % COLOURS.length], chosen: null, y, strength: 1 })),
      xAxis: axis(limits([motion.t]), "time, s"),
      yAxis: { low, high, factor: scale.factor, label: apart2.length > 1 ? `less their mean, ${scale.unit}` : scale.unit },
      ...{ picked: 0, noise: null }
    });
  }
  /** Record the motion. @param {Record<string, unknown>} how @returns {Promise<boolean>} whether it began */
  async attempt(how) {
    if (!this.told) return false;
    const live = !this.told.source?.startsWith("the simulated") || "port" in how;
    this.enable(false);
    try {
      await post("try", { experiment: this.told.id, ...how });
    } catch (reason2) {
      if ("port" in how) throw reason2;
      this.deeds.failed(reason2);
      return false;
    } finally {
      this.enable(true);
    }
    if (live) this.deeds.recording();
    else this.deeds.made();
    return true;
  }
  /** Lead a hand through the motion; where it is for a motor, through one that a hand can make. */
  async lead() {
    if (this.told && !this.told.by_hand) {
      byId("next-only-hand").checked = true;
      this.within.read();
      if (!await this.design(this.asked)) return;
    }
    await this.loading;
    const { told, motion, state } = this;
    if (!told || !motion) return;
    if (state) this.metronome.open({ t: motion.t, theta: motion.theta }, told.steps, aboutOf(state).coordinate);
  }
  /** Record while the hand is led: from the rig of before, or from one that is asked for. */
  async recordHand() {
    const source = this.told?.source ?? "";
    if (!source.startsWith("the rig") && !source.startsWith("an emulated")) return this.port.ask(true);
    if (await this.attempt({ by_hand: true })) this.metronome.begin();
  }
  async save() {
    if (!this.told) return;
    try {
      const content = await fetchBytes("/api/motion-file", { experiment: this.told.id });
      const place4 = URL.createObjectURL(new Blob([content]));
      make("a", { href: place4, download: "motion.toml" }).click();
      setTimeout(() => URL.revokeObjectURL(place4), 1e4);
    } catch (reason2) {
      this.deeds.failed(reason2);
    }
  }
};
function axis([low, high], label) {
  return { low, high, factor: 1, label };
}
function seen(every, label) {
  const [whole, own] = [limits(every), limits(every.slice(-1))];
  const flat = own[1] - own[0] < FLAT * (whole[1] - whole[0]);
  return { ...axis(flat ? own : whole, label), part: flat };
}
function clouds(x, y, [before, motion]) {
  const whole = x.reduce((total, column) => total + column.length, 0);
  const first = whole - x[x.length - 1].length;
  const along = new Float32Array(whole);
  const [old, fresh] = [new Float32Array(whole).fill(NaN), new Float32Array(whole).fill(NaN)];
  let at = 0;
  for (const [n, column] of x.entries()) {
    along.set(column, at);
    (at < first ? old : fresh).set(y[n], at);
    at += column.length;
  }
  return {
    x: along,
    series: [
      { colour: before, chosen: null, y: old, strength: 0.5 },
      { colour: motion, chosen: null, y: fresh, strength: 1 }
    ]
  };
}
function allOf(effects) {
  return [...listed(effects.slice(0, -1), ", "), " and ", ...listed(effects.slice(-1), "")];
}
function key(name2, at) {
  const mark = make("i", {});
  mark.style.background = `var(${COLOURS[at % COLOURS.length]})`;
  return make("span", { class: "key" }, mark, ...name2);
}
function effectsOf(rival) {
  return rival.flatMap((part) => typeof part === "object" && "effect" in part ? [part.effect] : []);
}

// src/overlay.js
var TYPED = "the formula that is typed";
var LOOK_MS = 60;
var Overlay = class {
  /**
   * @param {import("./store.js").Store} store
   * @param {import("./linked.js").Linked} linked
   * @param {() => State | null} state
   * @param {(reason: unknown) => void} failed
   */
  constructor(store, linked, state, failed) {
    this.store = store;
    this.linked = linked;
    this.state = state;
    this.failed = failed;
    this.looking = new AbortController();
    this.looked = null;
  }
  /**
   * Show what something would explain: an effect or a law, by what it is called and how it is asked for.
   * @param {string | null} what
   * @param {string} [verb]
   * @param {Record<string, string>} [asked]
   */
  async look(what, verb = "", asked2 = {}) {
    if (what === this.looked) return;
    this.looked = what;
    this.looking.abort();
    this.looking = new AbortController();
    const { signal } = this.looking;
    byId("looked").textContent = what ? `what ${titleOf(what)} would explain` : "";
    byId("looked").toggleAttribute("hidden", what === null);
    const state = this.state();
    const node = state?.node;
    if (!what || !state || !node) return timed("look away", () => this.linked.overlay(null));
    const start = performance.now();
    await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
    if (signal.aborted || this.state()?.node !== node) return;
    try {
      const column = await this.store.explained(node, state.active, what, { verb, asked: asked2 }, signal);
      if (!signal.aborted) timed("look", () => this.linked.overlay(column), start);
    } catch (reason2) {
      if (!signal.aborted) this.failed(reason2);
    }
  }
  /**
   * Fit a formula that is still typed, and show what it would explain.
   * @param {object} formula
   * @param {(tried: import("./types.js").Law) => void} told
   * @returns {Promise<string>} what is wrong with it; empty for nothing
   */
  async attempt(formula, told) {
    try {
      const { tried, unfinished } = await post("typed", { ...formula, typed_ms: Date.now() });
      if (unfinished !== void 0) this.look(null);
      if (!tried) return unfinished ?? "";
      told(tried);
    } catch (reason2) {
      this.look(null);
      return wordsOf(reason2);
    }
    this.looked = null;
    this.store.forget(TYPED);
    await this.look(TYPED, "law", { number: "typed" });
    return "";
  }
};

// src/params.js
var STEPS = 400;
var WORDED = 8;
var Params = class {
  /**
   * @param {HTMLElement} place
   * @param {{drag: (values: Record<string, number>) => void, drop: (effect: string) => void}} deeds
   */
  constructor(place4, deeds) {
    this.place = place4;
    this.deeds = deeds;
    this.rows = /* @__PURE__ */ new Map();
    this.shape = "";
  }
  /** @param {Param[]} params @param {import("./types.js").Together[]} together @param {import("./said.js").About} about */
  show(params, together, about2) {
    showTogether(together);
    const units = params.map(({ unit }) => scaleOf(unit, about2));
    const shape = JSON.stringify(params.map(({ name: name2, fitted, lower, upper }, at) => [name2, fitted, lower, upper, units[at]]));
    if (shape !== this.shape) this.build(params, about2);
    this.shape = shape;
    for (const [at, param] of params.entries()) {
      const row = this.rows.get(param.name);
      if (!row) continue;
      const shown2 = param.dragged ? number(param.value * row.factor, 4) : asKnown(param.value * row.factor, halfOf(param) * row.factor);
      row.value.textContent = shown2;
      row.apart.textContent = apart(param);
      row.error.hidden = param.dragged;
      row.slider.setAttribute("aria-valuetext", `${shown2} ${units[at].unit}`);
      row.value.classList.toggle("moved", param.dragged);
      if (document.activeElement !== row.slider) row.slider.value = String(place3(param.value, row));
    }
  }
  /** @param {Param[]} params @param {import("./said.js").About} about */
  build(params, about2) {
    const focused = document.activeElement?.getAttribute("data-param");
    this.rows.clear();
    const groups = Map.groupBy(params, ({ name: name2 }) => name2.split(".")[0]);
    const lines = [...groups].flatMap(([effect, own]) => {
      const doubts = own.map(({ name: name2, doubt }) => doubt ? sentence(withoutName(doubt, name2), about2).trim() : "");
      const shared = sharedDoubts(own, doubts);
      return [
        this.heading(effect, groups.size > 1),
        ...[...shared].map(([doubt, names]) => reason(`${names.join(", ")}: ${doubt}`)),
        ...own.flatMap((param, at) => [
          this.line(param, doubts[at], scaleOf(param.unit, about2)),
          own.length <= WORDED ? this.meaning(param) : "",
          shared.has(doubts[at]) ? "" : reason(doubts[at])
        ])
      ];
    });
    const widths = make("colgroup", {}, ...["name", "slide", "value", "unit"].map((name2) => make("col", { class: name2 })));
    this.place.replaceChildren(make("table", { class: "params" }, widths, make("tbody", {}, ...lines)));
    if (focused) this.rows.get(focused)?.slider.focus();
  }
  /** @param {string} effect @param {boolean} removable */
  heading(effect, removable) {
    const drop = make("button", {
      ...{ type: "button", text: "×", title: `remove ${titleOf(effect)}`, "aria-label": `remove ${titleOf(effect)}` },
      on: { click: () => this.deeds.drop(effect) }
    });
    const name2 = make("th", { scope: "rowgroup", colspan: 3, text: titleOf(effect), title: effect });
    return make("tr", { class: "effect" }, name2, make("td", { class: "remove" }, removable ? drop : ""));
  }
  /** @param {Param} param @param {string} doubted why its value is doubted @param {ReturnType<typeof scaleOf>} scale */
  line(param, doubted, { factor: factor2, unit }) {
    const { low, high } = span3(param);
    const slider = make("input", {
      ...{ type: "range", min: 0, max: STEPS, step: 1, value: place3(param.value, { low, high }) },
      ...{ "aria-label": paramOf(param.name), "data-param": param.name, disabled: param.role === "fixed" },
      on: { input: () => this.drag(param.name) }
    });
    const value = make("span", { class: "figure" });
    const error = make("span", { class: "error soft figure", text: plusMinus(param, factor2) });
    this.rows.set(param.name, { slider, value, error, apart: make("span"), low, high, factor: factor2 });
    const between3 = param.ci95 ? param.ci95.map((end) => number(end * factor2)).join(" … ") : "not determined";
    const doubt = doubted ? make("span", { class: "doubt", text: " ⚠", "aria-hidden": "true" }) : null;
    const about2 = [param.name, param.meaning, doubted].filter(Boolean).join(": ");
    return make(
      "tr",
      {},
      make("th", { scope: "row", title: about2 }, param.name.split(".").slice(1).join("."), doubt),
      make("td", { class: "slide" }, interval(param.ci95, { low, high }), slider),
      make("td", { class: "value", title: `95 % interval ${between3} ${unit}` }, value, " ", error),
      make("td", { class: "soft unit", text: unitWords(unit), title: unit })
    );
  }
  /** What a parameter is, below it. @param {Param} param */
  meaning({ name: name2, meaning: words4 }) {
    if (!words4 || name2.endsWith(`.${words4}`)) return "";
    return make("tr", {}, make("td", { class: "meaning soft", colspan: 4 }, words4, this.rows.get(name2)?.apart ?? ""));
  }
  /** @param {string} name */
  drag(name2) {
    const row = this.rows.get(name2);
    if (!row) return;
    const value = row.low + Number(row.slider.value) / STEPS * (row.high - row.low);
    row.value.textContent = number(value * row.factor, 4);
    row.value.classList.add("moved");
    this.deeds.drag({ [name2]: value });
  }
};
function apart({ name: name2, unit, value }) {
  if (!name2.endsWith(".P") || !(value > 0)) return "";
  if (unit !== "rad") return unit === "m" ? `: every ${number(2e3 * Math.PI * value, 4)} mm` : "";
  return `: ${number(1 / value, 4)} a turn, ${number(360 * value, 4)}° apart`;
}
function withoutName([first, ...rest], name2) {
  const own = typeof first === "object" && "param" in first && first.param === name2;
  const beside2 = typeof rest[0] === "string" && /^( and |, )/.test(rest[0]);
  return own && !beside2 ? rest : [first, ...rest];
}
function sharedDoubts(own, doubts) {
  const letters = own.map(({ name: name2 }) => name2.split(".").slice(1).join("."));
  const several = new Set(doubts.filter((doubt, at) => doubt !== "" && doubts.indexOf(doubt) !== at));
  return new Map([...several].map((doubt) => [doubt, letters.filter((_, at) => doubts[at] === doubt)]));
}
function reason(doubt) {
  if (!doubt) return "";
  return make("tr", {}, make("td", { class: "reason doubt", colspan: 4, text: doubt }));
}
function showTogether(together) {
  byId("together").hidden = together.length === 0;
  const rows = together.map(
    ({ names, correlation }) => make("tr", {}, make("th", { scope: "row", text: names.map(paramOf).join(" and "), title: names.join(", ") }), make("td", { class: "figure", text: number(correlation, 3) }))
  );
  byId("together-rows").replaceChildren(...rows);
}
function span3({ fitted, ci95, lower, upper }) {
  const half = ci95 ? 2 * Math.abs(ci95[1] - ci95[0]) : 0;
  const reach2 = Math.max(Math.abs(fitted), half, 1e-9);
  return { low: Math.max(fitted - reach2, lower ?? -Infinity), high: Math.min(fitted + reach2, upper ?? Infinity) };
}
function halfOf({ ci95 }) {
  return ci95 ? 0.5 * (ci95[1] - ci95[0]) : NaN;
}
function plusMinus({ ci95, role }, factor2 = 1) {
  if (role === "fixed") return "fixed";
  if (!ci95) return "± ?";
  const half = factor2 * halfOf({ ci95 });
  return half > 0 ? `± ${asKnown(half, half)}` : "";
}
function interval(ci95, { low, high }) {
  if (!ci95 || !(high > low)) return null;
  const [from, to] = ci95.map((end) => Math.min(1, Math.max(0, (end - low) / (high - low))));
  const bar2 = make("span", { class: "interval" });
  bar2.style.left = `calc(var(--thumb) / 2 + ${from} * (100% - var(--thumb)))`;
  bar2.style.width = `calc(${to - from} * (100% - var(--thumb)))`;
  return bar2;
}
function place3(value, { low, high }) {
  return high > low ? Math.round(STEPS * (value - low) / (high - low)) : 0;
}

// src/sources.js
var LEVELS = /* @__PURE__ */ new Set(["easy", "middling", "hard"]);
var NUMBERS = /* @__PURE__ */ new Set(["duration_s", "speed", "seed", "baud"]);
function sources(heard) {
  const dialog3 = (
    /** @type {HTMLDialogElement} */
    byId("new-dialog")
  );
  const form = (
    /** @type {HTMLFormElement} */
    byId("new-form")
  );
  const go = (
    /** @type {HTMLButtonElement} */
    byId("new-go")
  );
  const told = byId("new-said");
  let known2 = null;
  let busy = false;
  const shown2 = () => {
    const source = valueOf(form, "source");
    for (const part of form.querySelectorAll("[data-for]")) {
      part.toggleAttribute("hidden", !part.getAttribute("data-for")?.split(" ").includes(source));
    }
    byId("new-together").hidden = heard.open() === 0;
    byId("new-effects").hidden = valueOf(form, "hides") !== "chosen";
    go.textContent = source === "simulated" ? "Simulate" : "Record";
    if (!known2) return;
    fill(form, "motion", Object.entries(known2.motions[source]).map(([name2, words4]) => [name2, `${name2}: ${words4}`]));
    byId("new-warning").hidden ||= valueOf(form, "motion") === "hand" && !valueOf(form, "model").trim();
    const level2 = levelOf(form);
    for (const name2 of ["knob", "motion", "duration_s", "seed"]) field2(form, name2).disabled = level2 !== "";
    const hideable = known2.knobs.find(({ name: name2 }) => name2 === valueOf(form, "knob"))?.hideable ?? [];
    for (const box of byId("new-effects").querySelectorAll("input")) box.disabled = !hideable.includes(box.value);
  };
  const opened = async () => {
    shown2();
    dialog3.showModal();
    told.textContent = "";
    byId("new-fault").hidden = true;
    if (!known2) byId("new-doing").textContent = "looking for knobs and rigs …";
    try {
      known2 = /** @type {Sources} */
      await ask("sources");
    } catch (reason2) {
      told.textContent = wordsOf(reason2);
      return;
    } finally {
      byId("new-doing").textContent = "";
    }
    fill(form, "knob", known2.knobs.map(({ name: name2, words: words4 }) => [name2, words4]), "knob3");
    const { hideable } = known2.knobs[0];
    const every = [.../* @__PURE__ */ new Set([...hideable, ...known2.knobs.flatMap((knob2) => knob2.hideable)])];
    if (!byId("new-effects").querySelector("input")) byId("new-effects").append(...every.map(effectBox(known2)));
    byId("new-ports").replaceChildren(...known2.ports.map(({ port: port2, words: words4 }) => make("option", { value: port2, text: words4 })));
    byId("new-found").textContent = found(known2.ports);
    const port = field2(form, "port");
    const typing = document.activeElement === port;
    if (!port.value && !typing && known2.ports.length === 1) port.value = known2.ports[0].port;
    if (!field2(form, "folder").value) field2(form, "folder").value = known2.folder;
    const emulated = (
      /** @type {HTMLInputElement} */
      form.querySelector("[value=emulated]")
    );
    emulated.disabled = known2.no_emulated_rig !== null;
    byId("new-absent").textContent = known2.no_emulated_rig && `No emulated rig here: ${known2.no_emulated_rig}.`;
    byId("new-absent").hidden = known2.no_emulated_rig === null;
    shown2();
  };
  const wait = (waiting) => {
    busy = waiting;
    go.disabled = waiting;
    byId("new-doing").textContent = "";
  };
  byId("new").addEventListener("click", opened);
  byId("new-first").addEventListener("click", opened);
  form.addEventListener("change", shown2);
  byId("new-close").addEventListener("click", () => dialog3.close());
  dialog3.addEventListener("close", () => {
    if (busy) post("stop", { keep: false }).catch(() => {
    });
  });
  let fault = null;
  byId("new-clear").addEventListener("click", () => begin({ ...wanted(form), clear_fault: fault }));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    return begin(wanted(form));
  });
  const begin = async (asked2) => {
    told.textContent = "";
    byId("new-fault").hidden = true;
    wait(true);
    try {
      if (asked2.source === "simulated") {
        await post("simulate", asked2);
        heard.say("made a capture");
      } else {
        await post("record", asked2);
      }
      wait(false);
      dialog3.close();
      (asked2.source === "simulated" ? heard.made : heard.recording)();
    } catch (reason2) {
      wait(false);
      fault = reason2 instanceof Refusal && reason2.fault ? reason2.fault.code : null;
      told.textContent = reason2 instanceof Refusal && reason2.fault ? reason2.fault.told : asCalled(form, wordsOf(reason2));
      byId("new-fault").hidden = fault === null;
    }
  };
}
function preparing(what) {
  const { open } = (
    /** @type {HTMLDialogElement} */
    byId("new-dialog")
  );
  byId("new-doing").textContent = open ? `${what} …` : "";
}
function asCalled(form, words4) {
  const [, name2 = "", value, rest] = /^(\w+)=(.*?): (.*)$/s.exec(words4) ?? [];
  const label = form.querySelector(`[name="${name2}"]`)?.closest("label")?.querySelector("span")?.textContent;
  return label ? `${label}${value === "''" ? "" : ` = ${value}`}: ${rest}` : words4;
}
function wanted(form) {
  const body = {};
  for (const [name2, value] of new FormData(form)) {
    if (typeof value === "string" && name2 !== "effects") body[name2] = NUMBERS.has(name2) ? numeric(value) : value;
  }
  const chosen = [...form.querySelectorAll("#new-effects input:checked:not(:disabled)")];
  body.level = levelOf(form);
  body.surprise = body.hides === "surprise";
  body.effects = body.hides === "chosen" ? chosen.map((box) => (
    /** @type {HTMLInputElement} */
    box.value
  )) : [];
  body.together = "together" in body;
  return body;
}
function levelOf(form) {
  const hides = valueOf(form, "hides");
  return valueOf(form, "source") === "simulated" && LEVELS.has(hides) ? hides : "";
}
function numeric(value) {
  const number3 = Number(value);
  return value.trim() && Number.isFinite(number3) ? number3 : value;
}
function effectBox({ effects: shows, titles: titles2 }) {
  return (name2) => make(
    "label",
    { title: `${name2}: ${shows[name2] ?? ""}` },
    make("input", { type: "checkbox", name: "effects", value: name2 }),
    ` ${titles2[name2] ?? name2}`
  );
}
function found(ports) {
  if (ports.length === 0) return "This computer has no serial port now; a path can be typed all the same.";
  return ports.map(({ port, words: words4 }) => words4 && words4 !== "n/a" ? `${port} (${words4})` : port).join(", ");
}
function fill(form, name2, choices, first) {
  const list = (
    /** @type {HTMLSelectElement} */
    form.elements.namedItem(name2)
  );
  const before = list.value || first;
  list.replaceChildren(...choices.map(([value, text]) => make("option", { value, text })));
  if (choices.some(([value]) => value === before)) list.value = before ?? "";
}
function field2(form, name2) {
  return (
    /** @type {HTMLInputElement} */
    form.elements.namedItem(name2)
  );
}
function valueOf(form, name2) {
  return String(new FormData(form).get(name2) ?? "");
}

// src/theme.js
var KEY2 = "knobcam-theme";
function themed(changed) {
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const kept = localStorage.getItem(KEY2);
  if (kept === "light" || kept === "dark") root.dataset.theme = kept;
  const dark = () => root.dataset.theme ? root.dataset.theme === "dark" : system.matches;
  byId("theme").addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    localStorage.setItem(KEY2, root.dataset.theme);
    changed();
  });
  system.addEventListener("change", changed);
}

// src/verdict.js
function showVerdict(element2, { added, concluded, verdict, candidates, titles: titles2, sets, proposed }, about2, to) {
  const key2 = JSON.stringify([added, concluded, verdict, candidates, about2, titles2, sets, proposed]);
  if (element2.dataset.told === key2) return;
  element2.dataset.told = key2;
  const worst = [...concluded, ...verdict].find((part) => typeof part === "object" && "low" in part);
  const place4 = (
    /** @type {Stretch | undefined} */
    worst
  );
  const shown2 = (part) => {
    const [words4, leads] = [wordsOfPart(part, about2), leadOf(part, place4, candidates, to)];
    return leads ? link({ words: words4, ...leads }) : words4;
  };
  const open = concluded.length > 0 ? [] : plainly(candidates, about2, to);
  const first = open.map((part) => typeof part === "string" ? part : link(part));
  const ways = further({ sets, proposed }, about2, to).map((part) => typeof part === "string" ? part : link(part));
  const head2 = beside(added, [...first, ...concluded.map(shown2)]);
  element2.replaceChildren(...head2.length > 0 ? [make("strong", {}, ...head2), ...ways, " "] : [], ...verdict.map(shown2));
}
function beside(added, [first, ...rest]) {
  if (first === void 0) return [];
  if (added.length === 0) return [first, ...rest];
  const names = added.map(titleOf);
  const all = names.length > 1 ? `${names.slice(0, -1).join(", ")} and ${names.at(-1)}` : names[0];
  const begun = typeof first === "string" ? `${first.slice(0, 1).toLowerCase()}${first.slice(1)}` : first;
  return [`With ${all} added, `, begun, ...rest];
}
function leadOf(part, place4, { rows }, to) {
  if (typeof part === "string") return null;
  if ("low" in part) return { kind: "place", title: "show its samples in every plot", go: () => to.place(part) };
  if ("along" in part && place4 && part.along === place4.axis) return { title: "draw a row over it", go: () => to.place(place4) };
  if ("effect" in part && rows.some(({ effect }) => effect === part.effect)) return towards(part.effect, to);
  if (!("topic" in part)) return null;
  return part.topic === "error" ? { title: "the ladder of errors", go: to.error } : { title: "why: what was found in the log", go: to.findings };
}
function towards(effect, to) {
  return { title: `what it would explain (${effect})`, go: () => to.effect(effect) };
}
function link({ words: words4, title, go, kind = "" }) {
  const click = (event) => {
    event.preventDefault();
    go();
  };
  return make("a", { class: `leads ${kind}`.trim(), href: "#plots", title, text: words4, on: { click } });
}
function plainly({ ready, rows }, about2, to) {
  const first = ready ? rows.find(({ could_be: could }) => could) : void 0;
  if (!first) return [];
  const { effect, name: name2, error_fall: fall, equivalent, unsettled } = first;
  const said = sentence(first.said, about2);
  const lead = (one) => ({ words: titleOf(one), ...towards(one, to) });
  return [
    `${said.slice(0, 1).toUpperCase()}${said.slice(1)}: ${name2} (`,
    lead(effect),
    `), which takes ${percent(fall)} off the error. `,
    ...unsettled ? [`But ${unsettled}. `] : [],
    { words: "Add it", title: "take it into the model, and fit it", go: () => to.add(effect) },
    unsettled ? " to see what is left, not for its values; or " : ", and see what is left; or ",
    { words: "find everything", title: "add step by step all that is missing, sets of effects too", go: () => to.every() },
    " at once.",
    ...equivalent.length > 0 ? tied(first.word === "part", equivalent.map(lead), () => to.apart([effect, ...equivalent])) : []
  ];
}
function further({ sets, proposed }, about2, to) {
  const law = proposed?.[0];
  const { factor: factor2, unit } = torqueScale(about2);
  const [left, of] = law ? [law.rmse, law.rmse / (1 - law.fall)].map((one) => number(one * factor2)) : [];
  return [
    ...law ? [" ", { words: "A formula", title: "what is left as a curve, and the laws that draw it", go: () => to.laws() }, ` is proposed: it would leave ${left} ${unit} of the ${of} ${unit} that it was looked for in.`] : [],
    ...sets ? [" Effects were weighed one at a time: ", { words: "find everything", title: "add step by step all that is missing, sets of effects too", go: () => to.every() }, " weighs sets of them too."] : []
  ];
}
function tied(part, others, go) {
  const tell = { words: "Tell apart", title: "design the motion that would tell", go };
  const between3 = (at) => at === 0 ? [] : [at === others.length - 1 ? " or " : ", "];
  const named2 = others.flatMap((one, at) => [...between3(at), one]);
  return [part ? " Instead of it, or beside it, it could be " : " This motion looks the same with ", ...named2, ": once nothing else is missing, ", tell, " designs what to record next."];
}

// src/app.js
var App = class {
  constructor() {
    this.store = new Store();
    this.state = null;
    this.job = null;
    this.view = { axes: USUAL, isolated: false, band: false, held: true };
    this.then = null;
    this.drawn = "";
    this.beside = null;
    this.deed = { what: "first picture", start: 0 };
    this.looks = new Looking(() => ({ view: this.view, beside: this.beside, brush: this.linked.brushed }));
    this.brushedThen = null;
    this.linked = new Linked(
      (words4) => {
        byId("chosen").textContent = words4 ?? BRUSH_HINT;
        this.leavable?.();
        this.looks.changed();
      },
      (axes) => this.see({ axes }),
      { fetched: true, pointed: showMoment }
    );
    byId("plots").append(this.linked.element);
    this.leavable = leaving(this.linked, () => this.state, async (runs) => {
      if (await this.ask("leave-out", { runs }, "data")) this.linked.clear();
    });
    this.overlay = new Overlay(this.store, this.linked, () => this.state, (reason2) => this.failed(reason2));
    this.refresh = latest((revision) => this.load(revision));
    this.drag = latest(async (values) => {
      await this.ask("params", values, "drag");
    });
    this.params = new Params(byId("params"), {
      drag: (values) => this.drag(values),
      drop: (effect) => this.ask("drop", { effect }, "drop")
    });
    const deeds = {
      look: (effect) => this.overlay.look(effect, "signature", { effect: effect ?? "" }),
      take: (effect) => this.ask("add", { effect }, "add"),
      ask: () => this.ask("diagnose"),
      about: (effect) => this.about(effect),
      apart: (effects) => void this.next.design(effects),
      bounds: (effects) => this.next.bounds(effects)
    };
    this.candidates = new Candidates(byId("candidates"), deeds, "Add");
    this.laws = new Laws(byId("laws"), {
      ask: () => this.ask("propose"),
      look: (number3) => this.overlay.look(number3 === null ? null : `law ${number3}`, "law", { number: String(number3) }),
      take: (number3, name2) => this.ask("accept", { number: number3, name: name2 }, "add"),
      add: async (formula) => await this.ask("formula", formula, "add") !== null,
      attempt: (formula, told) => this.overlay.attempt(formula, told)
    });
    this.any = new AnyEffect((effect) => this.ask("add", { effect }, "add"), (effect) => this.about(effect));
    this.live = null;
    this.next = new Next({
      store: this.store,
      design: async (body) => {
        await post("design", body);
        this.say("");
        await this.load(Infinity);
      },
      recording: () => this.live?.follow(),
      where: () => this.live?.angle ?? null,
      ...{ made: () => this.refresh(Infinity), drop: (effect) => void this.ask("drop", { effect }, "drop") },
      failed: (reason2) => this.failed(reason2)
    });
  }
  start() {
    const heard = {
      done: () => this.refresh(Infinity),
      failed: (reason2) => this.failed(reason2),
      say: (words4) => this.say(words4)
    };
    this.askOf = opening(heard);
    saving(heard);
    unhiding(heard);
    this.live = new Live({ ...heard, open: (path) => this.ask("open", { path }, "data") });
    sources({
      ...{ made: heard.done, say: heard.say, recording: () => this.live?.follow() },
      open: () => this.state?.captures.length ?? 0
    });
    themed(() => {
      this.linked.redraw();
      this.next.draw();
    });
    this.buttons();
    showMoment(null, null);
    keys({
      stop: () => this.live?.following && this.live.stop(true),
      // Escape is what a hand finds without looking
      clear: () => this.linked.clear(),
      closer: () => this.linked.lookCloser()
    });
    listen({
      state: (revision) => this.refresh(revision),
      progress: (job) => job.recording ? this.showRecording(job) : this.showJob(job),
      connected: (well) => byId("lost").toggleAttribute("hidden", well)
    });
    this.refresh(0);
  }
  buttons() {
    for (const verb of ["undo", "redo", "snap", "search"]) {
      byId(verb).addEventListener("click", () => this.ask(verb, {}, verb));
    }
    jobButtons((verb) => this.ask(verb), (words4) => this.say(words4));
    byId("new-branch").addEventListener("click", () => this.ask("branch"));
    byId("clear").addEventListener("click", () => this.linked.clear());
    byId("closer").addEventListener("click", () => this.linked.lookCloser());
    for (
      const option of
      /** @type {const} */
      ["isolated", "band", "held"]
    ) {
      const box = (
        /** @type {HTMLInputElement} */
        byId(option)
      );
      box.addEventListener("change", () => this.see({ [option]: box.checked }));
    }
  }
  /** See the samples in another way. @param {Partial<App["view"]>} change */
  see(change) {
    this.view = { ...this.view, ...change };
    this.looks.changed();
    this.refresh(Infinity);
  }
  /**
   * Go where a verdict says that the model fails: the axis comes into the first row where no row has it.
   * @param {import("./types.js").Stretch} place
   */
  go(place4) {
    const { axes } = this.view;
    if (axes.includes(place4.axis)) {
      this.linked.mark(place4);
    } else {
      this.then = () => this.linked.mark(place4);
      this.see({ axes: [place4.axis, ...axes.slice(1)] });
    }
  }
  /** Show the samples of a finding, over time among others. @param {string} capture @param {string} finding */
  async find(capture, finding2) {
    const { axes } = this.view;
    const chosen = this.state && await samplesOf(capture, finding2, this.state).catch((reason2) => this.failed(reason2));
    if (!chosen) return void 0;
    if (axes.includes("time")) return this.linked.find(chosen);
    this.then = () => this.linked.find(chosen);
    return this.see({ axes: [...axes.slice(0, -1), "time"] });
  }
  /**
   * Ask the server to do something; how long it takes until it is painted is noted under `deed`.
   * @param {string} verb
   * @param {object} [body]
   * @param {string} [deed]
   */
  async ask(verb, body = {}, deed) {
    if (deed) this.deed = { what: deed, start: performance.now() };
    try {
      const answer = await post(verb, body);
      this.say(answer.cut && this.state ? sentence(answer.cut, aboutOf(this.state)) : "");
      if (verb === "search") shown(byId("verdict"));
      if (answer.node && this.state?.node && deed !== "data") this.expect(answer.node, capturesOf(answer.node, this.state));
      if (answer.revision !== void 0) this.refresh(answer.revision);
      return answer;
    } catch (reason2) {
      this.failed(reason2);
      return null;
    }
  }
  /** Fetch the samples of a node that is about to be shown. @param {string} node @param {string[]} captures */
  expect(node, captures) {
    this.store.columns(node, captures, columnsOf(this.view)).catch(() => {
    });
  }
  /**
   * Show the newest state, unless what is shown is as new as `revision` and no job can have ended since.
   * @param {number} revision
   */
  async load(revision) {
    if (this.state && this.state.revision >= revision && !this.job) return;
    try {
      const state = await fetchState();
      if (state.node) this.expect(state.node, state.active);
      this.show(state);
      await this.draw(state);
    } catch (reason2) {
      this.failed(reason2);
    }
  }
  /** @param {State} state */
  show(state) {
    if (this.state?.node !== state.node) this.overlay.look(null);
    if (!this.state?.node && state.node !== null && state.looked) this.lookAgain(state.looked);
    if (!this.state && state.unread.length > 0) this.askOf?.(state.unread);
    this.state = state;
    known(state);
    const about2 = aboutOf(state);
    byId("welcome").toggleAttribute("hidden", state.node !== null);
    document.body.classList.toggle("empty", state.node === null);
    showVerdict(byId("verdict"), state, about2, {
      place: (place4) => this.go(place4),
      effect: (effect) => this.candidates.go(effect),
      add: (effect) => this.ask("add", { effect }, "add"),
      apart: (effects) => this.next.design(effects),
      every: () => this.ask("search", {}, "search"),
      ...{ error: () => shown(byId("ladder")), findings: () => shown(byId("findings")), laws: () => shown(byId("laws")) }
    });
    if (state.recording) this.live?.follow();
    showHidden(state);
    showLeft(state.left, {
      go: (session) => this.ask("continue", { session }, "data"),
      anew: async () => {
        await this.ask("anew");
        this.state = null;
        this.refresh(0);
      }
    });
    showCaptures(byId("captures"), state, {
      use: (captures) => this.ask("use", { captures }, "captures"),
      close: (capture) => this.ask("close", { capture }, "captures")
    });
    showFindings(byId("findings"), state, about2, {
      see: (capture, finding2) => this.find(capture, finding2),
      overrule: (capture, finding2, on) => this.ask("overrule", { capture, finding: finding2, on }, "data"),
      sharpen: (param) => void this.next.design([], param)
    });
    byId("open-together").hidden = state.captures.length === 0;
    showLadder(byId("ladder"), state);
    if (!comparable(state, this.beside)) this.beside = null;
    this.showBranches(state);
    this.params.show(state.params, state.together, about2);
    this.candidates.show(state, about2);
    this.laws.show(state);
    this.any.show(state.absent);
    this.next.show(state);
    this.showJob(state.job);
    const branch = state.branches.find(({ id }) => id === state.branch);
    enable("undo", (branch?.at ?? 0) > 0);
    enable("redo", branch !== void 0 && branch.at < branch.steps.length - 1);
    enable("snap", state.params.some(({ dragged }) => dragged));
    enable("new-branch", state.node !== null);
    enable("search", state.node !== null && !state.searched);
  }
  /** Look at a session as it was looked at. @param {import("./types.js").Looked} looked */
  lookAgain({ view, beside: beside2, brush }) {
    this.view = { ...this.view, ...view };
    for (
      const option of
      /** @type {const} */
      ["isolated", "band", "held"]
    ) {
      byId(option).checked = view[option];
    }
    this.beside = beside2;
    this.brushedThen = brush;
  }
  /** @param {State} state */
  async draw(state) {
    const { node, active } = state;
    const other = state.branches.find(({ id }) => id === this.beside);
    const otherNode = other?.steps[other.at]?.node;
    const wanted2 = JSON.stringify([node, active, this.view, otherNode, other?.name]);
    if (node === null) this.deed = null;
    if (node === null || wanted2 === this.drawn) return;
    const columns = await this.store.columns(node, active, columnsOf(this.view));
    const rest = otherNode ? await this.store.columns(otherNode, active, ["residual"]) : null;
    if (this.state && this.state.node !== node) return;
    this.drawn = wanted2;
    const { view } = this;
    const { what, start } = this.deed ?? { what: "data", start: performance.now() };
    this.deed = null;
    const fitted = !state.params.some(({ dragged }) => dragged);
    const name2 = state.branches.find(({ id }) => id === state.branch)?.name;
    const beside2 = other && rest ? { name: other.name, residual: rest.residual } : null;
    showLegend(state, columns, beside2?.name ?? null);
    const splits = fitted ? this.store.splits.get(node) : [];
    const noise = state.noise_floor;
    const of = String(state.captures.filter(({ id }) => active.includes(id)).map((one) => one.name));
    const data = { several: active.length > 1, of, below_hz: state.below_hz, columns, ...aboutOf(state), noise, fitted, name: name2, beside: beside2, splits };
    timed(what, () => {
      this.linked.show(data, view);
      if (this.brushedThen) this.linked.brushAgain(this.brushedThen);
      this.then?.();
      [this.brushedThen, this.then] = [null, null];
    }, start);
    if (splits) return;
    const found2 = await this.store.splitsOf(node).catch(() => []);
    if (this.state?.node === node) timed("bins", () => this.linked.lay(found2));
  }
  /** @param {State} state */
  showBranches(state) {
    showBranches(byId("branches"), state, this.beside, {
      choose: (branch) => this.ask("switch", { branch }, "switch"),
      beside: (branch) => {
        this.beside = branch;
        this.looks.changed();
        this.deed = { what: "beside", start: performance.now() };
        this.showBranches(state);
        this.refresh(Infinity);
      }
    });
  }
  /** Show what an effect is, moved as the capture moved. @param {import("./types.js").Effect} effect */
  about(effect) {
    const { state } = this;
    const { data } = this.linked;
    const node = state?.node;
    const added = async () => {
      if (!state || !node || !state.candidates.rows.some((row) => row.effect === effect.effect)) return null;
      const how = { verb: "signature", asked: { effect: effect.effect, own: "" } };
      return this.store.explained(node, state.active, `${effect.effect} alone`, how);
    };
    about(effect, data && node ? { data, at: this.linked.torques[0].marked, added } : null, state?.unit ?? "N m");
  }
  /** @param {Job | null} job */
  showJob(job) {
    this.job = job;
    showJob(job, this.state ? aboutOf(this.state) : null);
  }
  /** @param {Job} job */
  showRecording({ what, done }) {
    preparing(what.join(""));
    this.live?.phase(what.join(""));
    if (done !== null && !this.live?.following) this.live?.follow();
  }
  /** @param {string} words */
  say(words4) {
    byId("said").textContent = words4;
    byId("said").classList.remove("wrong");
  }
  /** @param {unknown} reason */
  failed(reason2) {
    this.deed = null;
    this.say(this.state ? ofLimits(wordsOf(reason2), aboutOf(this.state)) : wordsOf(reason2));
    byId("said").classList.add("wrong");
  }
};
var BRUSH_HINT = "Drag a rectangle in any plot: its samples light up in all of them.";
function enable(id, possible) {
  byId(id).disabled = !possible;
}
var app = new App();
Object.assign(globalThis, { knobcam: { times, app, download } });
app.start();
