import {fetch_page} from '../page_fetch.js';
import {key_text} from '../texture.js';
import {box_of_page, boxes_meet, way_of} from './sprite.js';

/** The server takes so many at a time. */
export const most_lifted = 64;
/** After this a page that does not come is no longer waited for. */
const longest_melt = 5000;

/**
 * Sprites in the hand, from when they are taken until the pages show them where they were put: meanwhile pages without
 * them are shown where they were, and they are drawn over the map where they are.
 */
export class Carry {
  #texture;
  #store;
  #options;
  #side;
  #changed;
  #abort = new AbortController();
  /** @type {Map<string, {image: ImageBitmap | null, revision: number, asked: boolean}>} Pages without the lifted sprites. */
  #pages = new Map();
  #lifted;
  #boxes;
  /** As they are drawn now. @type {import('./sprite.js').Sprite[]} */
  sprites;
  /** Of the edit that put them down; null until it is made. @type {number | null} */
  revision = null;
  /** @type {{x0: number, y0: number, x1: number, y1: number}[]} What that edit changed. */
  #dirty = [];
  #put_down_at = 0;

  /**
   * @param {{texture: import('../texture.js').Texture, store: import('../page_store.js').PageStore, options: () => any, side: number, changed: () => void}} map
   * @param {import('./sprite.js').Sprite[]} taken Where they were; none for those that are new.
   * @param {import('./sprite.js').Sprite[]} sprites Where they are now; none for those that are removed.
   * @param {bigint[]} [others] In other hands' of this page: they are lifted, too.
   */
  constructor({texture, store, options, side, changed}, taken, sprites, others = []) {
    this.#texture = texture;
    this.#store = store;
    this.#options = options;
    this.#side = side;
    this.#changed = changed;
    this.#boxes = taken.map((sprite) => way_of(sprite, side));
    this.#lifted = [...new Set([...taken.map(({id}) => id), ...others])].slice(0, most_lifted);
    this.sprites = sprites;
  }

  get ids() {
    return this.#lifted;
  }

  /** What is shown of a page instead of the store's picture; null: nothing else. @param {import('../texture.js').PageKey} page */
  instead(page) {
    const box = box_of_page(page);
    if (!this.#boxes.some((other) => boxes_meet(box, other)) || this.#shows(page)) return null;
    const key = key_text(page);
    const shown = this.#store.find(page)?.shown?.revision ?? 0;
    const lifted = this.#pages.get(key) ?? {image: null, revision: -1, asked: false};
    this.#pages.set(key, lifted);
    if (!lifted.asked && lifted.revision < shown) this.#ask(page, lifted, shown);
    return lifted.image;
  }

  /** The edit is made. @param {number} revision @param {{x0: number, y0: number, x1: number, y1: number}[]} dirty */
  put_down(revision, dirty) {
    this.revision = revision;
    this.#dirty = dirty;
    this.#put_down_at = performance.now();
    setTimeout(this.#changed, longest_melt + 50);
  }

  /** Whether a page still has to be drawn over. @param {import('../texture.js').PageKey} page */
  awaits(page) {
    if (this.revision === null) return true;
    const box = box_of_page(page);
    return this.#dirty.some((other) => boxes_meet(box, other)) && !this.#shows(page);
  }

  get is_late() {
    return this.revision !== null && performance.now() - this.#put_down_at > longest_melt;
  }

  close() {
    this.#abort.abort();
    for (const {image} of this.#pages.values()) image?.close();
    this.#pages.clear();
  }

  /** Whether the store's picture has the edit in it. @param {import('../texture.js').PageKey} page */
  #shows(page) {
    return this.revision !== null && (this.#store.find(page)?.shown?.revision ?? -1) >= this.revision;
  }

  /** @param {import('../texture.js').PageKey} page @param {{image: ImageBitmap | null, revision: number, asked: boolean}} lifted @param {number} shown */
  async #ask(page, lifted, shown) {
    lifted.asked = true;
    try {
      const {image, facts} = await fetch_page(this.#texture.page_url_without(page, this.#options(), this.#lifted), this.#abort.signal);
      if (this.#abort.signal.aborted) return image.close();
      lifted.image?.close();
      lifted.image = image;
      lifted.revision = Math.max(shown, facts.revision ?? 0);
    } catch {
      lifted.revision = shown;  // then the sprite is seen where it was, too, until it is put down
    }
    lifted.asked = false;
    this.#changed();
  }
}
