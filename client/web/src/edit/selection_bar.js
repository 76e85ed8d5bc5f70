import {element, icon_button} from '../dom.js';
import {with_separators} from '../numbers.js';

/** A number with a unit behind it. @param {string} label @param {string} unit @param {(value: number) => void} change */
function number_field(label, unit, change) {
  const input = element('input', {type: 'text', inputmode: 'decimal', 'aria-label': label, onchange: () => {
    const value = Number(input.value.replace(',', '.').replace(/[^\d.+-]/g, ''));
    if (input.value.trim() !== '' && Number.isFinite(value)) change(value);
  }});
  input.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    if (event.key === 'Enter' || event.key === 'Escape') input.blur();
    event.stopPropagation();
  });
  const show = (/** @type {number | null} */ value) => {
    if (document.activeElement !== input) input.value = value === null ? '' : String(Math.round(value * 10) / 10);
    input.placeholder = value === null ? '–' : '';
  };
  return {element: element('label', {class: 'number-field'}, element('span', {text: label}), input, element('small', {text: unit})), show};
}

/** What is selected, in numbers, and what can be done with it. */
export class SelectionBar {
  #count = element('span', {class: 'selection-count'});
  #scale;
  #turn;
  element;

  /**
   * @param {{scale_to: (scale: number) => void, turn_to: (turn: number) => void, raise: (up: boolean) => void, duplicate: () => void, remove: () => void}} actions
   */
  constructor({scale_to, turn_to, raise, duplicate, remove}) {
    this.#scale = number_field('Scale', '%', (percent) => scale_to(percent / 100));
    this.#turn = number_field('Turn', '°', (degrees) => turn_to(degrees / 360));
    this.element = element(
      'div',
      {class: 'panel selection-bar', hidden: true, role: 'toolbar', 'aria-label': 'Selection'},
      this.#count,
      this.#scale.element,
      this.#turn.element,
      icon_button('To the front (Page up)', 'raise', () => raise(true)),
      icon_button('To the back (Page down)', 'lower', () => raise(false)),
      icon_button('Duplicate (Ctrl+D)', 'duplicate', duplicate),
      icon_button('Delete (Del)', 'bin', remove),
    );
  }

  /** @param {import('./sprite.js').Sprite[]} selection @param {(pattern: number) => string} name_of */
  show(selection, name_of) {
    this.element.hidden = selection.length === 0;
    if (selection.length === 0) return;
    this.#count.textContent = selection.length === 1 ? name_of(selection[0].pattern) : `${with_separators(selection.length)} sprites`;
    const common = (/** @type {(sprite: import('./sprite.js').Sprite) => number} */ of) => (selection.every((sprite) => of(sprite) === of(selection[0])) ? of(selection[0]) : null);
    const scale = common((sprite) => sprite.scale), turn = common((sprite) => sprite.turn);
    this.#scale.show(scale === null ? null : scale * 100);
    this.#turn.show(turn === null ? null : turn * 360);
  }
}
