import {usual_channels} from './channels.js';

/** A page is 256×256 texels of one level. */
export const page_side = 256;

/**
 * A page key: MIP level (0 is the finest), and a cell of that level's grid, x rightwards and y downwards.
 * @typedef {{level: number, x: number, y: number}} PageKey
 */

/** What pages are asked for with. @typedef {{format: string, accuracy: string, channels?: string, slice?: number, step?: number}} PageOptions */

/** "level · x, y": unlike the z/x/y of addresses, where z counts from the coarsest level. @param {PageKey} page */
export const key_text = ({level, x, y}) => `${level} · ${x}, ${y}`;

/** Names of the kinds of texture, for people. */
const kind_names = {
  constant: 'Constant colour',
  checker: 'Checker',
  content_exchange: 'Content exchange',
  interchange: 'Interchangeable patches',
  wang: 'Corner-coloured tiles',
  pattern: 'Pattern blocks',
};

/** @param {string} kind As the server names it. */
export const kind_name = (kind) => kind_names[kind] ?? (kind.charAt(0).toUpperCase() + kind.slice(1)).replaceAll('_', ' ');

/** What the extent is worth as plain RGBA, every level-0 texel stored. @param {number} n log2 of the pages on a side */
export const uncompressed_bytes = (n) => (page_side * 2 ** n) ** 2 * 4;

/** One virtual texture, as its TileJSON describes it. Positions are texels of level 0, from the top-left corner. */
export class Texture {
  /** @param {any} tilejson */
  constructor(tilejson) {
    const info = tilejson.tessera ?? {};
    this.id = info.id;
    this.title = tilejson.name || info.id;
    this.attribution = tilejson.attribution ?? '';
    this.description = tilejson.description ?? '';
    this.kind = info.texture ?? '';
    /** n: level n is one page. Protobuf's JSON leaves out zeros. */
    this.coarsest_level = info.extent_log2_pages ?? tilejson.maxzoom ?? 0;
    this.side_texels = page_side * 2 ** this.coarsest_level;
    /** @type {string[]} */
    this.formats = info.formats ?? ['png'];
    /** @type {string[]} What pages can show of the surface. */
    this.channels = info.channels?.length ? info.channels : [usual_channels];
    /** After how many slices of a third dimension the texture repeats: 1 if it is flat, 0 if it never does. */
    this.slices = Number(info.slices ?? 1);
    /** Whether pages depend on the step of the clock, and how players go through the steps. */
    this.animated = info.animated ?? false;
    this.steps_per_second = info.steps_per_second || 10;
    this.loop_steps = Number(info.loop_steps ?? 0);
    /** Accepted edits, when this was told. */
    this.revision = Number(info.revision ?? 0);
    /** Templates of a page's path, with {z}, {x}, {y} and no extension: as it is now, and at a revision, for ever the same. */
    this.template_now = path_of(tilejson.tiles?.[0] ?? `/scenes/${info.id}/{z}/{x}/{y}.png`);
    this.template_at = info.page_url || this.template_now;
    this.tells_fingerprint = Boolean(info.fingerprint);
    /** Path of the live stream; empty where there is none. */
    this.stream = info.stream ?? '';
    /** What a visitor sees first, where the scene says it. @type {import('./address.js').View | null} */
    this.view = opening_view(info.view);
    /** Another one when scene file or assets are. */
    this.fingerprint = info.fingerprint || this.template_at.replace(/\/r\d+-/, '/');
  }

  /**
   * The path of a page that no edit touches any more: `revision` is its own.
   * @param {PageKey} page @param {PageOptions} options @param {number} [revision] @returns {string}
   */
  page_url(page, options, revision = this.revision) {
    return this.#url(this.template_at.replace(/\/r\d+-/, `/r${revision}-`), page, options);
  }

  /** The path of a page as it is when the server answers. @param {PageKey} page @param {PageOptions} options @returns {string} */
  page_url_now(page, options) {
    return this.#url(this.template_now, page, options);
  }

  /** The path of a page without some sprites. @param {PageKey} page @param {PageOptions} options @param {bigint[]} sprites @returns {string} */
  page_url_without(page, options, sprites) {
    return this.#url(this.template_now.replace('/{z}', `/without-${sprites.join(',')}/{z}`), page, options);
  }

  /** The server's own defaults stay unsaid. @param {string} template @param {PageKey} page @param {PageOptions} options */
  #url(template, {level, x, y}, {format, accuracy, channels = usual_channels, slice = 0, step = 0}) {
    const path = template
      .replace('{z}', String(this.z_of(level)))
      .replace('{x}', String(x))
      .replace('{y}', String(y));
    // In the order in which the server writes them: another one would be redirected
    const asked = [
      accuracy !== 'high' && `accuracy=${accuracy}`,
      channels !== usual_channels && `channels=${channels}`,
      slice !== 0 && `slice=${slice}`,
      this.animated && step !== 0 && `step=${step}`,
    ];
    const query = asked.filter(Boolean).join('&');
    return `${path}.${format}${query && `?${query}`}`;
  }

  /** The zoom of a level in addresses: 0 is the coarsest. @param {number} level */
  z_of(level) {
    return this.coarsest_level - level;
  }

  /** @param {{x: number, y: number}} texel */
  contains({x, y}) {
    return x >= 0 && y >= 0 && x < this.side_texels && y < this.side_texels;
  }

  /** The page of `level` that holds a texel of level 0. @param {{x: number, y: number}} texel @param {number} level */
  page_at({x, y}, level) {
    const side = page_side * 2 ** level;
    return {level, x: Math.floor(x / side), y: Math.floor(y / side)};
  }
}

/** @param {any} view An OpeningView of proto/opening_view.proto. @returns {import('./address.js').View | null} */
export const opening_view = (view) => (view ? {level: Number(view.level), x: Number(view.x), y: Number(view.y)} : null);

/** "http://host/scenes/a/{z}/{x}/{y}.png" -> "/scenes/a/{z}/{x}/{y}". @param {string} template */
function path_of(template) {
  return template.replace(/^[a-z]+:\/\/[^/]+/i, '').replace(/\.[a-z]+$/i, '');
}
