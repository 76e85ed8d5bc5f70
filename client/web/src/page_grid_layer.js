import Layer from 'ol/layer/Layer.js';

import {level_for, pages_meeting, ViewCanvas} from './page_layer.js';
import {key_text} from './texture.js';

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
  #canvas = new ViewCanvas('page-grid');
  shown = false;

  /**
   * @param {import('./texture.js').Texture} texture
   * @param {import('./page_ledger.js').PageLedger} ledger
   * @param {() => number} covered_above CSS pixels at the top of the view that the bar covers.
   */
  constructor(texture, ledger, covered_above) {
    super({properties: {name: 'page grid'}});
    this.#texture = texture;
    this.#ledger = ledger;
    this.covered_above = covered_above;
  }

  getSourceState() {
    return 'ready';
  }

  /** @param {any} frame @returns {HTMLElement} */
  render(frame) {
    const canvas = this.#canvas;
    canvas.begin(frame);
    this.#draw_border();
    if (this.shown) {
      const level = level_for(frame.viewState.resolution, this.#texture.coarsest_level);
      canvas.context.font = `${11 * canvas.ratio}px ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace`;
      canvas.context.textBaseline = 'middle';
      for (const page of pages_meeting(canvas.box, level, this.#texture.coarsest_level)) {
        const {left, top, width, height} = canvas.place_of(page);
        this.#draw_page(canvas.context, page, [left, top, width, height], canvas.ratio, this.covered_above() * canvas.ratio);
      }
    }
    return canvas.element;
  }

  #draw_border() {
    const {context, ratio} = this.#canvas;
    const side = this.#texture.side_texels;
    const clamp = (/** @type {number} */ value) => Math.min(Math.max(Math.round(value), -1e4), 1e5);
    const [left, top, right, bottom] = [this.#canvas.left(0), this.#canvas.top(0), this.#canvas.left(side), this.#canvas.top(side)].map(clamp);
    context.lineWidth = ratio;
    context.strokeStyle = 'rgba(255, 255, 255, 0.22)';
    context.strokeRect(left - ratio / 2, top - ratio / 2, right - left + ratio, bottom - top + ratio);
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
