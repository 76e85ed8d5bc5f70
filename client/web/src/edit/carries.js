import {Carry} from './carry.js';

/** Sprites that are drawn over the pages until these show them: what is in the hand, and what was just put down. */
export class Carries {
  #map;
  #side;
  #show;
  /** The one in the hand last. @type {Carry[]} */
  list = [];

  /**
   * @param {{texture: import('../texture.js').Texture, store: import('../page_store.js').PageStore, options: () => any, changed: () => void}} map
   * @param {() => number} side Of a pattern, in texels. @param {() => void} show After one was let go.
   */
  constructor(map, side, show) {
    this.#map = map;
    this.#side = side;
    this.#show = show;
  }

  close() {
    for (const carry of this.list) carry.close();
  }

  /**
   * Takes sprites out of the pages, and draws others in their place.
   * @param {import('./sprite.js').Sprite[]} taken @param {import('./sprite.js').Sprite[]} sprites
   */
  add(taken, sprites) {
    const {texture, store, options, changed} = this.#map;
    const others = taken.length > 0 ? this.list.flatMap(({ids}) => ids) : [];
    const carry = new Carry({texture, store, options, side: this.#side(), changed}, taken, sprites, others);
    this.list.push(carry);
    changed();
    return carry;
  }

  /** @param {Carry} carry */
  let_go(carry) {
    this.list = this.list.filter((other) => other !== carry);
    carry.close();
    this.#show();
  }

  /** A sprite as it is carried now. @param {bigint} id */
  find(id) {
    for (let i = this.list.length - 1; i >= 0; --i) {
      const carried = this.list[i].sprites.find((sprite) => sprite.id === id);
      if (carried) return carried;
    }
    return undefined;
  }

  /** What is shown of a page instead of its picture. @param {import('../texture.js').PageKey} page */
  instead(page) {
    for (let i = this.list.length - 1; i >= 0; --i) {
      const image = this.list[i].instead(page);
      if (image) return image;
    }
    return null;
  }

  /** Lets go of what the pages show by now. @param {import('../texture.js').PageKey[]} pages In view. */
  tidy(pages) {
    const done = this.list.filter((carry) => carry.revision !== null && (carry.is_late || !pages.some((page) => carry.awaits(page))));
    for (const carry of done) this.let_go(carry);
  }
}
