import {element, icon, icon_button} from './dom.js';
import {with_separators} from './numbers.js';
import {PlayerMenu} from './player_menu.js';

/** Faster than this no page is asked for; quicker scenes leave steps out. */
const most_changes_per_second = 20;

/** After this a step is shown with what is there, in milliseconds: the server gives a page up after 10 s. */
const longest_wait = 12_000;

/** The step that an address asks for: it is shown and stays. @param {string | undefined} asked @param {boolean} animated */
export const step_chosen = (asked, animated) =>
  animated && asked !== undefined && /^-?\d+$/.test(asked) && Number.isSafeInteger(Number(asked)) ? Number(asked) : null;

/**
 * Plays a texture that moves, by the scene's clock: a button, the step, and behind it a slider and what sets the clock for
 * everybody; not there at all for one that does not move.
 */
export class Player {
  #store;
  #clock;
  #actions;
  #timer = 0;
  /** @type {{step: number, since: number} | null} The step that is to be shown as soon as all of it is here. */
  #due = null;
  /** @type {number | null} The step that is looked at; null: the clock's. Of this page alone. */
  paused_at = null;
  step = 0;
  #button = icon_button('Pause (P)', 'pause', () => this.toggle());
  #text = element('span', {class: 'player-step'});
  #menu;
  element;

  /**
   * @param {import('./page_store.js').PageStore} store What shows the steps.
   * @param {import('./live/scene_clock.js').SceneClock} clock
   * @param {{change: (step: number) => void, set_clock: (change: any) => void, say: (text: string) => void, chosen: () => void}} actions
   *   `change` is told each step that is to be shown, `chosen` when a person chose what is looked at.
   */
  constructor(store, clock, actions) {
    this.#store = store;
    this.#clock = clock;
    this.#actions = actions;
    this.#menu = new PlayerMenu(clock, {
      seek: (step) => this.seek(step),
      back: () => this.#choose(null),
      set_clock: actions.set_clock,
    });
    const open = element('button', {type: 'button', class: 'player-open', 'aria-expanded': 'false', 'aria-controls': 'player-menu', title: 'Step and clock', onclick: () => this.#menu.toggle(open)}, this.#text);
    this.element = element('fieldset', {class: 'panel player menu-anchor', 'aria-label': 'Animation'}, this.#button, open, this.#menu.element);
    this.element.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => this.#menu.escape(event));
    clock.addEventListener('change', () => this.#follow());
  }

  /** @param {number | null} paused_at */
  offer(paused_at) {
    this.element.hidden = !this.#clock.animated;
    this.paused_at = paused_at;
    this.#follow();
  }

  /** @param {boolean} may_edit Whether the clock can be set for everybody. */
  set_rights(may_edit) {
    this.#menu.set_rights(may_edit);
  }

  /** Pauses or plays: for everybody, if that is chosen. */
  toggle() {
    if (this.#menu.for_everybody) return this.#actions.set_clock({playing: !this.#clock.playing});
    if (this.paused_at === null && !this.#clock.playing) return this.#actions.say('The clock stands for everybody: “For everybody” lets you start it');
    this.#choose(this.paused_at === null ? this.step : null);
  }

  /** By so many steps, and stay there. @param {number} steps */
  move(steps) {
    this.seek(this.step + steps);
  }

  /** @param {number} step */
  seek(step) {
    const {loop_steps} = this.#clock;
    const there = loop_steps > 0 ? ((step % loop_steps) + loop_steps) % loop_steps : step;
    if (!this.#menu.for_everybody) return this.#choose(there);
    this.#show(there);  // at once here; the clock follows
    this.#actions.set_clock({step: BigInt(there)});
  }

  close() {
    clearTimeout(this.#timer);
  }

  close_menu() {
    this.#menu.close();
  }

  /** @param {number | null} paused_at */
  #choose(paused_at) {
    this.paused_at = paused_at;
    this.#follow();
    this.#actions.chosen();
  }

  #follow() {
    clearTimeout(this.#timer);
    this.#due = null;
    if (!this.#clock.animated) return;
    const plays = this.paused_at === null && this.#clock.playing;
    const label = plays ? 'Pause (P)' : 'Play (P)';
    this.#button.replaceChildren(icon(plays ? 'pause' : 'play'));
    this.#button.title = label;
    this.#button.setAttribute('aria-label', label);
    this.element.dataset.state = this.paused_at !== null ? 'here' : plays ? 'plays' : 'stopped';
    if (this.paused_at !== null) this.#show(this.paused_at);
    else if (plays) this.#tick();
    else this.#show(this.#clock.step_in());
    this.#menu.show(this.step, this.paused_at !== null);
  }

  /** A step is shown when all of its pages are here, so that a frame never mixes two; meanwhile later ones are left out. */
  #tick() {
    const now = performance.now();
    const wait = 1000 / Math.min(this.#clock.steps_per_second, most_changes_per_second);
    if (!document.hidden) {
      this.#due ??= {step: this.#clock.step_in(), since: now};
      if (this.#store.ready_for(this.#due.step) || now - this.#due.since > longest_wait) {
        this.#show(this.#due.step);
        this.#due = null;
      }
      // What comes within the time that pages take is asked for now
      const ahead = Math.ceil((1.5 * this.#store.latency) / wait);
      const coming = Array.from({length: Math.min(3, ahead)}, (_, i) => this.#clock.step_in((i + 1) * wait));
      this.#store.prepare(this.#due ? [this.#due.step] : coming);
    }
    this.#timer = setTimeout(() => this.#tick(), Math.max(4, this.#clock.until_next() % wait || wait));
  }

  /** @param {number} step */
  #show(step) {
    this.#text.textContent = `Step ${with_separators(step)}`;
    this.#menu.show(step, this.paused_at !== null);
    if (step === this.step) return;
    this.step = step;
    this.#actions.change(step);
  }
}
