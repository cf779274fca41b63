/** Sessions that were left and can go on, and how the page looked at one. */

import { post } from "./api.js";
import { byId, make } from "./dom.js";

/** @typedef {import("./types.js").Looked} Looked */
/** @typedef {import("./types.js").Left} Left */

const REST_MS = 300; // a brush that is still dragged is not kept

/**
 * Offer the sessions that were left.
 * @param {Left[]} left
 * @param {{go: (session: string) => void, anew: () => void}} deeds
 */
export function showLeft(left, { go, anew }) {
  byId("left-behind").hidden = left.length === 0;
  const rows = left.map((one) =>
    one.wrong === null
      ? make(
          "li",
          { title: one.captures.join("\n") },
          make("button", { type: "button", class: "main", on: { click: () => go(one.id) } }, "Continue"),
          make("span", {}, make("strong", { text: called(one) }), " ", make("span", { class: "soft", text: words(one) })),
        )
      : make("li", { class: "wrong", text: one.wrong }),
  );
  const other = make("button", { type: "button", on: { click: anew } }, "Start anew");
  byId("left-rows").replaceChildren(...rows, make("li", {}, other));
}

const FEW = 2; // captures that are called by their names

/** Of which captures a session is: a few by their names. @param {Left} left */
export function called({ captures }) {
  const more = captures.length - FEW;
  return more > 1 ? `${captures.slice(0, FEW).join(", ")} and ${more} more` : captures.join(", ");
}

/** What was done there, and when. @param {Left} left */
export function words({ steps, ended, when }) {
  const at = when === null ? "" : ` ${new Date(1000 * when).toLocaleString([], { dateStyle: "medium", timeStyle: "short" })}`;
  return `${steps === 1 ? "one fit" : `${steps} fits`}, ${ended ? "ended" : "broken off"}${at}`;
}

/** Tells the server how the page looks, some time after the last change, so that it looks so again. */
export class Looking {
  /** @param {() => Looked} now */
  constructor(now) {
    this.now = now;
    this.kept = "";
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
  }

  changed() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      const now = this.now();
      if (JSON.stringify(now) === this.kept) return;
      this.kept = JSON.stringify(now);
      post("look", now).catch(() => {}); // what is only seen is no reason to complain
    }, REST_MS);
  }
}
