import {level_range} from './level_rail.js';

const calm = matchMedia('(prefers-reduced-motion: reduce)');
const milliseconds = 220;

/** How the view moves when keys and buttons are pressed: glides, and quick presses add up. */
export class ViewMotion {
  #view;
  #texture;
  #room;
  /** @type {number | null} Where a stepwise zoom under way will end, so that quick steps add up. */
  #zooming_to = null;

  /**
   * @param {import('ol/View.js').default} view @param {import('./texture.js').Texture} texture
   * @param {() => {width: number, height: number, top: number, bottom: number, side: number}} room CSS pixels of the view, and
   *   what bars cover of it above, below and on each side.
   */
  constructor(view, texture, room) {
    this.#view = view;
    this.#texture = texture;
    this.#room = room;
  }

  /** @param {any} target What the view is to become: resolution, center. */
  glide(target, done = () => {}) {
    this.#view.cancelAnimations();
    this.#view.animate({...target, duration: calm.matches ? 0 : milliseconds}, done);
  }

  /** An eighth of the view, or all of it. @param {number} x @param {number} y @param {boolean} far */
  move(x, y, far) {
    const resolution = this.#view.getResolution() ?? 1;
    const {width, height} = this.#room();
    const [at_x, at_y] = this.#view.getCenter() ?? [0, 0];
    const share = far ? 1 : 0.125;
    this.glide({center: [at_x + x * Math.round(width * share) * resolution, at_y - y * Math.round(height * share) * resolution]});
  }

  /** To the next whole level: from 2.4, one step closer is 2. @param {number} levels Negative is closer. */
  step(levels) {
    const {finest, coarsest} = level_range(this.#texture);
    const level = this.#zooming_to ?? Math.log2(this.#view.getResolution() ?? 1);
    const next = levels < 0 ? Math.ceil(level - 0.01) - 1 : Math.floor(level + 0.01) + 1;
    const goal = Math.min(coarsest, Math.max(finest, next));
    this.#zooming_to = goal;
    this.glide({resolution: 2 ** goal}, () => {
      if (this.#zooming_to === goal) this.#zooming_to = null;
    });
  }

  /** The whole texture, between the bars. */
  fit() {
    const margin = 8;
    const {width, height, top, bottom, side: covered} = this.#room();
    const side = this.#texture.side_texels;
    const room = Math.max(64, Math.min(width - 2 * covered, height - top - bottom) - 2 * margin);
    const resolution = Math.min(2 ** this.#texture.coarsest_level, side / room);
    this.glide({resolution, center: [side / 2, -side / 2 + ((top - bottom) / 2) * resolution]});
  }

  /** To a place that somebody points to. @param {{x: number, y: number, level?: number, side?: number}} place `side`: texels across. */
  fly_to({x, y, level, side = 0}) {
    const now = this.#view.getResolution() ?? 1;
    const {finest, coarsest} = level_range(this.#texture);
    // So that what was done there is neither a speck nor larger than the view
    const fit = side > 0 ? Math.min(Math.max(now, (1.5 * side) / this.#room().height), side / 24) : now;
    const resolution = level !== undefined ? 2 ** level : fit;
    this.glide({center: [x, -y], resolution: Math.min(2 ** coarsest, Math.max(2 ** finest, resolution))});
  }
}
