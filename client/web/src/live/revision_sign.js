import {element, icon_button} from '../dom.js';
import {with_separators} from '../numbers.js';
import {colour_of} from './people.js';

const told_for = 6000;

/** How long ago, in few words. @param {number} milliseconds */
export function ago(milliseconds) {
  const seconds = Math.floor(milliseconds / 1000);
  return seconds < 5 ? 'now' : seconds < 60 ? `${seconds} s` : seconds < 3600 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
}

const state_words = {
  open: 'Live: changes show as they are made.',
  connecting: 'Connecting to the live stream …',
  waiting: 'The live stream is interrupted: connecting again.',
  absent: 'No live stream here: changes show a few seconds later.',
};

/** The scene's revision, what was done last, and a drawer with the last edits. */
export class RevisionSign {
  #news;
  #go;
  #timer = 0;
  #dot = element('span', {class: 'dot'});
  #revision = element('output', {class: 'value', 'data-read': 'revision'});
  #deed = element('span', {class: 'deed', 'data-read': 'deed', 'aria-live': 'polite'});
  #list = element('ol', {class: 'news'});
  drawer = element(
    'aside',
    {class: 'panel drawer', id: 'last-edits', hidden: true, 'aria-label': 'Last edits'},
    element('header', {}, element('h2', {text: 'Last edits'}), icon_button('Close', 'close', () => this.toggle(false))),
    this.#list,
  );
  element = element(
    'button',
    {type: 'button', class: 'live-sign', 'aria-expanded': 'false', 'aria-controls': 'last-edits', hidden: true, onclick: () => this.toggle(this.drawer.hidden)},
    this.#dot, element('span', {class: 'label', text: 'revision'}), this.#revision, this.#deed,
  );

  /** @param {import('./edit_news.js').EditNews} news @param {(place: {x: number, y: number, side: number}) => void} go To where something was done. */
  constructor(news, go) {
    this.#news = news;
    this.#go = go;
    news.addEventListener('change', () => this.#tell());
    for (const part of [this.drawer, this.element]) {
      part.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
        if (event.key !== 'Escape' || this.drawer.hidden) return;
        event.stopPropagation();
        this.toggle(false);
        this.element.focus();
      });
    }
  }

  /** @param {boolean} open */
  toggle(open) {
    this.drawer.hidden = !open;
    this.element.setAttribute('aria-expanded', String(open));
    if (open) this.#show_list();
  }

  /** @param {number} revision @param {keyof typeof state_words} state @param {string} [detail] */
  show(revision, state, detail = '') {
    this.element.hidden = false;
    this.element.dataset.state = state;
    this.element.title = [state_words[state], detail].filter(Boolean).join(' ');
    const text = with_separators(revision);
    if (this.#revision.textContent !== text) this.#revision.textContent = text;
  }

  close() {
    clearTimeout(this.#timer);
  }

  #tell() {
    const [last] = this.#news.list;
    if (!this.drawer.hidden) this.#show_list();
    clearTimeout(this.#timer);
    if (!last) {
      this.#deed.textContent = '';
      return;
    }
    const text = `${last.who} ${last.what}`;
    if (this.#deed.textContent !== text) this.#deed.textContent = text;
    this.#deed.classList.add('fresh');
    this.element.classList.remove('beat');
    void this.element.offsetWidth;  // so that the animation begins anew
    this.element.classList.add('beat');
    this.#timer = setTimeout(() => this.#deed.classList.remove('fresh'), told_for);
  }

  #show_list() {
    const now = Date.now();
    const items = this.#news.list.map((news) => {
      const {who, mine, session, what, revision, times, at, place} = news;
      const dot = element('span', {class: 'person-dot'});
      dot.style.setProperty('--person', mine ? 'var(--text)' : colour_of(session));
      const text = element('span', {class: 'news-text'}, element('b', {text: who}), ` ${what}`, times > 1 && element('span', {class: 'quiet', text: ` × ${with_separators(times)}`}));
      const facts = element('span', {class: 'news-facts', text: `${with_separators(revision)} · ${ago(now - at)}`});
      return element('li', {}, element('button', {type: 'button', disabled: !place, title: place ? 'Go there' : '', onclick: () => place && this.#go(place)}, dot, text, facts));
    });
    this.#list.replaceChildren(...(items.length > 0 ? items : [element('li', {class: 'quiet', text: 'Nothing was changed since you came.'})]));
  }
}
