import {sprite_of} from './sprite.js';

/** How long an edit may follow a hand that has let go. */
const put_down_within = 1000;

/**
 * What others have in their hands, carried here as they carry it: the pages show the sprite no more where it was, until
 * they show it where it was put.
 */
export class OthersHands {
  /** @type {Map<number, {id: bigint, carry: import('./carry.js').Carry, colour: string, let_go_at: number | null}>} By session. */
  #hands = new Map();
  #act;

  /**
   * @param {{
   *   find: (id: bigint) => import('./sprite.js').Sprite | undefined,
   *   take: (sprite: import('./sprite.js').Sprite, held: import('./sprite.js').Sprite) => import('./carry.js').Carry,
   *   let_go: (carry: import('./carry.js').Carry) => void
   * }} act
   */
  constructor(act) {
    this.#act = act;
  }

  /** Whether somebody holds something, so that it is worth knowing what lies where. */
  hold_something = false;

  /** What is drawn around: with its colour. @returns {{sprite: import('./sprite.js').Sprite, colour: string}[]} */
  get held() {
    return [...this.#hands.values()].filter(({let_go_at}) => let_go_at === null).map(({carry, colour}) => ({sprite: carry.sprites[0], colour}));
  }

  /** @param {Map<number, import('../live/people.js').Person>} here */
  follow(here) {
    this.hold_something = [...here.values()].some(({held}) => held);
    for (const [session, hand] of this.#hands) {
      const held = here.get(session)?.held;
      if (held && BigInt(held.id) === hand.id) continue;
      hand.let_go_at ??= performance.now();
      setTimeout(() => this.#tidy(), put_down_within + 50);
    }
    for (const {session, held, colour} of here.values()) {
      if (!held) continue;
      const sprite = sprite_of(held);
      const hand = this.#hands.get(session);
      if (hand?.id === sprite.id && hand.let_go_at === null) {
        hand.carry.sprites = [sprite];
        continue;
      }
      const there = this.#act.find(sprite.id);
      if (!there) continue;  // not known yet, or gone
      if (hand) this.#forget(session);
      this.#hands.set(session, {id: sprite.id, carry: this.#act.take(there, sprite), colour, let_go_at: null});
    }
  }

  /** Somebody's edit was made. @param {number} session @param {any[]} changes @param {number} revision @param {any[]} dirty */
  edited(session, changes, revision, dirty) {
    const hand = this.#hands.get(session);
    if (!hand || !changes.some(({change: {value}}) => value?.id === hand.id)) return;
    hand.carry.put_down(revision, dirty);
    this.#hands.delete(session);  // whoever draws carries lets go of it when the pages show it
  }

  close() {
    for (const session of [...this.#hands.keys()]) this.#forget(session);
  }

  #tidy() {
    const now = performance.now();
    for (const [session, {let_go_at}] of this.#hands) if (let_go_at !== null && now - let_go_at >= put_down_within) this.#forget(session);
  }

  /** @param {number} session */
  #forget(session) {
    const hand = this.#hands.get(session);
    this.#hands.delete(session);
    if (hand) this.#act.let_go(hand.carry);
  }
}
