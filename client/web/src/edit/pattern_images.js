import {fetch_page} from '../page_fetch.js';
import {ask} from '../server.js';
import {shown_pattern} from './sprite.js';

const most_side = 256;

/** What the sprites' patterns look like, and which one an animated sprite shows; each is fetched once. Calls `changed` when one has come. */
export class PatternImages {
  #texture;
  #changed;
  #names;
  #abort = new AbortController();
  /** The scene's animations by index. @type {{pattern?: number, steps?: number}[][]} */
  #animations = [];
  /** @type {Map<number, {canvas: HTMLCanvasElement | null, alpha: Uint8ClampedArray | null}>} */
  #images = new Map();
  /** Of a pattern, in texels. */
  side;

  /** @param {import('../texture.js').Texture} texture @param {string[]} names @param {number} side @param {() => void} changed */
  constructor(texture, names, side, changed) {
    this.#texture = texture;
    this.#names = names;
    this.side = side;
    this.#changed = changed;
    this.#load_animations();
  }

  get count() {
    return this.#names.length;
  }

  /** @param {number} pattern */
  name(pattern) {
    return this.#names[pattern] || `Pattern ${pattern + 1}`;
  }

  /** What a sprite shows at a step. @param {import('./sprite.js').Sprite} sprite @param {number} step */
  shown(sprite, step) {
    return shown_pattern(sprite, step, this.#animations);
  }

  /** Fetches all that a sprite shows at any step. @param {import('./sprite.js').Sprite} sprite */
  prepare(sprite) {
    for (const {pattern = 0} of this.#animations[sprite.more?.animation ?? -1] ?? []) this.image(pattern);
  }

  /** Null until it has come. @param {number} pattern */
  image(pattern) {
    const known = this.#images.get(pattern);
    if (!known) this.#load(pattern);
    return known?.canvas ?? null;
  }

  /** Whether a pattern has colour at a place, each 0 to 1 from the top left. @param {number} pattern @param {number} u @param {number} v */
  covers(pattern, u, v) {
    if (u < 0 || v < 0 || u >= 1 || v >= 1) return false;
    const known = this.#images.get(pattern);
    if (!known?.canvas || !known.alpha) return true;
    const side = known.canvas.width;
    return known.alpha[4 * (Math.floor(v * side) * side + Math.floor(u * side)) + 3] > 12;
  }

  close() {
    this.#abort.abort();
  }

  async #load_animations() {
    try {
      const reply = await ask(`/scenes/${encodeURIComponent(this.#texture.id)}/editables`, {signal: this.#abort.signal});
      if (!reply.ok) return;  // an older server: sprites show their own pattern
      const {sprite_animations = []} = await reply.json();
      this.#animations = sprite_animations.map((/** @type {any} */ {frames = []}) => frames);
    } catch {
      if (!this.#abort.signal.aborted) setTimeout(() => this.#load_animations(), 3000);
      return;
    }
    this.#changed();
  }

  /** @param {number} pattern */
  async #load(pattern) {
    const entry = {canvas: /** @type {HTMLCanvasElement | null} */ (null), alpha: /** @type {Uint8ClampedArray | null} */ (null)};
    this.#images.set(pattern, entry);
    try {
      const {image} = await fetch_page(`/scenes/${encodeURIComponent(this.#texture.id)}/patterns/${pattern}.png`, this.#abort.signal);
      const side = Math.min(this.side, most_side);  // it lies in the page's top-left corner
      const canvas = document.createElement('canvas');
      canvas.width = canvas.height = side;
      const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d', {willReadFrequently: true}));
      context.drawImage(image, 0, 0);
      image.close();
      entry.canvas = canvas;
      entry.alpha = context.getImageData(0, 0, side, side).data;
    } catch {
      if (!this.#abort.signal.aborted) setTimeout(() => this.#images.delete(pattern), 3000);  // then it is asked for again
      return;
    }
    this.#changed();
  }
}
