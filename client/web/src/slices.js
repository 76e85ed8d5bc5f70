import {element, icon_button} from './dom.js';

/** What the server takes: slices lie within ±2^40. */
const farthest = 2 ** 40;

/** A slider with more slices than this could not be set to each of them. */
const most_on_a_slider = 1024;

/**
 * The slice to show when `slice` is asked for: one from 0 on where the texture repeats after `slices`, any where it
 * never does (0), the only one there is (1).
 * @param {number} slice @param {number} slices
 */
export function slice_within(slice, slices) {
  if (!Number.isFinite(slice)) return 0;
  const whole = Math.round(slice);
  if (slices === 0) return Math.min(farthest, Math.max(-farthest, whole)) + 0;
  return ((whole % slices) + slices) % slices;
}

/** The slice that an address asks for, if the texture has it. @param {string | undefined} asked @param {number} slices */
export const slice_chosen = (asked, slices) => slice_within(asked !== undefined && /^-?\d+$/.test(asked) ? Number(asked) : 0, slices);

/** One number through the third dimension of a texture; not there at all for a flat one. */
export class SliceControl {
  #change;
  #slices = 1;
  #number = element('input', {type: 'number', class: 'slice-number', step: 1, 'aria-label': 'Slice', onchange: () => this.#typed(this.#number)});
  #slider = element('input', {
    type: 'range',
    class: 'slice-slider',
    min: 0,
    step: 1,
    'aria-label': 'Slice, along the whole texture',
    oninput: () => this.#typed(this.#slider),
  });
  element = element(
    'fieldset',
    {class: 'panel slices', 'aria-label': 'Slice (comma and full stop)'},
    element('span', {class: 'slice-label', 'aria-hidden': 'true', text: 'Slice'}),
    icon_button('Slice before (,)', 'minus', () => this.step(-1)),
    this.#slider,
    this.#number,
    icon_button('Next slice (.)', 'plus', () => this.step(1)),
  );

  /** @param {(slice: number) => void} change Told each slice that is chosen here. */
  constructor(change) {
    this.#change = change;
  }

  /** @param {number} slices After how many the texture repeats; 1: it is flat, 0: never. @param {number} chosen */
  offer(slices, chosen) {
    this.#slices = slices;
    this.element.hidden = slices === 1;
    this.#slider.hidden = slices === 0 || slices > most_on_a_slider;
    this.#slider.max = String(Math.max(1, slices - 1));
    this.show(chosen);
  }

  /** @param {number} slice */
  show(slice) {
    this.#number.value = String(slice);
    this.#slider.value = String(slice);
  }

  /** @param {number} slices Forwards or back, round and round where the texture repeats. */
  step(slices) {
    this.#change(slice_within(Number(this.#number.value) + slices, this.#slices));
  }

  /** @param {any} input */
  #typed(input) {
    const slice = slice_within(input.value === '' ? NaN : Number(input.value), this.#slices);
    this.show(slice);
    this.#change(slice);
  }
}
