import {element, icon} from './dom.js';
import {connection} from './server.js';

/** A word that comes and goes: "Link copied". Screen readers hear it. */
export class Toast {
  #timer = 0;
  element = element('div', {class: 'toast', role: 'status', 'aria-live': 'polite'});

  /** @param {string} text */
  say(text) {
    this.element.textContent = text;
    this.element.classList.add('shown');
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.element.classList.remove('shown'), 2200);
  }
}

/** Tells that the server is silent, and when it is asked again. Stands while the page does. */
export class ConnectionBanner {
  #text = element('span', {});
  element = element(
    'div',
    {class: 'banner', role: 'alert', hidden: true},
    icon('unplugged'),
    this.#text,
    element('button', {type: 'button', class: 'text-button', text: 'Try now', onclick: () => connection.try_now()}),
  );

  constructor() {
    connection.addEventListener('waiting', (event) => {
      const {seconds} = /** @type {CustomEvent} */ (event).detail;
      this.element.hidden = false;
      this.#text.textContent = `The server is not answering. Trying again ${seconds === 1 ? 'in a second' : `in ${seconds} seconds`}.`;
    });
    connection.addEventListener('up', () => (this.element.hidden = true));
  }
}

/**
 * A page with one message on it, where there is nothing else to show.
 * @param {{title: string, detail: string, icon?: 'warning' | 'unplugged', action?: {text: string, act: () => void}}} message
 */
export function message_page({title, detail, icon: icon_name = 'warning', action}) {
  return element(
    'main',
    {class: 'message-page'},
    element('div', {class: 'message-icon'}, icon(icon_name)),
    element('h1', {text: title}),
    element('p', {text: detail}),
    action && element('button', {type: 'button', class: 'primary-button', text: action.text, onclick: action.act}),
  );
}
