import {element, icon_button, keep_in_window} from './dom.js';
import {short_decimal} from './numbers.js';

/** On either side of the step, where a scene goes on for ever. */
const reach = 300;

/** The slider through the steps, and what sets the clock for everybody. */
export class PlayerMenu {
  #clock;
  #actions;
  #opener = /** @type {HTMLElement | null} */ (null);
  #slider = element('input', {type: 'range', class: 'step-slider', step: 1, 'aria-label': 'Step', oninput: () => this.#actions.seek(Number(this.#slider.value))});
  #back = element('button', {type: 'button', class: 'text-button', text: 'Back to the clock', onclick: () => this.#actions.back()});
  #everybody = element('input', {type: 'checkbox', role: 'switch', id: 'for-everybody', onchange: () => this.#show_rate()});
  #rate = element('input', {type: 'number', class: 'rate-number', id: 'clock-rate', min: 0.1, max: 1000, step: 'any', onchange: () => this.#set_rate()});
  #rate_row = element('div', {class: 'rate-row'}, element('label', {for: 'clock-rate', text: 'Steps a second'}), this.#rate);
  #everybody_row = element('label', {class: 'switch-row', for: 'for-everybody'}, element('span', {}, 'For everybody', element('small', {text: 'Pause, step and speed set the scene’s own clock.'})), this.#everybody);
  element = element(
    'div',
    {class: 'menu panel player-menu', id: 'player-menu', hidden: true, role: 'group', 'aria-label': 'Step and clock'},
    element('div', {class: 'step-row'}, icon_button('Step back ([)', 'minus', () => this.#actions.seek(this.#step - 1)), this.#slider, icon_button('Step on (])', 'plus', () => this.#actions.seek(this.#step + 1))),
    this.#back,
    this.#everybody_row,
    this.#rate_row,
  );
  #step = 0;

  /** @param {import('./live/scene_clock.js').SceneClock} clock @param {{seek: (step: number) => void, back: () => void, set_clock: (change: any) => void}} actions */
  constructor(clock, actions) {
    this.#clock = clock;
    this.#actions = actions;
    this.set_rights(false);
  }

  /** Closes the menu on Escape. @param {KeyboardEvent} event */
  escape(event) {
    if (event.key !== 'Escape' || this.element.hidden) return;
    event.stopPropagation();
    this.close();
    this.#opener?.focus();
  }

  get for_everybody() {
    return this.#everybody.checked && !this.#everybody.disabled;
  }

  /** @param {boolean} may_edit */
  set_rights(may_edit) {
    this.#everybody.disabled = !may_edit;
    this.#everybody_row.title = may_edit ? '' : 'Only those who may edit the scene set its clock.';
    this.#show_rate();
  }

  /** @param {HTMLElement} opener */
  toggle(opener) {
    this.#opener = opener;
    this.element.hidden = !this.element.hidden;
    opener.setAttribute('aria-expanded', String(!this.element.hidden));
    if (this.element.hidden) return;
    keep_in_window(this.element);
    this.#fit(true);
    this.#show_rate();
  }

  close() {
    this.element.hidden = true;
    this.#opener?.setAttribute('aria-expanded', 'false');
  }

  /** @param {number} step @param {boolean} is_paused_here */
  show(step, is_paused_here) {
    this.#step = step;
    if (this.element.hidden) return;
    this.#fit(false);
    this.#slider.value = String(step);
    this.#back.disabled = !is_paused_here;
    this.#show_rate();
  }

  /** The steps that the slider goes through. @param {boolean} anew */
  #fit(anew) {
    const {loop_steps} = this.#clock;
    const [low, high] = loop_steps > 0 ? [0, loop_steps - 1] : [this.#step - reach, this.#step + reach];
    const outside = this.#step < Number(this.#slider.min) || this.#step > Number(this.#slider.max);
    if (anew || outside || (loop_steps > 0 && high !== Number(this.#slider.max))) Object.assign(this.#slider, {min: String(low), max: String(high)});
    if (anew) this.#slider.value = String(this.#step);
  }

  #show_rate() {
    this.#rate_row.classList.toggle('off', !this.for_everybody);
    this.#rate.disabled = !this.for_everybody;
    if (document.activeElement !== this.#rate) this.#rate.value = short_decimal(this.#clock.steps_per_second);
  }

  #set_rate() {
    const rate = Number(this.#rate.value);
    if (rate > 0 && rate <= 1000) this.#actions.set_clock({stepsPerSecond: rate});
    else this.#rate.value = short_decimal(this.#clock.steps_per_second);
  }
}
