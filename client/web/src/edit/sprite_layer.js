import Layer from 'ol/layer/Layer.js';

import {level_for, pages_meeting, ViewCanvas} from '../page_layer.js';
import {box_around, box_of, boxes_meet, corners_of, drawn_before} from './sprite.js';

const handle_radius = 5.5, turn_reach = 26, hold_radius = 13;

/**
 * What is selected, on screen: four corners to scale by and a knob to turn by, in CSS pixels of the view.
 * @typedef {{corners: number[][], knob: number[], middle: {x: number, y: number}}} Frame
 */

/** Draws what is in hands, over the pages that do not show it yet; the selection with its handles; and others' selections. */
export class SpriteLayer extends Layer {
  #editor;
  #store;
  #coarsest;
  #canvas = new ViewCanvas('sprites');

  /** @param {import('./editor.js').Editor} editor @param {import('../texture.js').Texture} texture @param {import('../page_store.js').PageStore} store */
  constructor(editor, texture, store) {
    super({properties: {name: 'sprites'}});
    this.#editor = editor;
    this.#store = store;
    this.#coarsest = texture.coarsest_level;
  }

  getSourceState() {
    return 'ready';
  }

  /** @param {any} frame @returns {HTMLElement} */
  render(frame) {
    const canvas = this.#canvas;
    canvas.begin(frame);
    const pages = pages_meeting(canvas.box, level_for(frame.viewState.resolution, this.#coarsest), this.#coarsest);
    this.#editor.carries.tidy(pages);
    for (const carry of this.#editor.carries.list) this.#draw_carry(carry, pages);
    this.#draw_others();
    if (this.#editor.active) this.#draw_selection();
    return canvas.element;
  }

  /** @param {import('./carry.js').Carry} carry @param {import('../texture.js').PageKey[]} pages */
  #draw_carry(carry, pages) {
    if (carry.sprites.length === 0) return;
    const {context} = this.#canvas;
    context.save();
    if (carry.revision !== null) {
      // Only where the pages do not show it yet: never twice, and never not at all
      context.beginPath();
      for (const page of pages) {
        if (!carry.awaits(page)) continue;
        const {left, top, width, height} = this.#canvas.place_of(page);
        context.rect(left, top, width, height);
      }
      context.clip();
    }
    for (const sprite of [...carry.sprites].sort(drawn_before)) this.#draw_sprite(this.#editor.now(sprite), 1);
    context.restore();
  }

  /** @param {import('./sprite.js').Sprite} sprite @param {number} opacity */
  #draw_sprite(sprite, opacity) {
    const {context, scale} = this.#canvas;
    const image = this.#editor.patterns?.image(sprite.pattern);
    if (!image) return;
    const side = this.#editor.side * sprite.scale * scale;
    context.save();
    context.globalAlpha *= opacity;
    context.imageSmoothingEnabled = this.#editor.smooth || sprite.turn * 4 % 1 !== 0 || side < image.width;
    context.imageSmoothingQuality = 'high';
    context.translate(this.#canvas.left(sprite.x), this.#canvas.top(sprite.y));
    context.rotate(sprite.turn * 2 * Math.PI);
    context.drawImage(image, -side / 2, -side / 2, side, side);
    context.restore();
  }

  /** @param {import('./sprite.js').Sprite} sprite */
  #outline(sprite) {
    const {context} = this.#canvas;
    context.beginPath();
    for (const {x, y} of corners_of(sprite, this.#editor.side)) context.lineTo(this.#canvas.left(x), this.#canvas.top(y));
    context.closePath();
  }

  /** @param {string} colour @param {number} width CSS pixels. @param {number[]} [dash] */
  #stroke(colour, width, dash = []) {
    const {context, ratio} = this.#canvas;
    context.setLineDash(dash.map((length) => length * ratio));
    context.lineJoin = 'round';
    context.lineWidth = (width + 2) * ratio;
    context.strokeStyle = 'rgba(10, 12, 14, 0.5)';
    context.stroke();
    context.lineWidth = width * ratio;
    context.strokeStyle = colour;
    context.stroke();
    context.setLineDash([]);
  }

  #draw_others() {
    for (const {sprite, colour, held} of this.#editor.others) {
      const there = this.#editor.now(sprite);
      if (!boxes_meet(box_of(there, this.#editor.side), this.#canvas.box)) continue;
      this.#outline(there);
      this.#stroke(colour, 1.5, held ? [5, 4] : []);
    }
  }

  #draw_selection() {
    const {context, ratio} = this.#canvas;
    const {placing, marquee} = this.#editor;
    const selection = this.#editor.selection.map((sprite) => this.#editor.now(sprite));
    const hovered = this.#editor.hovered && this.#editor.now(this.#editor.hovered);
    if (placing) this.#draw_sprite(placing, 0.75);
    if (hovered && !selection.some(({id}) => id === hovered.id)) {
      this.#outline(hovered);
      this.#stroke('rgba(255, 255, 255, 0.85)', 1.25);
    }
    for (const sprite of selection) {
      this.#outline(sprite);
      this.#stroke('#f2c377', 1.75);
    }
    const frame = this.frame();
    if (frame && !this.#editor.is_dragging) {
      const device = (/** @type {number[]} */ [x, y]) => [x * ratio, y * ratio];
      if (selection.length > 1) {
        context.beginPath();
        for (const corner of frame.corners) context.lineTo(...device(corner));
        context.closePath();
        this.#stroke('rgba(242, 195, 119, 0.8)', 1, [4, 4]);
      }
      const [knob_x, knob_y] = device(frame.knob);
      const [[ax, ay], [bx, by]] = frame.corners.slice(0, 2).map(device);
      context.beginPath();
      context.moveTo((ax + bx) / 2, (ay + by) / 2);
      context.lineTo(knob_x, knob_y);
      this.#stroke('#f2c377', 1.25);
      for (const [x, y] of [...frame.corners.map(device), [knob_x, knob_y]]) {
        context.beginPath();
        context.arc(x, y, handle_radius * ratio, 0, 2 * Math.PI);
        context.fillStyle = '#fffaf0';
        context.fill();
        this.#stroke('#c98a2b', 1.5);
        context.fill();
      }
    }
    if (marquee) {
      context.beginPath();
      context.rect(this.#canvas.left(marquee.x0), this.#canvas.top(marquee.y0), (marquee.x1 - marquee.x0) * this.#canvas.scale, (marquee.y1 - marquee.y0) * this.#canvas.scale);
      context.fillStyle = 'rgba(242, 195, 119, 0.12)';
      context.fill();
      this.#stroke('#f2c377', 1.25);
    }
  }

  /** @returns {Frame | null} Null without a selection. */
  frame() {
    const {side} = this.#editor;
    const selection = this.#editor.selection.map((sprite) => this.#editor.now(sprite));
    if (selection.length === 0 || !this.#canvas.scale) return null;
    const css = (/** @type {{x: number, y: number}} */ {x, y}) => [this.#canvas.left(x) / this.#canvas.ratio, this.#canvas.top(y) / this.#canvas.ratio];
    let texels = corners_of(selection[0], side);
    if (selection.length > 1) {
      const {x0, y0, x1, y1} = box_around(selection.map((sprite) => box_of(sprite, side)));
      texels = [{x: x0, y: y0}, {x: x1, y: y0}, {x: x1, y: y1}, {x: x0, y: y1}];
    }
    const middle = {x: (texels[0].x + texels[2].x) / 2, y: (texels[0].y + texels[2].y) / 2};
    // Handles of what is tiny on screen stand apart, so that the sprite itself can be taken
    const [mx, my] = css(middle);
    const corners = texels.map(css).map(([x, y]) => {
      const length = Math.hypot(x - mx, y - my) || 1;
      const reach = Math.max(length + 3, 24) / length;
      return [mx + (x - mx) * reach, my + (y - my) * reach];
    });
    const top = [(corners[0][0] + corners[1][0]) / 2, (corners[0][1] + corners[1][1]) / 2];
    const length = Math.hypot(top[0] - mx, top[1] - my) || 1;
    return {corners, knob: [top[0] + ((top[0] - mx) / length) * turn_reach, top[1] + ((top[1] - my) / length) * turn_reach], middle};
  }

  /** The handle at a place of the view. @param {number[]} pixel @returns {{kind: 'turn' | 'scale', corner: number} | null} */
  handle_at([x, y]) {
    const frame = this.frame();
    if (!frame) return null;
    const near = (/** @type {number[]} */ place) => Math.hypot(place[0] - x, place[1] - y) <= hold_radius;
    if (near(frame.knob)) return {kind: 'turn', corner: 0};
    const corner = frame.corners.findIndex(near);
    return corner >= 0 ? {kind: 'scale', corner} : null;
  }
}
