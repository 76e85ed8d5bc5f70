import {element} from './dom.js';

/** Who waits for less than this is not told so. */
const patience_milliseconds = 400;

/** Says that the first pages are being made, over a view that has nothing to show yet. */
export class WaitingSign {
  #timer = 0;
  element = element(
    'div',
    {class: 'waiting', role: 'status', hidden: true},
    element('div', {class: 'waiting-bar', 'aria-hidden': 'true'}),
    element('p', {text: 'Making the first pages of this view'}),
  );

  /** @param {boolean} waits */
  show(waits) {
    if (!waits) {
      clearTimeout(this.#timer);
      this.#timer = 0;
      this.element.hidden = true;
    } else if (this.#timer === 0) {
      this.#timer = setTimeout(() => (this.element.hidden = false), patience_milliseconds);
    }
  }
}
