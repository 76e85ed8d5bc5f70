import Layer from 'ol/layer/Layer.js';

import {key_text, page_side} from './texture.js';

const state_colours = {
  loading: 'rgba(233, 184, 114, 0.95)',
  failed: 'rgba(226, 102, 84, 0.95)',
  ready: 'rgba(255, 255, 255, 0.55)',
  cached: 'rgba(255, 255, 255, 0.55)',
};

/** Draws the texture's border, and when asked the borders, keys and states of the pages in view. */
export class PageGridLayer extends Layer {
  #texture;
  #ledger;
  #canvas = document.createElement('canvas');
  shown = false;

  /**
   * @param {import('./texture.js').Texture} texture
   * @param {import('./page_ledger.js').PageLedger} ledger
   * @param {(resolution: number) => number} level_shown
   * @param {() => number} covered_above CSS pixels at the top of the view that the bar covers.
   */
  constructor(texture, ledger, level_shown, covered_above) {
    super({properties: {name: 'page grid'}});
    this.#texture = texture;
    this.#ledger = ledger;
    this.level_shown = level_shown;
    this.covered_above = covered_above;
    this.#canvas.className = 'page-grid';
  }

  getSourceState() {
    return 'ready';
  }

  /** @param {any} frame @returns {HTMLElement} */
  render(frame) {
    const {pixelRatio: ratio, size, viewState} = frame;
    const [width, height] = [Math.round(size[0] * ratio), Math.round(size[1] * ratio)];
    if (this.#canvas.width !== width || this.#canvas.height !== height) {
      this.#canvas.width = width;
      this.#canvas.height = height;
    }
    const context = /** @type {CanvasRenderingContext2D} */ (this.#canvas.getContext('2d'));
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);

    // Device pixels of a texel: relative to the middle of the view, so that nothing is lost at texel 2^37
    const scale = ratio / viewState.resolution;
    const place = (/** @type {number} */ x, /** @type {number} */ y) => [
      Math.round(width / 2 + (x - viewState.center[0]) * scale),
      Math.round(height / 2 + (y + viewState.center[1]) * scale),
    ];
    this.#draw_border(context, place, ratio);
    if (this.shown) this.#draw_pages(context, place, ratio, frame);
    return this.#canvas;
  }

  /** @param {CanvasRenderingContext2D} context @param {(x: number, y: number) => number[]} place @param {number} ratio */
  #draw_border(context, place, ratio) {
    const clamp = (/** @type {number} */ value) => Math.min(Math.max(value, -1e4), 1e5);
    const [left, top] = place(0, 0).map(clamp);
    const [right, bottom] = place(this.#texture.side_texels, this.#texture.side_texels).map(clamp);
    context.lineWidth = ratio;
    context.strokeStyle = 'rgba(255, 255, 255, 0.22)';
    context.strokeRect(left - ratio / 2, top - ratio / 2, right - left + ratio, bottom - top + ratio);
  }

  /** @param {CanvasRenderingContext2D} context @param {(x: number, y: number) => number[]} place @param {number} ratio @param {any} frame */
  #draw_pages(context, place, ratio, {size, viewState: {resolution, center}}) {
    const level = this.level_shown(resolution);
    const side = page_side * 2 ** level;
    const last = 2 ** (this.#texture.coarsest_level - level) - 1;
    const index = (/** @type {number} */ texel) => Math.min(last, Math.max(0, Math.floor(texel / side)));
    const half = [(size[0] / 2) * resolution, (size[1] / 2) * resolution];
    context.font = `${11 * ratio}px ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace`;
    context.textBaseline = 'middle';
    const highest_label = this.covered_above() * ratio;
    for (let y = index(-center[1] - half[1]); y <= index(-center[1] + half[1]); ++y) {
      for (let x = index(center[0] - half[0]); x <= index(center[0] + half[0]); ++x) {
        const [left, top] = place(x * side, y * side);
        const [right, bottom] = place((x + 1) * side, (y + 1) * side);
        this.#draw_page(context, {level, x, y}, [left, top, right - left, bottom - top], ratio, highest_label);
      }
    }
  }

  /** @param {CanvasRenderingContext2D} context @param {import('./texture.js').PageKey} page @param {number[]} box @param {number} ratio @param {number} highest_label */
  #draw_page(context, page, [left, top, width, height], ratio, highest_label) {
    const state = this.#ledger.find(page)?.state ?? 'loading';
    const line = Math.max(1, Math.round(ratio));
    context.lineWidth = line;
    context.strokeStyle = 'rgba(8, 10, 12, 0.55)';
    context.strokeRect(left - line / 2, top - line / 2, width, height);
    context.strokeStyle = state_colours[state];
    context.strokeRect(left + line / 2, top + line / 2, width, height);

    const text = state === 'ready' || state === 'cached' ? key_text(page) : `${key_text(page)} ${state}`;
    const [label_width, label_height] = [context.measureText(text).width + 12 * ratio, 20 * ratio];
    if (label_width + 8 * ratio > width || label_height + 8 * ratio > height) return;
    // A page that begins left of the view, or behind the bar, still shows its key, as long as there is room for it
    const label_left = Math.min(Math.max(left, 0), left + width - label_width - 9 * ratio) + 5 * ratio;
    const label_top = Math.min(Math.max(top, highest_label), top + height - label_height - 9 * ratio) + 5 * ratio;
    context.fillStyle = 'rgba(12, 14, 16, 0.78)';
    context.beginPath();
    context.roundRect(label_left, label_top, label_width, label_height, 4 * ratio);
    context.fill();
    context.fillStyle = state === 'ready' || state === 'cached' ? 'rgba(255, 255, 255, 0.92)' : state_colours[state];
    context.fillText(text, label_left + 6 * ratio, label_top + 10.5 * ratio);
  }
}
