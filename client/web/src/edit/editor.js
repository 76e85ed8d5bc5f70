import {icon_button} from '../dom.js';
import {Carries} from './carries.js';
import {listen_to_editor_keys} from './editor_keys.js';
import {Hand, put_at} from './hand.js';
import {History} from './history.js';
import {OthersHands} from './others_hands.js';
import {Palette} from './palette.js';
import {PatternImages} from './pattern_images.js';
import {SelectionBar} from './selection_bar.js';
import {at_step, box_around, box_of, changes_between, new_sprite_id, placement_of, settled, transformed} from './sprite.js';
import {numbers_of, SpriteBook} from './sprite_book.js';
import {SpriteLayer} from './sprite_layer.js';

/** The server takes so many changes in an edit. */
const most_changes = 1024;

/** Sprites of a live scene, placed and moved by hand. Every gesture is one edit, drawn at once and undone as one. */
export class Editor {
  #live;
  #map;
  #closed = new AbortController();
  #hand;
  #texel = /** @type {{x: number, y: number} | null} */ (null);
  /** Where the pointer hovers. @type {number[] | null} */
  #pixel = null;
  #selected = /** @type {bigint[]} */ ([]);
  #placing = /** @type {number | null} */ (null);
  /** What the drag under way started from. @type {import('./sprite.js').Sprite[]} */
  #taken = [];
  /** What the drag under way carries. @type {import('./carry.js').Carry | null} */
  #carry = null;
  #others = new OthersHands({
    find: (id) => this.book?.find(id),
    take: (sprite, held) => this.carries.add([sprite], [held]),
    let_go: (carry) => this.carries.let_go(carry),
  });
  active = false;
  side = 1;
  /** @type {PatternImages | null} */
  patterns = null;
  /** @type {SpriteBook | null} */
  book = null;
  /** @type {import('./sprite.js').Sprite | undefined} */
  hovered;
  /** @type {{x0: number, y0: number, x1: number, y1: number} | null} */
  marquee = null;

  /**
   * @param {import('../live/live.js').Live} live
   * @param {{
   *   texture: import('../texture.js').Texture, store: import('../page_store.js').PageStore, canvas: HTMLElement,
   *   options: () => any, smooth: () => boolean, step: () => number, texel_at: (pixel: number[]) => {x: number, y: number} | null,
   *   resolution: () => number, view: () => {x0: number, y0: number, x1: number, y1: number} | null,
   *   changed: () => void, say: (text: string) => void, hold_still: (still: boolean) => void
   * }} map `hold_still`: whether double clicks and frames are left to the editor.
   */
  constructor(live, map) {
    this.#live = live;
    this.#map = map;
    this.carries = new Carries(map, () => this.side, () => this.#show());
    this.layer = new SpriteLayer(this, map.texture, map.store);
    this.#hand = new Hand(this, map.canvas, this.#closed.signal);
    this.history = new History((changes) => live.edit(changes));
    this.button = icon_button('Edit (E)', 'pencil', () => this.toggle(), {'aria-pressed': 'false', hidden: true});
    this.palette = new Palette({choose: (pattern) => this.choose(pattern), undo: () => this.undo(), redo: () => this.redo()});
    this.bar = new SelectionBar({
      scale_to: (scale) => this.#change_each((sprite) => settled({...sprite, scale})),
      turn_to: (turn) => this.#change_each((sprite) => settled({...sprite, turn})),
      raise: (up) => this.raise(up),
      duplicate: () => this.duplicate(),
      remove: () => this.remove(),
    });
    const until = {signal: this.#closed.signal};
    this.history.addEventListener('change', () => this.#show_history(), until);
    live.addEventListener('rights', () => this.#follow_rights(), until);
    live.addEventListener('edit', (event) => this.#heard(/** @type {CustomEvent} */ (event).detail), until);
    live.people.addEventListener('moved', () => this.#follow_others(), until);
    listen_to_editor_keys(this, () => this.#map.resolution(), this.#closed.signal);
  }

  close() {
    this.#closed.abort();
    this.#others.close();
    this.patterns?.close();
    this.book?.close();
    this.carries.close();
  }

  get smooth() {
    return this.#map.smooth();
  }

  get is_dragging() {
    return this.#hand.is_dragging;
  }

  /** @returns {import('./sprite.js').Sprite[]} As they are drawn now. */
  get selection() {
    return this.#selected.map((id) => this.#now(id)).filter((sprite) => sprite !== undefined);
  }

  /** A sprite where and as it is at the step that is shown. @param {import('./sprite.js').Sprite} sprite */
  now(sprite) {
    const step = this.#map.step();
    const there = at_step(sprite, step);
    if (!this.patterns || sprite.more?.animation === undefined) return there;
    this.patterns.prepare(sprite);
    return {...there, pattern: this.patterns.shown(sprite, step)};
  }

  /** The sprite that a click would place. */
  get placing() {
    return this.#placing === null || !this.#texel ? null : settled({id: 0n, pattern: this.#placing, ...this.#texel, scale: 1, turn: 0, order: 0, path: null, first_step: -Infinity, end_step: Infinity});
  }

  /** What others have in their hands or have selected, as it is drawn now. @returns {{sprite: import('./sprite.js').Sprite, colour: string, held: boolean}[]} */
  get others() {
    const held = this.#others.held;
    const selected = [...this.#live.people.here.values()].flatMap(({colour, selected}) =>
      selected.filter((id) => !held.some(({sprite}) => sprite.id === id)).map((id) => ({sprite: this.book?.find(id), colour, held: false})));
    return /** @type {any} */ ([...selected.filter(({sprite}) => sprite !== undefined), ...held.map((hand) => ({...hand, held: true}))]);
  }

  // ---- What the map asks

  /** @param {number[]} pixel */
  texel_at(pixel) {
    return this.#map.texel_at(pixel);
  }

  /** @param {{x: number, y: number}} texel */
  sprite_at(texel) {
    return this.book?.at(texel, this.#map.resolution(), this.#map.step());
  }

  /** After each frame. @param {{x0: number, y0: number, x1: number, y1: number}} view */
  look_at(view) {
    if (this.active || this.#others.hold_something) this.book?.look_at(view);
  }

  // ---- The mode

  toggle() {
    if (!this.active && !this.#live.may_edit) {
      this.#map.say(this.#live.why_not || 'This scene cannot be edited from here');
      return;
    }
    if (!this.patterns) return;
    this.active = !this.active;
    if (!this.active) this.#leave();
    this.#map.hold_still(this.active);
    this.button.setAttribute('aria-pressed', String(this.active));
    this.palette.element.hidden = !this.active;
    this.#map.canvas.classList.toggle('editing', this.active);
    const view = this.#map.view();
    if (this.active && view) this.book?.look_at(view);
    this.#show();
  }

  /** Places a pattern from now on; null: takes hold of sprites. @param {number | null} pattern */
  choose(pattern) {
    this.#placing = pattern;
    if (pattern !== null) this.#select([]);
    this.palette.check(pattern);
    this.#show();
  }

  // ---- What the hand does

  /** @param {number[] | null} pixel @param {{x: number, y: number} | null} texel */
  hover(pixel, texel) {
    this.#pixel = pixel;
    this.#texel = texel;
    const handle = pixel && this.#placing === null ? this.layer.handle_at(pixel) : null;
    this.hovered = texel && this.#placing === null && !handle ? this.sprite_at(texel) : undefined;
    this.#map.canvas.dataset.cursor = handle ? handle.kind : this.#placing !== null ? 'place' : this.hovered ? 'move' : '';
    if (this.active) this.#map.changed();
  }

  /** A press on a sprite. @param {import('./sprite.js').Sprite} sprite @param {boolean} add */
  take_hold(sprite, add) {
    if (!this.#selected.includes(sprite.id)) this.#select(add ? [...this.#selected, sprite.id] : [sprite.id]);
    this.#begin_carry();  // so that the page without it is here when the drag begins
  }

  /** A click on a sprite that was no drag. @param {import('./sprite.js').Sprite} sprite @param {boolean} add */
  clicked_sprite(sprite, add) {
    const fresh = this.#fresh_hold;
    this.drop_nothing();
    if (add && !fresh) this.#select(this.#selected.filter((id) => id !== sprite.id));
    else if (!add) this.#select([sprite.id]);
  }

  /** @param {{dx?: number, dy?: number, scale?: number, turn?: number, about?: {x: number, y: number}}} how */
  drag(how) {
    if (!this.#carry) this.#begin_carry();
    const carry = this.#carry;
    if (!carry) return;
    carry.sprites = transformed(this.#taken, how);
    this.#live.be_at({held: carry.sprites.length === 1 ? placement_of(carry.sprites[0]) : undefined});
    this.#show();
  }

  /** The drag ends here. */
  drop() {
    const carry = this.#carry, taken = this.#taken;
    this.#carry = null;
    this.#live.be_at({held: undefined});
    if (!carry) return;
    this.#put(carry, taken);
  }

  /** Nothing came of it. */
  drop_nothing() {
    if (this.#carry) this.carries.let_go(this.#carry);
    this.#carry = null;
    this.marquee = null;
    this.#live.be_at({held: undefined});
    this.#show();
  }

  /** @param {{x: number, y: number}} a @param {{x: number, y: number}} b */
  draw_frame(a, b) {
    this.marquee = {x0: Math.min(a.x, b.x), y0: Math.min(a.y, b.y), x1: Math.max(a.x, b.x), y1: Math.max(a.y, b.y)};
    this.#map.changed();
  }

  /** @param {{x: number, y: number}} a @param {{x: number, y: number}} b @param {boolean} moved */
  select_in_frame(a, b, moved) {
    if (moved) this.draw_frame(a, b);
    const box = this.marquee;
    this.marquee = null;
    if (box) this.#select([...new Set([...this.#selected, ...(this.book?.within(box, this.#map.step()) ?? []).map(({id}) => id)])].slice(0, most_changes));
    this.#show();
  }

  /** A click beside all sprites. @param {{x: number, y: number}} at @param {boolean} add */
  click(at, add) {
    this.#texel = at;
    const placing = this.placing;
    if (placing) this.place(put_at({...placing, id: new_sprite_id()}, at));
    else if (!add) this.#select([]);
  }

  // ---- Edits

  /** @param {import('./sprite.js').Sprite} sprite */
  place(sprite) {
    const {x, y} = sprite;
    const side = this.#map.texture.side_texels;
    if (x < 0 || y < 0 || x >= side || y >= side) return this.#map.say('That is outside of the texture');
    this.#make([{change: {case: 'placeSprite', value: placement_of(sprite)}}], this.carries.add([], [sprite]));
  }

  remove() {
    const gone = this.selection;
    if (gone.length === 0) return;
    this.#select([]);
    this.#make(gone.map(({id}) => ({change: {case: 'removeSprite', value: {id}}})), this.carries.add(gone, []));
  }

  duplicate() {
    const {selection} = this;
    if (selection.length === 0) return;
    const {x0, x1} = box_around(selection.map((sprite) => box_of(this.now(sprite), this.side)));
    const shift = Math.max(8, Math.min((x1 - x0) / 4, 24 * this.#map.resolution()));
    const copies = transformed(selection, {dx: shift, dy: shift}).map((sprite) => ({...sprite, id: new_sprite_id()}));
    this.#make(copies.map((sprite) => ({change: {case: 'placeSprite', value: placement_of(sprite)}})), this.carries.add([], copies));
    this.#select(copies.map(({id}) => id));
  }

  /** In front of all that it meets, or behind. @param {boolean} up */
  raise(up) {
    const {selection, book} = this;
    if (selection.length === 0 || !book) return;
    const others = book.list.filter(({id}) => !this.#selected.includes(id)).map(({order}) => order);
    const order = others.length === 0 ? 0 : up ? Math.max(...others) + 1 : Math.min(...others) - 1;
    this.#change_each((sprite) => ({...sprite, order}));
  }

  async undo() {
    await this.#try(() => this.history.undo());
  }

  async redo() {
    await this.#try(() => this.history.redo());
  }

  /** @param {(sprite: import('./sprite.js').Sprite) => import('./sprite.js').Sprite} change */
  #change_each(change) {
    const taken = this.selection;
    this.#put(this.carries.add(taken, taken.map(change)), taken);
  }

  /** Makes what a carry has done to the sprites that were taken. @param {import('./carry.js').Carry} carry @param {import('./sprite.js').Sprite[]} taken */
  #put(carry, taken) {
    const changes = carry.sprites.flatMap((sprite, i) => changes_between(taken[i], sprite));
    if (changes.length === 0) this.carries.let_go(carry);
    else this.#make(changes, carry);
  }

  /** @param {any[]} changes @param {import('./carry.js').Carry} carry */
  async #make(changes, carry) {
    this.#show();
    const answer = await this.#try(() => this.#live.edit(changes));
    if (!answer) return this.carries.let_go(carry);
    this.history.done(answer);
    carry.put_down(Number(answer.revision), answer.dirty.map(numbers_of));
    this.#show();
  }

  /** @template T @param {() => Promise<T>} act @returns {Promise<T | null>} */
  async #try(act) {
    try {
      return await act();
    } catch (error) {
      if (!this.#closed.signal.aborted) this.#map.say(/** @type {Error} */ (error).message);
      return null;
    }
  }

  /** Lets go, deselects, leaves: one of them at a time. */
  escape() {
    if (this.#hand.cancel()) return;
    if (this.#placing !== null) this.choose(null);
    else if (this.#selected.length > 0) this.#select([]);
    else this.toggle();
  }

  select_all() {
    const view = this.#map.view();
    if (view && this.book) this.#select(this.book.within(view, this.#map.step()).map(({id}) => id).slice(0, most_changes));
  }

  // ---- What is in the hand

  get #fresh_hold() {
    return this.#was_selected !== this.#selected.length;
  }
  #was_selected = 0;

  #begin_carry() {
    if (this.#carry) this.carries.let_go(this.#carry);
    this.#taken = this.selection;
    this.#carry = this.carries.add(this.#taken, this.#taken);
  }

  /** A sprite as it is drawn now. @param {bigint} id */
  #now(id) {
    return this.carries.find(id) ?? this.book?.find(id);
  }

  /** @param {bigint[]} ids */
  #select(ids) {
    this.#was_selected = this.#selected.length;
    this.#selected = ids;
    this.#live.be_at({selected: ids.slice(0, 64)});
    this.#show();
  }

  #leave() {
    this.#hand.cancel();
    this.#placing = null;
    this.palette.check(null);
    this.hovered = undefined;
    this.#select([]);
    delete this.#map.canvas.dataset.cursor;
  }

  // ---- What is heard

  #follow_rights() {
    const {patterns, pattern_side: side, may_edit, takes_edits, stream} = this.#live;
    const has_sprites = patterns.length > 0 && takes_edits;
    this.button.hidden = !has_sprites || !stream?.open;
    this.button.classList.toggle('locked', !may_edit);
    if (this.active && (!may_edit || !has_sprites)) this.toggle();
    if (!has_sprites || !stream?.open) return;
    if (this.patterns?.side === side && this.patterns.count === patterns.length) return this.book?.forget();
    this.patterns?.close();
    this.book?.close();
    this.side = side;
    this.patterns = new PatternImages(this.#map.texture, patterns, side, () => {
      if (this.patterns) this.palette.show_images(this.patterns);
      this.#map.changed();
    });
    this.book = new SpriteBook(this.#map.texture, this.patterns);
    this.book.addEventListener('change', () => {
      if (this.active && !this.is_dragging) this.hover(this.#pixel, this.#texel);  // the cursor says what a press would take
      this.#others.follow(this.#live.people.here);
      this.#show();
    });
    this.palette.offer(this.patterns);
  }

  /** @param {{done: any, changes: any[]}} news */
  #heard({done, changes}) {
    if (!done.answer || done.answer.again) return;
    const revision = Number(done.answer.revision);
    this.#others.edited(Number(done.session), changes, revision, done.answer.dirty.map(numbers_of));
    this.book?.take(changes, revision, done.answer.dirty);
  }

  #follow_others() {
    this.#others.follow(this.#live.people.here);
    this.#map.changed();
  }

  #show_history() {
    this.palette.undo.disabled = !this.history.can_undo;
    this.palette.redo.disabled = !this.history.can_redo;
  }

  #show() {
    this.#selected = this.#selected.filter((id) => this.#now(id) !== undefined);
    if (this.patterns) this.bar.show(this.active ? this.selection : [], (pattern) => this.patterns?.name(pattern) ?? '');
    this.palette.hint(
      this.book?.partial ? 'Many sprites: come closer to take hold of them.'
      : this.#placing !== null ? 'Click to place, Escape ends.'
      : this.#selected.length > 0 ? 'Drag to move; corners scale, the knob turns.'
      : 'Pick one to place, or take hold of a sprite. Shift frames several.');
    this.#map.changed();
  }

  /** All that is selected, about its common middle. @param {{dx?: number, dy?: number, turn?: number}} how */
  change_together(how) {
    const taken = this.selection;
    if (taken.length === 0) return;
    const {x0, y0, x1, y1} = box_around(taken.map((sprite) => box_of(this.now(sprite), this.side)));
    this.#put(this.carries.add(taken, transformed(taken, {about: {x: (x0 + x1) / 2, y: (y0 + y1) / 2}, ...how})), taken);
  }
}
