/** The samples: fetched once, kept per capture and per node of the session. */

import { ask, early, fetchBytes } from "./api.js";

/**
 * Columns of samples, all captures one after the other.
 * @typedef {Record<string, Float32Array>} Columns
 */

const MOTION = new Set(["t", "theta", "omega", "alpha", "tau", "history", "masked"]); // the same for every model
const NODES_KEPT = 32; // undo and redo are answered from memory

/**
 * Read the server's binary answer: a line of JSON, then the columns as 32-bit floats.
 * @param {ArrayBuffer} buffer
 * @returns {Columns}
 */
export function decode(buffer) {
  return unpacked(buffer).columns;
}

/**
 * The same, with the whole line of JSON.
 * @param {ArrayBuffer} buffer
 * @returns {{head: import("./types.js").ColumnsHead, columns: Columns}}
 */
export function unpacked(buffer) {
  const end = new Uint8Array(buffer).indexOf(10);
  /** @type {import("./types.js").ColumnsHead} */
  const head = JSON.parse(new TextDecoder().decode(buffer.slice(0, end)));
  const start = Math.ceil((end + 1) / 4) * 4;
  /** @type {[string, Float32Array][]} */
  const columns = head.names.map((name, at) => [
    name,
    new Float32Array(buffer, start + 4 * at * head.n, head.n),
  ]);
  return { head, columns: Object.fromEntries(columns) };
}

export class Store {
  constructor() {
    /** @type {Map<string, Columns>} columns by capture, or by capture and node */
    this.kept = new Map();
    /** @type {Map<string, Promise<void>>} what is on its way */
    this.coming = new Map();
    /** @type {Map<string, import("./types.js").Split[]>} where the error lies, by node */
    this.splits = new Map();
  }

  /**
   * Return where the error of a node lies along every axis.
   * @param {string} node
   * @returns {Promise<import("./types.js").Split[]>}
   */
  async splitsOf(node) {
    const known = this.splits.get(node);
    if (known) return known;
    /** @type {import("./types.js").Splits} */
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
  async explained(node, captures, what, { verb, asked }, signal) {
    const name = `signature of ${what}`;
    const parts = await Promise.all(
      captures.map(async (capture) => {
        const key = `${capture} ${node}`;
        const known = this.kept.get(key)?.[name];
        if (known) return { [name]: known };
        const fetched = decode(await fetchBytes(`/api/${verb}`, { node, capture, ...asked }, signal));
        const column = Object.values(fetched)[0];
        this.keep(key, { [name]: column });
        return { [name]: column };
      }),
    );
    return joined(parts, [name])[name];
  }

  /** Forget what something would explain: it is another by now. @param {string} what */
  forget(what) {
    for (const columns of this.kept.values()) delete columns[`signature of ${what}`];
  }

  /** @param {string} node @param {string} capture @param {string[]} names */
  async ofCapture(node, capture, names) {
    const key = `${capture} ${node}`;
    const have = () => ({ ...this.kept.get(capture), ...this.kept.get(key) });
    while (this.coming.has(key)) await this.coming.get(key)?.catch(() => {}); // who asked for that is told
    const lacking = names.filter((name) => !(name in have()));
    if (lacking.length > 0) {
      const coming = this.fetch(node, capture, lacking).finally(() => this.coming.delete(key));
      this.coming.set(key, coming);
      await coming;
    }
    return have();
  }

  /** @param {string} node @param {string} capture @param {string[]} names */
  async fetch(node, capture, names) {
    const there = decode(await (early(node, capture) ?? fetchBytes("/api/arrays", { node, capture, names: names.join(",") })));
    const lacking = names.filter((name) => !(name in there));
    const entries = Object.entries(there);
    if (lacking.length > 0) entries.push(...Object.entries(decode(await fetchBytes("/api/arrays", { node, capture, names: lacking.join(",") }))));
    this.keep(capture, Object.fromEntries(entries.filter(([name]) => MOTION.has(name))));
    this.keep(`${capture} ${node}`, Object.fromEntries(entries.filter(([name]) => !MOTION.has(name))));
  }

  /** @param {string} key @param {Columns} columns */
  keep(key, columns) {
    const together = { ...this.kept.get(key), ...columns };
    this.kept.delete(key); // so that it is the youngest of the map
    this.kept.set(key, together);
    const nodes = [...this.kept.keys()].filter((one) => one.includes(" "));
    for (const old of nodes.slice(0, Math.max(0, nodes.length - NODES_KEPT))) this.kept.delete(old);
  }
}

/**
 * Put captures one after the other; the time of each goes on where the one before ends.
 * @param {Columns[]} parts
 * @param {string[]} names
 * @returns {Columns}
 */
export function joined(parts, names) {
  if (parts.length === 1) return Object.fromEntries(names.map((name) => [name, parts[0][name]]));
  /** @type {Columns} */
  const whole = {};
  for (const name of names) {
    whole[name] = new Float32Array(parts.reduce((total, part) => total + part[name].length, 0));
    let [at, elapsed] = [0, 0];
    for (const part of parts) {
      const column = part[name];
      if (name === "t") {
        const start = column[0] ?? 0;
        for (let i = 0; i < column.length; i++) whole[name][at + i] = column[i] - start + elapsed;
        elapsed += (column.at(-1) ?? start) - start;
      } else {
        whole[name].set(column, at);
      }
      at += column.length;
    }
  }
  return whole;
}
