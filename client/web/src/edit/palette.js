import {element, icon_button} from '../dom.js';

/** The patterns to place, with undo and redo above them. */
export class Palette {
  #choose;
  /** @type {any[]} */
  #buttons = [];
  #grid = element('div', {class: 'palette-grid', role: 'radiogroup', 'aria-label': 'Patterns'});
  #hint = element('p', {class: 'palette-hint', 'aria-live': 'polite'});
  undo;
  redo;
  element;

  /** @param {{choose: (pattern: number | null) => void, undo: () => void, redo: () => void}} actions `null`: nothing is placed, sprites are taken hold of. */
  constructor({choose, undo, redo}) {
    this.#choose = choose;
    this.undo = icon_button('Undo (Ctrl+Z)', 'undo', undo, {disabled: true});
    this.redo = icon_button('Redo (Ctrl+Shift+Z)', 'redo', redo, {disabled: true});
    this.hand = icon_button('Select and move (V)', 'hand', () => choose(null), {'aria-pressed': 'true'});
    this.element = element(
      'aside',
      {class: 'panel palette', hidden: true, 'aria-label': 'Editor'},
      element('div', {class: 'palette-tools', role: 'toolbar', 'aria-label': 'Editing'}, this.hand, this.undo, this.redo),
      this.#grid,
      this.#hint,
    );
  }

  /** @param {import('./pattern_images.js').PatternImages} patterns */
  offer(patterns) {
    this.#buttons = Array.from({length: patterns.count}, (_, pattern) =>
      element('button', {type: 'button', class: 'pattern', role: 'radio', 'aria-checked': 'false', 'aria-label': patterns.name(pattern), title: patterns.name(pattern), 'data-pattern': pattern, onclick: () => this.#choose(pattern)}));
    this.#grid.replaceChildren(...this.#buttons);
    this.show_images(patterns);
  }

  /** @param {import('./pattern_images.js').PatternImages} patterns */
  show_images(patterns) {
    this.#buttons.forEach((button, pattern) => {
      const image = patterns.image(pattern);
      if (!image || button.firstChild) return;
      const copy = element('canvas', {width: image.width, height: image.height, 'aria-hidden': 'true'});
      copy.getContext('2d').drawImage(image, 0, 0);
      button.append(copy);
    });
  }

  /** @param {number | null} pattern */
  check(pattern) {
    this.#buttons.forEach((button, i) => button.setAttribute('aria-checked', String(i === pattern)));
    this.hand.setAttribute('aria-pressed', String(pattern === null));
  }

  /** @param {string} text */
  hint(text) {
    if (this.#hint.textContent !== text) this.#hint.textContent = text;
  }
}
