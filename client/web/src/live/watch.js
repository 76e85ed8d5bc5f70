import {page_side} from '../texture.js';

/** Pages around the view that are watched, too. */
const margin = 1;
/** Between two messages. */
const pause_milliseconds = 80;

/** A rectangle of pages of one level: [x0, x1) × [y0, y1). @typedef {{level: number, x0: number, y0: number, x1: number, y1: number}} Window */

/**
 * What is watched of a view: its pages, with some around it, at the level that is shown and at all above it.
 * @param {{x0: number, y0: number, x1: number, y1: number}} box Texels of level 0. @param {number} level @param {number} coarsest
 * @param {{windows: number, windowPages: number}} limits Of the server; 0: none is told.
 * @returns {Window[]}
 */
export function windows_around({x0, y0, x1, y1}, level, coarsest, {windows: most_windows, windowPages: most_pages}) {
  const windows = [];
  let pages = 0;
  for (let at = level; at <= coarsest; ++at) {
    const side = page_side * 2 ** at;
    const last = 2 ** (coarsest - at);
    const clamp = (/** @type {number} */ page) => Math.min(last, Math.max(0, page));
    const window = {
      level: at,
      x0: clamp(Math.floor(x0 / side) - margin), y0: clamp(Math.floor(y0 / side) - margin),
      x1: clamp(Math.ceil(x1 / side) + margin), y1: clamp(Math.ceil(y1 / side) + margin),
    };
    const held = (window.x1 - window.x0) * (window.y1 - window.y0);
    if (held <= 0) continue;
    pages += held;
    if ((most_windows && windows.length >= most_windows) || (most_pages && pages > most_pages)) break;
    windows.push(window);
  }
  return windows;
}

/** Tells the server what is in view, and the store what became of it. */
export class Watch {
  #stream;
  #store;
  #coarsest;
  /** @type {{box: any, level: number} | null} */
  #view = null;
  /** As it was sent; empty: nothing is watched. */
  #sent = '';
  #timer = 0;
  limits = {windows: 0, windowPages: 0};

  /** @param {import('./stream.js').Stream} stream @param {import('../page_store.js').PageStore} store @param {number} coarsest */
  constructor(stream, store, coarsest) {
    this.#stream = stream;
    this.#store = store;
    this.#coarsest = coarsest;
    stream.addEventListener('invalidation', (event) => this.#invalidate(/** @type {CustomEvent} */ (event).detail));
    stream.addEventListener('state', () => {
      if (!stream.open) this.#stop();
    });
  }

  close() {
    clearTimeout(this.#timer);
  }

  /** The view of a frame: texels of level 0, and the level that is shown. @param {{x0: number, y0: number, x1: number, y1: number}} box @param {number} level */
  look_at(box, level) {
    this.#view = {box, level};
    if (this.#timer || !this.#stream.open) return;
    this.#timer = setTimeout(() => {
      this.#timer = 0;
      this.#tell();
    }, this.#sent === '' ? 0 : pause_milliseconds);
  }

  /** A connection has begun. */
  begin() {
    this.#sent = '';
    this.#tell();
  }

  #tell() {
    if (!this.#view) return;
    const windows = windows_around(this.#view.box, this.#view.level, this.#coarsest, this.limits);
    const text = JSON.stringify(windows);
    if (text === this.#sent) return;
    const holds = (/** @type {import('../texture.js').PageKey} */ {level, x, y}) =>
      windows.some((window) => window.level === level && window.x0 <= x && x < window.x1 && window.y0 <= y && y < window.y1);
    const known = this.#store.watch(holds);
    const whole = (/** @type {Window} */ {level, x0, y0, x1, y1}) => ({level, x0: BigInt(x0), y0: BigInt(y0), x1: BigInt(x1), y1: BigInt(y1)});
    // With nothing here yet, what is asked for from now on holds all that was told up to now
    if (this.#stream.send('windows', {windows: windows.map(whole), seenRevision: BigInt(known ?? this.#store.told)})) this.#sent = text;
  }

  #stop() {
    if (this.#sent === '') return;
    this.#sent = '';
    this.#store.watch(() => false);
  }

  /** @param {any} invalidation */
  #invalidate({revision, stale}) {
    for (const {level, x, y, revision: own} of stale) {
      for (let i = 0; i < x.length; ++i) this.#store.invalidate({level, x: Number(x[i]), y: Number(y[i])}, Number(own[i]));
    }
    this.#store.told = Math.max(this.#store.told, Number(revision));
    this.#store.ask_for_stale();
  }
}
