import {element} from './dom.js';

/** What pages show unless something else is asked for; every scene has it. */
export const usual_channels = 'albedo';

/** What a channel set is called, and what its texels mean. @type {Record<string, {name: string, meaning: string}>} */
const channel_words = {
  albedo: {name: 'Albedo', meaning: 'Colour'},
  normal: {name: 'Normal', meaning: 'Unit normals of the mean slopes: red to the right, green up, blue out of the surface'},
  roughness: {name: 'Roughness', meaning: 'Lighter is rougher. Bumps too small for a level make its texels rougher'},
  height: {name: 'Height', meaning: 'Lighter is higher'},
  moments: {name: 'Moments', meaning: 'How the slopes under a texel spread: red across, green upwards, blue how the two go together'},
};

/** @param {string} set */
export const channel_name = (set) => channel_words[set]?.name ?? set;

/** The set that an address asks for, if the texture has it. @param {string | undefined} asked @param {string[]} sets */
export const channels_chosen = (asked, sets) => (asked !== undefined && sets.includes(asked) ? asked : usual_channels);

/** The channel sets of a texture, side by side; not there at all for a texture of colour alone. */
export class ChannelSelector {
  #segments = element('div', {class: 'segments'});
  #change;
  element = element('fieldset', {class: 'panel channels', 'aria-label': 'Channels (M)'}, this.#segments);

  /** @param {(set: string) => void} change */
  constructor(change) {
    this.#change = change;
  }

  /** @param {string[]} sets @param {string} chosen */
  offer(sets, chosen) {
    this.element.hidden = sets.length < 2;
    this.#segments.replaceChildren(
      ...sets.map((set) => {
        const radio = element('input', {type: 'radio', name: 'channels', value: set, onchange: () => this.#change(set)});
        return element('label', {title: channel_words[set]?.meaning}, radio, element('span', {text: channel_name(set)}));
      }),
    );
    this.check(chosen);
  }

  /** @param {string} set */
  check(set) {
    for (const radio of this.#segments.querySelectorAll('input')) radio.checked = radio.value === set;
  }
}
