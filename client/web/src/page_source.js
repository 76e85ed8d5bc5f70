import Projection from 'ol/proj/Projection.js';
import ImageTile from 'ol/source/ImageTile.js';
import TileGrid from 'ol/tilegrid/TileGrid.js';
import {getUid} from 'ol/util.js';

import {fetch_page} from './page_fetch.js';
import {Refused} from './server.js';
import {key_text, page_side} from './texture.js';

/** A page that nobody looks at for this long is no longer waited for. */
const patience_milliseconds = 200;

/** Pages of a texture that moves that are kept while they last. */
const most_lasting = 192;

/** OpenLayers' y grows upwards: texel (x, y) is at (x, −y). @param {import('./texture.js').Texture} texture */
export function texel_projection({side_texels}) {
  return new Projection({code: 'texels', units: 'pixels', extent: [0, -side_texels, side_texels, 0]});
}

/** Level ℓ has resolution 2^ℓ and is OpenLayers' z = n − ℓ. A device pixel, not a CSS pixel, asks for a texel. */
class PageGrid extends TileGrid {
  /** @param {number} resolution @param {any} direction */
  getZForResolution(resolution, direction) {
    return super.getZForResolution(resolution / (window.devicePixelRatio || 1), direction);
  }
}

/**
 * The pages of one texture, for OpenLayers' tile layer. A page that leaves the view before it came is cancelled, and
 * asked for again when it is back in view; so are pages that found the server silent, once it answers again.
 */
export class PageSource extends ImageTile {
  #texture;
  #ledger;
  /** @type {{format: string, accuracy: string, channels: string, slice: number, step: number, smooth: boolean}} */
  #options;
  /** @type {Map<string, {abort: AbortController, unwanted_since: number}>} By tile key. */
  #in_flight = new Map();
  /** @type {Map<string, {tile: any, ask_again: boolean}>} Tiles that were cancelled or failed, by tile key. */
  #unanswered = new Map();
  /** @type {Map<string, {image: ImageBitmap, from: number, until: number, still: string}>} Of a texture that moves: the last
   * of each page, oldest first, and in which steps it is the same. */
  #lasting = new Map();

  /**
   * @param {import('./texture.js').Texture} texture
   * @param {import('./page_ledger.js').PageLedger} ledger
   * @param {{format: string, accuracy: string, channels: string, slice: number, step: number, smooth: boolean}} options
   * @param {() => void} on_stale The server no longer knows the texture in the revision asked for.
   */
  constructor(texture, ledger, options, on_stale) {
    const n = texture.coarsest_level;
    super({
      projection: texel_projection(texture),
      tileGrid: new PageGrid({
        extent: [0, -texture.side_texels, texture.side_texels, 0],
        origin: [0, 0],
        tileSize: page_side,
        resolutions: Array.from({length: n + 1}, (_, z) => 2 ** (n - z)),
      }),
      wrapX: false,
      transition: 160,
      loader: (z, x, y, {signal}) => this.#load({level: n - z, x, y}, signal),
    });
    this.#texture = texture;
    this.#ledger = ledger;
    this.#options = {...options};
    this.on_stale = on_stale;
    this.setKey(this.#key());
    this.on('tileloaderror', (/** @type {any} */ {tile}) => {
      this.#unanswered.set(tile.getKey(), {tile, ask_again: tile.getError()?.name === 'AbortError'});
    });
  }

  /** Crisp: OpenLayers takes the nearest texel instead of blending neighbours. */
  getInterpolate() {
    return this.#options?.smooth ?? true;
  }

  /** Whether texels larger than a pixel are blended; nothing is asked for anew. @param {boolean} smooth */
  set_smooth(smooth) {
    this.#options.smooth = smooth;
  }

  /** From now on pages are asked for with these; those on screen stay until the new ones are there. */
  set_request(/** @type {{format: string, accuracy: string, channels: string, slice: number}} */ {format, accuracy, channels, slice}) {
    Object.assign(this.#options, {format, accuracy, channels, slice});
    this.#renew();
  }

  /** Pages that are another at this step are asked for; the others stay. @param {number} step */
  set_step(step) {
    this.#options.step = step;
    this.transition = 0;  // No fading from frame to frame
    this.#unanswered.clear();
    this.setKey(this.#key());
  }

  /** The server has a newer revision of the texture. @param {import('./texture.js').Texture} texture */
  set_texture(texture) {
    if (texture.page_template === this.#texture.page_template) return false;
    this.#texture = texture;
    this.#renew();
    return true;
  }

  /** Pages that failed or found no server are asked for again, from the next frame that wants them on. */
  retry() {
    for (const page of this.#unanswered.values()) page.ask_again = true;
  }

  /** Call after each frame: cancels what has left the view, and takes up again what has come back. */
  keep_to(/** @type {any} */ frame_state) {
    const wanted = frame_state.wantedTiles[getUid(this)] ?? {};
    const now = performance.now();
    for (const [key, request] of this.#in_flight) {
      if (key in wanted) request.unwanted_since = Infinity;
      else if (request.unwanted_since === Infinity) request.unwanted_since = now;
      else if (now - request.unwanted_since > patience_milliseconds) request.abort.abort();
    }
    for (const [key, {tile, ask_again}] of this.#unanswered) {
      if (key in wanted && ask_again) {
        this.#unanswered.delete(key);
        tile.load();
      }
    }
  }

  #key() {
    return this.#texture.animated ? `${this.#still_key()} ${this.#options.step}` : this.#still_key();
  }

  /** All that a page depends on but the step. */
  #still_key() {
    const {format, accuracy, channels, slice} = this.#options;
    return [this.#texture.page_template, format, accuracy, channels, slice].join(' ');
  }

  #renew() {
    this.#unanswered.clear();
    this.#ledger.clear();
    this.setKey(this.#key());
  }

  /** @param {import('./texture.js').PageKey} page @param {AbortSignal} disposed */
  async #load(page, disposed) {
    const source_key = this.getKey();
    const tile_key = `${source_key}/${[this.#texture.coarsest_level - page.level, page.x, page.y]}`;
    const abort = new AbortController();
    disposed.addEventListener('abort', () => {
      abort.abort();
      this.#unanswered.delete(tile_key);
    });
    const kept = this.#lasting.get(key_text(page));
    const {step} = this.#options;
    if (kept && kept.still === this.#still_key() && kept.from <= step && step < kept.until) return kept.image;
    const still = this.#still_key();
    const url = this.#texture.page_url(page, this.#options);
    const note = (/** @type {import('./page_ledger.js').PageRecord} */ record) => {
      if (source_key === this.getKey()) this.#ledger.note(page, record);
    };
    this.#in_flight.set(tile_key, {abort, unwanted_since: Infinity});
    note({state: 'loading', url});
    try {
      const {image, facts} = await fetch_page(url, abort.signal);
      note({state: 'ready', url, ...facts});
      if (this.#texture.animated) this.#keep(page, {image, from: facts.valid_from ?? step, until: facts.valid_until ?? step + 1, still});
      return image;
    } catch (error) {
      if (abort.signal.aborted) {
        if (source_key === this.getKey()) this.#ledger.forget(page);
      } else {
        note({state: 'failed', url, problem: /** @type {Error} */ (error).message});
        if (error instanceof Refused && (error.status === 404 || error.status === 410)) this.on_stale();
      }
      throw error;
    } finally {
      this.#in_flight.delete(tile_key);
    }
  }

  /** @param {import('./texture.js').PageKey} page @param {any} lasting */
  #keep(page, lasting) {
    const key = key_text(page);
    this.#lasting.delete(key);
    this.#lasting.set(key, lasting);
    if (this.#lasting.size > most_lasting) this.#lasting.delete(this.#lasting.keys().next().value);
  }
}
