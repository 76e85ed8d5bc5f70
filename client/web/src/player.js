import {element, icon, icon_button} from './dom.js';
import {with_separators} from './numbers.js';

/** Faster than this no page is asked for; quicker scenes leave steps out. */
const most_changes_per_second = 20;

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
  #change;
  #busy;
  #timer = 0;
  /** @type {{animated: boolean, steps_per_second: number, loop_steps: number}} */
  #clock = {animated: false, steps_per_second: 10, loop_steps: 0};
  /** @type {number | null} Null while it plays. */
  paused_at = null;
  step = 0;
  #button = icon_button('Pause (P)', 'pause', () => this.toggle());
  #text = element('output', {class: 'player-step'});
  element = element('fieldset', {class: 'panel player', 'aria-label': 'Animation'}, this.#button, this.#text);

  /**
   * @param {(step: number) => void} change Told each step that is to be shown.
   * @param {() => boolean} busy Whether pages of the step before are still on their way: the next one waits.
   */
  constructor(change, busy) {
    this.#change = change;
    this.#busy = busy;
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
    this.paused_at = paused_at;
    const plays = paused_at === null;
    this.#button.replaceChildren(icon(plays ? 'pause' : 'play'));
    this.#button.title = plays ? 'Pause (P)' : 'Play (P)';
    this.#button.setAttribute('aria-label', this.#button.title);
    if (!this.#clock.animated) return;
    if (plays) this.#tick();
    else this.#show(paused_at);
  }

  #tick() {
    const now = Date.now();
    if (!this.#busy() && !document.hidden) this.#show(step_at(this.#clock, now));
    const wait = 1000 / Math.min(this.#clock.steps_per_second, most_changes_per_second);
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
