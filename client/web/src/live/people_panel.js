import {element, keep_in_window} from '../dom.js';
import {fit_name} from './identity.js';

const most_avatars = 4;

/** "Anna Lind" -> "AL". @param {string} name */
const initials = (name) => name.split(/\s+/).slice(0, 2).map((word) => [...word][0] ?? '').join('').toUpperCase();

/** @param {string} name @param {string} colour */
function avatar(name, colour) {
  const node = element('span', {class: 'avatar', text: initials(name) || '·', 'aria-hidden': 'true'});
  node.style.setProperty('--person', colour);
  return node;
}

/** Who is here, as a row of round signs; behind them a list, one's own name, and a token where one is needed to edit. */
export class PeoplePanel {
  #people;
  #actions;
  #avatars = element('span', {class: 'avatars'});
  #button = element('button', {type: 'button', class: 'people-button', 'aria-expanded': 'false', 'aria-controls': 'people', onclick: () => this.#toggle(this.#menu.hidden)}, this.#avatars);
  #list = element('ul', {class: 'people-list'});
  #name = element('input', {type: 'text', id: 'my-name', maxlength: 64, autocomplete: 'nickname', placeholder: 'Your name'});
  #token = element('input', {type: 'password', id: 'my-token', autocomplete: 'off', placeholder: 'Token of an editor'});
  #right = element('p', {class: 'people-right'});
  #token_form = element('form', {class: 'people-form', hidden: true}, element('label', {for: 'my-token', text: 'Token'}), this.#token, element('button', {class: 'text-button', text: 'Use'}));
  #menu = element(
    'div',
    {class: 'menu panel people-menu', id: 'people', hidden: true, role: 'group', 'aria-label': 'People'},
    element('form', {class: 'people-form'}, element('label', {for: 'my-name', text: 'You'}), this.#name, element('button', {class: 'text-button', text: 'Save'})),
    this.#list,
    this.#right,
    this.#token_form,
  );
  element = element('div', {class: 'panel people menu-anchor', hidden: true}, this.#button, this.#menu);

  /**
   * @param {import('./people.js').People} people
   * @param {{name: string, rename: (name: string) => void, use_token: (token: string) => void, go: (person: import('./people.js').Person) => void}} actions
   */
  constructor(people, actions) {
    this.#people = people;
    this.#actions = actions;
    this.#name.value = actions.name;
    people.addEventListener('change', () => this.show());
    const [name_form, token_form] = this.#menu.querySelectorAll('form');
    name_form.addEventListener('submit', (/** @type {Event} */ event) => {
      event.preventDefault();
      this.#name.value = fit_name(this.#name.value);
      actions.name = this.#name.value;
      actions.rename(this.#name.value);
      this.show();
      this.#toggle(false);
    });
    token_form.addEventListener('submit', (/** @type {Event} */ event) => {
      event.preventDefault();
      actions.use_token(this.#token.value.trim());
    });
    this.element.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      if (event.key !== 'Escape' || this.#menu.hidden) return;
      event.stopPropagation();
      this.#toggle(false);
      this.#button.focus();
    });
  }

  /** @param {boolean} open */
  #toggle(open) {
    this.#menu.hidden = !open;
    this.#button.setAttribute('aria-expanded', String(open));
    if (!open) return;
    keep_in_window(this.#menu);
    if (!this.#actions.name) this.#name.focus();
  }

  close_menu() {
    this.#toggle(false);
  }

  /** @param {{may_edit: boolean, takes_edits: boolean, why_not: string}} rights */
  set_rights({may_edit, takes_edits, why_not}) {
    this.#right.textContent = !takes_edits ? 'This scene is to be looked at: nothing in it can be edited.' : may_edit ? 'You may edit this scene.' : why_not || 'You may look at this scene, not edit it.';
    this.#token_form.hidden = may_edit || !takes_edits;
  }

  show() {
    const others = [...this.#people.here.values()];
    const signs = others.slice(0, most_avatars).map(({name, colour}) => avatar(name, colour));
    if (others.length > most_avatars) signs.push(element('span', {class: 'avatar more', text: `+${others.length - most_avatars}`}));
    this.#avatars.replaceChildren(avatar(this.#actions.name || 'You', 'var(--text)'), ...signs);
    const text = others.length === 0 ? 'Nobody else is here' : others.length === 1 ? `${others[0].name} is here, too` : `${others.length} others are here`;
    this.#button.title = text;
    this.#button.setAttribute('aria-label', `People: ${text}`);
    this.#list.replaceChildren(
      ...others.map((person) =>
        element('li', {}, element('button', {type: 'button', onclick: () => this.#actions.go(person)}, avatar(person.name, person.colour), element('span', {text: person.name}), element('small', {text: person.may_edit ? 'may edit' : 'looks on'}))),
      ),
      ...(others.length === 0 ? [element('li', {class: 'quiet', text: 'Nobody else is here.'})] : []),
    );
  }
}
