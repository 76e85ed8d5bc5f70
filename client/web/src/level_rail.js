import {element, icon_button} from './dom.js';

const finest_level = -6;  // A texel is 64 pixels: closer in there is nothing new to see.

/** The range of log2(texels under a pixel) that a view of `texture` can have. @param {import('./texture.js').Texture} texture */
export const level_range = (texture) => ({finest: finest_level, coarsest: texture.coarsest_level});

/** Zoom buttons, and a slider through all levels: coarse at the bottom, fine at the top. */
export class LevelRail {
  /**
   * @param {{finest: number, coarsest: number}} range
   * @param {{go: (level: number) => void, step: (levels: number) => void, fit: () => void}} actions
   */
  constructor({finest, coarsest}, {go, step, fit}) {
    this.slider = element('input', {
      type: 'range',
      class: 'level-slider',
      min: -coarsest,
      max: -finest,
      step: 0.01,
      'aria-label': 'Level',
      'aria-orientation': 'vertical',
      oninput: () => go(-Number(this.slider.value)),
    });
    this.element = element(
      'div',
      {class: 'level-rail panel', role: 'group', 'aria-label': 'Zoom'},
      icon_button('Closer (+)', 'plus', () => step(-1)),
      this.slider,
      icon_button('Farther (−)', 'minus', () => step(1)),
      icon_button('Whole texture (0)', 'fit', fit),
    );
  }

  /** @param {number} level log2 of the texels under a pixel. */
  show(level) {
    if (document.activeElement !== this.slider || !this.slider.matches(':active')) this.slider.value = String(-level);
    this.slider.setAttribute('aria-valuetext', level >= 0 ? `level ${level.toFixed(1)}` : `level 0, magnified ${(2 ** -level).toFixed(1)} times`);
  }
}
