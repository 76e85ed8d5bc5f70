import {element, icon, icon_button} from './dom.js';
import {with_separators} from './numbers.js';

/** Faster than this no page is asked for; quicker scenes leave steps out. */
const most_changes_per_second = 20;

/** After this a step is shown with what is there, in milliseconds. */
const longest_wait = 1500;

/**
 * The step that a texture shows at a time, so that all who look at it see the same.
 * @param {{steps_per_second: number, loop_steps: number}} clock @param {number} milliseconds Since 1970.
 */
export function step_at({steps_per_second, loop_steps}, milliseconds) {
  const step = Math.floor((milliseconds / 1000) * steps_per_second);
  return loop_steps > 0 ? step % loop_steps : step;
}

/** The step that an address asks for: it is shown and stays. @param {string | undefined} asked @param {boolean} animated */
export const step_chosen = (asked, animated) =>
  animated && asked !== undefined && /^-?\d+$/.test(asked) && Number.isSafeInteger(Number(asked)) ? Number(asked) : null;

/** Plays a texture that moves: a button, and the step; not there at all for one that does not. */
export class Player {
  #store;
  #change;
  #timer = 0;
  /** @type {{step: number, since: number} | null} The step that is to be shown as soon as all of it is here. */
  #due = null;
  /** @type {{animated: boolean, steps_per_second: number, loop_steps: number}} */
  #clock = {animated: false, steps_per_second: 10, loop_steps: 0};
  /** @type {number | null} Null while it plays. */
  paused_at = null;
  step = 0;
  #button = icon_button('Pause (P)', 'pause', () => this.toggle());
  #text = element('output', {class: 'player-step'});
  element = element('fieldset', {class: 'panel player', 'aria-label': 'Animation'}, this.#button, this.#text);

  /**
   * @param {import('./page_store.js').PageStore} store What shows the steps.
   * @param {(step: number) => void} change Told each step that is to be shown.
   */
  constructor(store, change) {
    this.#store = store;
    this.#change = change;
  }

  /** @param {{animated: boolean, steps_per_second: number, loop_steps: number}} clock @param {number | null} paused_at */
  offer(clock, paused_at) {
    this.#clock = clock;
    this.element.hidden = !clock.animated;
    this.#set(paused_at);
  }

  toggle() {
    this.#set(this.paused_at === null ? this.step : null);
  }

  /** By so many steps, and stay there. @param {number} steps */
  move(steps) {
    this.#set(this.step + steps);
  }

  close() {
    clearTimeout(this.#timer);
  }

  /** @param {number | null} paused_at */
  #set(paused_at) {
    clearTimeout(this.#timer);
    this.#due = null;
    this.paused_at = paused_at;
    const plays = paused_at === null;
    this.#button.replaceChildren(icon(plays ? 'pause' : 'play'));
    this.#button.title = plays ? 'Pause (P)' : 'Play (P)';
    this.#button.setAttribute('aria-label', this.#button.title);
    if (!this.#clock.animated) return;
    if (plays) this.#tick();
    else this.#show(paused_at);
  }

  /** A step is shown when all of its pages are here, so that a frame never mixes two; meanwhile later ones are left out. */
  #tick() {
    const now = Date.now();
    const wait = 1000 / Math.min(this.#clock.steps_per_second, most_changes_per_second);
    if (!document.hidden) {
      this.#due ??= {step: step_at(this.#clock, now), since: now};
      if (this.#store.ready_for(this.#due.step) || now - this.#due.since > longest_wait) {
        this.#show(this.#due.step);
        this.#due = null;
      }
      // What comes within the time that pages take is asked for now
      const ahead = Math.ceil((1.5 * this.#store.latency) / wait);
      const coming = Array.from({length: Math.min(3, ahead)}, (_, i) => step_at(this.#clock, now + (i + 1) * wait));
      this.#store.prepare(this.#due ? [this.#due.step] : coming);
    }
    this.#timer = setTimeout(() => this.#tick(), wait - (now % wait));
  }

  /** @param {number} step */
  #show(step) {
    this.#text.textContent = `Step ${with_separators(step)}`;
    if (step === this.step) return;
    this.step = step;
    this.#change(step);
  }
}
