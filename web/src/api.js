/** The server on this machine: requests that carry the token, and its events. */

/** @typedef {import("./types.js").State} State */

/** What the server says is wrong; `columns` of a file that it could not take for a capture, `guess` what they may be, `fault` of a rig, `enough` the
 * limit with which there would be a motion. */
export class Refusal extends Error {
  /** @param {string} words @param {import("./types.js").Why} [more] */
  constructor(words, { columns, guess, fault, enough } = {}) {
    super(words);
    this.columns = columns ?? null;
    this.guess = guess ?? {};
    this.fault = fault ?? null;
    this.enough = enough ?? null;
  }
}

/**
 * What went wrong, in words.
 * @param {unknown} reason
 */
export function wordsOf(reason) {
  return reason instanceof Error ? reason.message : String(reason);
}

const token = new URLSearchParams(location.search).get("token") ?? "";

/**
 * @param {string} path
 * @param {RequestInit} [options]
 * @returns {Promise<Response>} one that is well; an Error with the server's own words otherwise
 */
async function request(path, options = {}) {
  const headers = { ...options.headers, "x-knobcam-token": token };
  let answer;
  try {
    answer = await fetch(path, { ...options, headers });
  } catch (reason) {
    if (options.signal?.aborted) throw reason;
    throw new Error("the workbench does not answer; is its command still running?");
  }
  if (answer.ok) return answer;
  /** @type {Partial<import("./types.js").Refused>} */
  const said = await answer.json().catch(() => ({}));
  throw new Refusal(said.error ?? `the workbench answered ${answer.status}`, said);
}

/**
 * Ask for a document.
 * @param {string} what
 * @param {Record<string, string>} [query]
 */
export async function ask(what, query = {}) {
  return (await request(`/api/${what}?${new URLSearchParams(query)}`)).json();
}

/** @returns {Promise<State>} the newest one; the first came with the page */
export async function fetchState() {
  const first = document.getElementById("first-state");
  first?.remove();
  return first ? JSON.parse(first.textContent ?? "") : ask("state");
}

/**
 * @param {string} path
 * @param {Record<string, string>} query
 * @param {AbortSignal} [signal]
 */
export async function fetchBytes(path, query, signal) {
  const answer = await request(`${path}?${new URLSearchParams(query)}`, { signal });
  return answer.arrayBuffer();
}

/**
 * Samples that the browser asked for while it read the page; null where it did not.
 * @param {string} node
 * @param {string} capture
 * @returns {Promise<ArrayBuffer> | null}
 */
export function early(node, capture) {
  if (!("document" in globalThis)) return null;
  const links = /** @type {NodeListOf<HTMLLinkElement>} */ (document.querySelectorAll("link[rel=preload]"));
  const link = [...links].find(({ href }) => {
    const asked = new URL(href).searchParams;
    return asked.get("node") === node && asked.get("capture") === capture;
  });
  link?.remove();
  return link ? fetch(link.href).then((answer) => (answer.ok ? answer.arrayBuffer() : Promise.reject(new Refusal(`the workbench answered ${answer.status}`)))) : null;
}

/**
 * The picture of where an effect shows.
 * @param {string} effect
 */
export async function fetchPicture(effect) {
  return (await request(`/api/picture?${new URLSearchParams({ effect })}`)).blob();
}

/**
 * Ask for something to be done.
 * @param {string} verb of the API: add, undo, params...
 * @param {object} [body]
 * @returns {Promise<import("./types.js").Answer>}
 */
export async function post(verb, body = {}) {
  const headers = { "content-type": "application/json" };
  const answer = await request(`/api/${verb}`, { method: "POST", headers, body: JSON.stringify(body) });
  return answer.json();
}

/**
 * Hand a file over.
 * @param {File} file
 * @param {Record<string, string>} options of the import: column map and units
 */
export async function upload(file, options = {}) {
  const headers = { "content-type": "application/octet-stream", "x-filename": encodeURIComponent(file.name) };
  const query = new URLSearchParams(options);
  return (await request(`/api/upload?${query}`, { method: "POST", headers, body: file })).json();
}

/**
 * Fetch what is to be saved, and the name that it should have.
 * @param {string} what model, report, figures or script
 */
export async function download(what) {
  const answer = await request(`/api/download?${new URLSearchParams({ what })}`);
  const named = /filename="?([^";]+)"?/.exec(answer.headers.get("content-disposition") ?? "");
  return { name: named ? named[1] : `knobcam-${what}`, blob: await answer.blob() };
}

/**
 * Listen to the server.
 * @param {{state: (revision: number) => void, progress: (job: import("./types.js").Job) => void,
 *   connected: (well: boolean) => void}} heard
 */
export function listen(heard) {
  const source = new EventSource(`/api/events?${new URLSearchParams({ token })}`);
  source.addEventListener("state", (event) => heard.state(JSON.parse(event.data).revision));
  source.addEventListener("progress", (event) => {
    heard.progress(JSON.parse(event.data));
  });
  source.addEventListener("open", () => heard.connected(true));
  source.addEventListener("error", () => heard.connected(false));
}
