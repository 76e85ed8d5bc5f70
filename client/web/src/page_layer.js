import Layer from 'ol/layer/Layer.js';
import Projection from 'ol/proj/Projection.js';

import {page_side} from './texture.js';

const fade_milliseconds = 160;
const calm = matchMedia('(prefers-reduced-motion: reduce)');

/** OpenLayers' y grows upwards: texel (x, y) is at (x, −y). @param {import('./texture.js').Texture} texture */
export function texel_projection({side_texels}) {
  return new Projection({code: 'texels', units: 'pixels', extent: [0, -side_texels, side_texels, 0]});
}

/**
 * The level whose texels are nearest in size to device pixels.
 * @param {number} resolution Level-0 texels under one CSS pixel. @param {number} coarsest
 */
export function level_for(resolution, coarsest) {
  const texels = resolution / (window.devicePixelRatio || 1);
  const level = Math.floor(Math.log2(texels));
  return Math.min(coarsest, Math.max(0, texels > 1.5 * 2 ** level ? level + 1 : level));
}

/** A canvas that is as large as the view, and where a texel lies on it. */
export class ViewCanvas {
  element = document.createElement('canvas');
  context = /** @type {CanvasRenderingContext2D} */ (this.element.getContext('2d'));

  /** @param {string} name */
  constructor(name) {
    this.element.className = name;
  }

  /** Clean, for a frame of OpenLayers. @param {any} frame */
  begin({pixelRatio: ratio, size, viewState: {resolution, center}}) {
    const [width, height] = [Math.round(size[0] * ratio), Math.round(size[1] * ratio)];
    if (this.element.width !== width || this.element.height !== height) Object.assign(this.element, {width, height});
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.clearRect(0, 0, width, height);
    this.ratio = ratio;
    this.width = width;
    this.height = height;
    /** Device pixels of a texel. */
    this.scale = ratio / resolution;
    this.center = {x: center[0], y: -center[1]};
    // Texels that are in view
    const [half_x, half_y] = [(size[0] / 2) * resolution, (size[1] / 2) * resolution];
    this.box = {x0: this.center.x - half_x, y0: this.center.y - half_y, x1: this.center.x + half_x, y1: this.center.y + half_y};
  }

  /** Device pixels of a texel: relative to the middle of the view, so that nothing is lost at texel 2^37. @param {number} x */
  left(x) {
    return this.width / 2 + (x - this.center.x) * this.scale;
  }

  /** @param {number} y */
  top(y) {
    return this.height / 2 + (y - this.center.y) * this.scale;
  }

  /** A page's place, on whole device pixels: neighbours share their edges. @param {import('./texture.js').PageKey} page */
  place_of({level, x, y}) {
    const side = page_side * 2 ** level;
    const [left, top] = [Math.round(this.left(x * side)), Math.round(this.top(y * side))];
    return {left, top, width: Math.round(this.left((x + 1) * side)) - left, height: Math.round(this.top((y + 1) * side)) - top};
  }
}

/**
 * The pages of a level that meet a box of texels, those nearest to its middle first.
 * @param {{x0: number, y0: number, x1: number, y1: number}} box @param {number} level @param {number} coarsest
 * @returns {import('./texture.js').PageKey[]}
 */
export function pages_meeting({x0, y0, x1, y1}, level, coarsest) {
  const side = page_side * 2 ** level;
  const last = 2 ** (coarsest - level) - 1;
  const pages = [];
  for (let y = Math.max(0, Math.floor(y0 / side)); y <= Math.min(last, Math.ceil(y1 / side) - 1); ++y) {
    for (let x = Math.max(0, Math.floor(x0 / side)); x <= Math.min(last, Math.ceil(x1 / side) - 1); ++x) pages.push({level, x, y});
  }
  const [middle_x, middle_y] = [(x0 + x1) / 2 / side - 0.5, (y0 + y1) / 2 / side - 0.5];
  const distance = (/** @type {any} */ {x, y}) => (x - middle_x) ** 2 + (y - middle_y) ** 2;
  return pages.sort((a, b) => distance(a) - distance(b));
}

/** Draws the pages in view: what is not here yet is drawn from the finest page above it, or from those below it. */
export class PageLayer extends Layer {
  #store;
  #coarsest;
  #canvas = new ViewCanvas('pages');
  smooth = false;
  /** Whether the last frame had pages in view and no picture for any of them, not even one of another level. */
  bare = false;
  /** Another picture of a page, for a while. @type {(page: import('./texture.js').PageKey) => CanvasImageSource | null} */
  instead = () => null;

  /** @param {import('./texture.js').Texture} texture @param {import('./page_store.js').PageStore} store */
  constructor(texture, store) {
    super({properties: {name: 'pages'}});
    this.#store = store;
    this.#coarsest = texture.coarsest_level;
    store.addEventListener('change', () => this.changed());
  }

  getSourceState() {
    return 'ready';
  }

  /** @param {any} frame @returns {HTMLElement} */
  render(frame) {
    const canvas = this.#canvas;
    canvas.begin(frame);
    const level = level_for(frame.viewState.resolution, this.#coarsest);
    const pages = pages_meeting(canvas.box, level, this.#coarsest);
    const above = level < this.#coarsest ? pages_meeting(canvas.box, level + 1, this.#coarsest) : [];
    this.#store.want(pages, above);
    const now = performance.now();
    this.bare = pages.length > 0;
    for (const page of pages) {
      if (this.#draw(page, now)) frame.animate = true;
    }
    return canvas.element;
  }

  /** True while it fades in. @param {import('./texture.js').PageKey} page @param {number} now */
  #draw(page, now) {
    const entry = this.#store.find(page);
    const image = this.instead(page) ?? entry?.shown?.image;
    const opacity = !image ? 0 : calm.matches ? 1 : Math.min(1, (now - (entry?.born ?? 0)) / fade_milliseconds);
    const place = this.#canvas.place_of(page);
    const {context} = this.#canvas;
    if (opacity < 1) this.#draw_stand_in(page, place);
    if (!image) return false;
    context.globalAlpha = opacity;
    this.#paint(image, [0, 0, page_side, page_side], place);
    context.globalAlpha = 1;
    return opacity < 1;
  }

  /** @param {import('./texture.js').PageKey} page @param {{left: number, top: number, width: number, height: number}} place */
  #draw_stand_in(page, place) {
    for (let up = 1; page.level + up <= this.#coarsest; ++up) {
      const ancestor = {level: page.level + up, x: Math.floor(page.x / 2 ** up), y: Math.floor(page.y / 2 ** up)};
      const image = this.#store.find(ancestor)?.shown?.image;
      if (!image) continue;
      const side = page_side / 2 ** up;
      this.#paint(image, [(page.x % 2 ** up) * side, (page.y % 2 ** up) * side, side, side], place);
      break;
    }
    if (page.level === 0) return;
    for (const [x, y] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
      const child = {level: page.level - 1, x: page.x * 2 + x, y: page.y * 2 + y};
      const image = this.#store.find(child)?.shown?.image;
      if (image) this.#paint(image, [0, 0, page_side, page_side], this.#canvas.place_of(child));
    }
  }

  /** @param {CanvasImageSource} image @param {number[]} part Of the image. @param {{left: number, top: number, width: number, height: number}} place */
  #paint(image, [x, y, width, height], place) {
    const {context} = this.#canvas;
    this.bare = false;
    context.imageSmoothingEnabled = this.smooth || place.width < width;
    context.drawImage(image, x, y, width, height, place.left, place.top, place.width, place.height);
  }
}
