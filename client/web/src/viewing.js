import {channel_name, channels_chosen, ChannelSelector, usual_channels} from './channels.js';
import {with_separators} from './numbers.js';
import {choices, chosen, options_menu} from './options_menu.js';
import {slice_chosen, slice_within, SliceControl} from './slices.js';

/** How a texture is looked at, wherever: options, channels and slice, and the controls that choose them. */
export class Viewing {
  #act;
  #record = 0;

  /**
   * @param {import('./texture.js').Texture} texture @param {Record<string, string>} options Of the address.
   * @param {{ask: () => void, texels: (smooth: boolean) => void, chosen: () => void, say: (text: string) => void}} act
   *   `ask`: pages are wanted otherwise; `chosen`: by a person, so that the address is to name it.
   */
  constructor(texture, options, act) {
    this.#act = act;
    this.texture = texture;
    this.options = chosen(options);
    this.channels = channels_chosen(options.channels, texture.channels);
    this.slice = slice_chosen(options.slice, texture.slices);
    this.menu = options_menu(this.options, texture.formats, (name, value) => {
      this.#set_option(name, value);
      act.chosen();
    });
    this.selector = new ChannelSelector((set) => this.#choose_channels(set));
    this.selector.offer(texture.channels, this.channels);
    this.slices = new SliceControl((slice) => this.#choose_slice(slice));
    this.slices.offer(texture.slices, this.slice);
  }

  get smooth() {
    return this.options.texels === 'smooth';
  }

  /** What pages are asked for with, but for the step. */
  get request() {
    const {format, accuracy} = this.options;
    return {format, accuracy, channels: this.channels, slice: this.slice};
  }

  /** What an address says of it: nothing where it is as usual. @returns {Record<string, string>} */
  get in_address() {
    const options = Object.fromEntries(Object.entries(this.options).filter(([name, value]) => value !== choices[name].default));
    if (this.channels !== usual_channels) options.channels = this.channels;
    if (this.slice !== 0) options.slice = String(this.slice);
    return options;
  }

  /** Takes over what an address says. @param {Record<string, string>} options */
  take(options) {
    for (const [name, value] of Object.entries(chosen(options))) this.#set_option(name, value);
    this.#set_channels(channels_chosen(options.channels, this.texture.channels));
    this.#set_slice(slice_chosen(options.slice, this.texture.slices));
  }

  /** The texture as it is described now. @param {import('./texture.js').Texture} texture */
  refresh(texture) {
    this.texture = texture;
    this.#set_channels(channels_chosen(this.channels, texture.channels));
    this.selector.offer(texture.channels, this.channels);
    this.#set_slice(slice_within(this.slice, texture.slices));
    this.slices.offer(texture.slices, this.slice);
  }

  close() {
    clearTimeout(this.#record);
  }

  /** Between crisp and smooth texels. */
  toggle_texels() {
    this.#set_option('texels', this.smooth ? 'crisp' : 'smooth');
    this.#act.chosen();
    this.#act.say(`Magnified texels: ${choices.texels.values[this.options.texels].toLowerCase()}`);
  }

  /** @param {number} steps Along the sets that the texture has, round and round. */
  next_channels(steps) {
    const sets = this.texture.channels;
    if (sets.length < 2) return this.#act.say('This scene has its colour alone');
    this.#choose_channels(sets[(sets.indexOf(this.channels) + steps + sets.length) % sets.length]);
    this.#act.say(`Channels: ${channel_name(this.channels).toLowerCase()}`);
  }

  /** @param {number} slices */
  step_slice(slices) {
    if (this.texture.slices === 1) return this.#act.say('This scene is flat: it has one slice');
    this.slices.step(slices);
    this.#act.say(`Slice ${with_separators(this.slice)}`);
  }

  /** @param {string} name @param {string} value */
  #set_option(name, value) {
    if (this.options[name] === value) return;
    this.options[name] = value;
    this.menu.check(name, value);
    if (name === 'texels') this.#act.texels(this.smooth);
    else this.#act.ask();
  }

  /** @param {string} set That the texture has. */
  #set_channels(set) {
    if (this.channels === set) return;
    this.channels = set;
    this.selector.check(set);
    this.#act.ask();
  }

  /** @param {string} set */
  #choose_channels(set) {
    this.#set_channels(set);
    this.#act.chosen();
  }

  /** @param {number} slice That the texture has. */
  #set_slice(slice) {
    if (this.slice === slice) return;
    this.slice = slice;
    this.slices.show(slice);
    this.#act.ask();
  }

  /** @param {number} slice */
  #choose_slice(slice) {
    this.#set_slice(slice);
    clearTimeout(this.#record);  // browsers ration changes of the address, and a slider makes many
    this.#record = setTimeout(() => this.#act.chosen(), 120);
  }
}
