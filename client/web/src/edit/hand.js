import {settled} from './sprite.js';

/** Farther than this, and it is a drag. */
const slack_pixels = 4;
const right_angles = 1 / 24;

/**
 * The pointer while a scene is edited: takes hold of sprites and of handles, draws a frame around several, places new
 * ones. What it does not want is left to the map, which then pans.
 */
export class Hand {
  #editor;
  #canvas;
  /** @type {null | {kind: 'move' | 'scale' | 'turn' | 'frame' | 'click', start: number[], at: {x: number, y: number}, moved: boolean, about?: {x: number, y: number}, hit?: any, add: boolean, pointer: number}} */
  #grip = null;

  /** @param {import('./editor.js').Editor} editor @param {HTMLElement} canvas What the map is drawn in. @param {AbortSignal} until */
  constructor(editor, canvas, until) {
    this.#editor = editor;
    this.#canvas = canvas;
    const options = {signal: until, capture: true};
    canvas.addEventListener('pointerdown', (event) => this.#down(event), options);
    canvas.addEventListener('pointermove', (event) => this.#move(event), options);
    canvas.addEventListener('pointerup', (event) => this.#up(event), options);
    canvas.addEventListener('pointercancel', () => this.cancel(), options);
    canvas.addEventListener('pointerleave', () => editor.hover(null, null), {signal: until});
  }

  get is_dragging() {
    return this.#grip !== null && this.#grip.moved && this.#grip.kind !== 'click' && this.#grip.kind !== 'frame';
  }

  /** Lets go, and leaves all as it was. */
  cancel() {
    if (!this.#grip) return false;
    const moved = this.#grip.moved;
    this.#grip = null;
    this.#editor.drop_nothing();
    return moved;
  }

  /** @param {PointerEvent} event */
  #pixel({clientX, clientY}) {
    const {left, top} = this.#canvas.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }

  /** @param {PointerEvent} event */
  #down(event) {
    const editor = this.#editor;
    if (!editor.active || event.button !== 0 || !event.isPrimary) return;
    const start = this.#pixel(event);
    const at = editor.texel_at(start);
    if (!at) return;
    const grip = {start, at, moved: false, add: event.shiftKey, pointer: event.pointerId};
    const handle = editor.placing ? null : editor.layer.handle_at(start);
    const hit = editor.placing || handle ? undefined : editor.sprite_at(at);
    if (handle) this.#grip = {...grip, kind: handle.kind, about: editor.layer.frame()?.middle};
    else if (hit) this.#grip = {...grip, kind: 'move', hit};
    else if (event.shiftKey && !editor.placing) this.#grip = {...grip, kind: 'frame'};
    else this.#grip = {...grip, kind: 'click'};
    if (this.#grip.kind === 'click') return;  // the map may pan
    event.stopPropagation();
    this.#canvas.setPointerCapture(event.pointerId);
    this.#canvas.focus({preventScroll: true});
    if (hit) editor.take_hold(hit, event.shiftKey);
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const editor = this.#editor;
    if (!editor.active) return;
    const pixel = this.#pixel(event);
    const at = editor.texel_at(pixel);
    if (!at) return;
    const grip = this.#grip;
    if (!grip) return editor.hover(pixel, at);
    if (Math.hypot(pixel[0] - grip.start[0], pixel[1] - grip.start[1]) > slack_pixels) grip.moved = true;
    if (grip.kind === 'click') return editor.hover(pixel, at);
    event.stopPropagation();
    if (!grip.moved) return;
    const about = grip.about ?? grip.at;
    if (grip.kind === 'move') editor.drag({dx: at.x - grip.at.x, dy: at.y - grip.at.y});
    if (grip.kind === 'frame') editor.draw_frame(grip.at, at);
    if (grip.kind === 'scale') {
      const reach = (/** @type {{x: number, y: number}} */ {x, y}) => Math.hypot(x - about.x, y - about.y);
      editor.drag({scale: Math.max(1e-3, reach(at) / (reach(grip.at) || 1)), about});
    }
    if (grip.kind === 'turn') {
      const angle = (/** @type {{x: number, y: number}} */ {x, y}) => Math.atan2(y - about.y, x - about.x) / (2 * Math.PI);
      const turn = angle(at) - angle(grip.at);
      editor.drag({turn: event.shiftKey ? Math.round(turn / right_angles) * right_angles : turn, about});
    }
  }

  /** @param {PointerEvent} event */
  #up(event) {
    const editor = this.#editor;
    const grip = this.#grip;
    if (!editor.active || !grip || event.pointerId !== grip.pointer) return;
    this.#grip = null;
    const at = editor.texel_at(this.#pixel(event)) ?? grip.at;
    if (grip.kind !== 'click') event.stopPropagation();
    if (grip.kind === 'frame') return editor.select_in_frame(grip.at, at, grip.moved);
    if (grip.kind === 'click') {
      if (!grip.moved) editor.click(at, grip.add);
      return;
    }
    if (grip.moved) editor.drop();
    else if (grip.hit) editor.clicked_sprite(grip.hit, grip.add);
    else editor.drop_nothing();
  }
}

/** @param {any} sprite @param {{x: number, y: number}} at */
export const put_at = (sprite, {x, y}) => settled({...sprite, x, y});
