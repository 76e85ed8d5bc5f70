import {EditNews} from './edit_news.js';
import {EditsOut} from './edits_out.js';
import {Cursors} from './cursors.js';
import {kept_name, kept_token} from './identity.js';
import {People} from './people.js';
import {PeoplePanel} from './people_panel.js';
import {RevisionSign} from './revision_sign.js';
import {Stream} from './stream.js';
import {Watch} from './watch.js';

/** Between two words of where the hand is. */
const presence_pause = 50;
/** Where there is no stream, this often it is asked whether anything changed. */
const ask_every = 5000;

/**
 * What a scene's stream brings to the page: invalidations to the store, the clock, the others and their edits. Where there
 * is none, the page goes on without. Fires `rights` when it is told who may edit.
 */
export class Live extends EventTarget {
  #texture;
  #store;
  #clock;
  #page;
  #closed = new AbortController();
  #poll = 0;
  #presence_timer = 0;
  /** @type {any} */
  #presence = {};
  #goodbye = '';
  #session = 0;
  people = new People();
  news = new EditNews();
  name = kept_name.get();
  token = kept_token.get();
  may_edit = false;
  takes_edits = false;
  why_not = '';
  /** @type {string[]} Names of the sprites' patterns. */
  patterns = [];
  pattern_side = 0;

  /**
   * @param {import('../texture.js').Texture} texture
   * @param {import('../page_store.js').PageStore} store
   * @param {import('./scene_clock.js').SceneClock} clock
   * @param {{
   *   stale: () => void, place: (texel: {x: number, y: number}) => number[] | null,
   *   go: (place: {x: number, y: number, level?: number, side?: number}) => void
   * }} page `stale`: the scene is to be read anew.
   */
  constructor(texture, store, clock, page) {
    super();
    this.#texture = texture;
    this.#store = store;
    this.#clock = clock;
    this.#page = page;
    this.sign = new RevisionSign(this.news, page.go);
    this.cursors = new Cursors(this.people, page.place);
    this.panel = new PeoplePanel(this.people, {
      name: this.name,
      rename: (name) => this.#rename(name),
      use_token: (token) => this.#use_token(token),
      go: ({at, level}) => at && page.go({...at, level}),
    });
    this.stream = texture.stream ? new Stream(texture.stream, () => ({name: this.name, token: this.token})) : null;
    this.watch = this.stream && new Watch(this.stream, store, texture.coarsest_level);
    this.edits = this.stream && new EditsOut(this.stream, () => this.name);
    if (this.stream) this.#listen(this.stream);
    this.#show();
  }

  open() {
    this.stream?.connect();
  }

  close() {
    this.#closed.abort();
    clearInterval(this.#poll);
    clearTimeout(this.#presence_timer);
    this.edits?.close();
    this.stream?.close();
    this.watch?.close();
    this.cursors.close();
    this.sign.close();
  }

  /** @param {import('../texture.js').Texture} texture The same, as it is described now. */
  set_texture(texture) {
    this.#texture = texture;
    this.#show();
  }

  /** Makes an edit; see EditsOut. @param {any[]} changes @returns {Promise<any>} */
  edit(changes) {
    return this.edits ? this.edits.make(changes, this.#store.revision) : Promise.reject(new Error('There is no live stream to send edits by.'));
  }

  /** Tells the others where the hand is and what is in it. @param {any} presence Parts of a Presence; what is left out stays. */
  be_at(presence) {
    Object.assign(this.#presence, presence);
    if (this.#presence_timer || !this.stream?.open) return;
    this.#presence_timer = setTimeout(() => {
      this.#presence_timer = 0;
      this.stream?.send('presence', this.#presence);
    }, presence_pause);
  }

  /** @param {Stream} stream */
  #listen(stream) {
    const until = {signal: this.#closed.signal};
    const on = (/** @type {string} */ kind, /** @type {(value: any) => void} */ act) =>
      stream.addEventListener(kind, (event) => act(/** @type {CustomEvent} */ (event).detail), until);
    on('hello', (hello) => this.#greeted(hello));
    on('replaced', ({hello}) => {
      if (hello) this.#take_hello(hello);
      this.news.clear();
      this.#page.stale();
    });
    on('clock', (clock) => this.#clock.follow(clock));
    on('present', (present) => this.people.tell(present));
    on('editDone', (done) => this.#told_of_edit(done));
    on('invalidation', ({revision}) => this.#heard_of(Number(revision)));
    on('goodbye', ({detail}) => (this.#goodbye = detail));
    stream.addEventListener('state', () => {
      clearInterval(this.#poll);
      if (stream.state === 'absent') this.#poll = setInterval(() => !document.hidden && this.#page.stale(), ask_every);
      if (!stream.open) this.people.clear();
      this.panel.element.hidden = !stream.open;
      this.#show();
      if (!stream.open) this.dispatchEvent(new Event('rights'));
    }, until);
  }

  /** @param {any} hello */
  #greeted(hello) {
    this.#goodbye = '';
    this.people.clear();
    this.#session = Number(hello.session);
    this.#take_hello(hello);
    const revision = Number(hello.revision);
    if (hello.fingerprint && this.#texture.tells_fingerprint && hello.fingerprint !== this.#texture.fingerprint) this.#page.stale();
    else if (!hello.resumed && revision !== this.#store.told) this.#store.doubt_all(revision);
    if (this.watch) {
      this.watch.limits = hello.limits ?? this.watch.limits;
      this.watch.begin();
    }
    this.#heard_of(revision);
    this.panel.show();
    this.be_at({});
  }

  /** @param {any} hello */
  #take_hello(hello) {
    this.may_edit = hello.mayEdit;
    this.takes_edits = hello.takesEdits;
    this.why_not = hello.whyNot;
    this.patterns = hello.patterns;
    this.pattern_side = hello.patternSideTexels;
    if (hello.clock) this.#clock.follow(hello.clock);
    this.panel.set_rights(this);
    this.dispatchEvent(new Event('rights'));
  }

  /** @param {any} done */
  #told_of_edit(done) {
    const session = Number(done.session);
    const mine = session !== 0 && session === this.#session;
    const changes = mine ? this.edits?.changes_of(done.id) : undefined;
    this.#heard_of(Number(done.answer?.revision ?? 0));
    this.news.tell(done, {who: mine ? 'You' : this.people.name_of(session, done.author), mine, changes});
    this.dispatchEvent(new CustomEvent('edit', {detail: {done, mine, changes: changes ?? done.changes}}));
    this.edits?.done(done.id, done.answer);
  }

  /** @param {number} revision */
  #heard_of(revision) {
    this.#store.revision = Math.max(this.#store.revision, revision);
    this.#show();
  }

  #show() {
    const {state} = this.stream ?? {state: /** @type {const} */ ('absent')};
    if (this.stream || this.#texture.revision > 0) this.sign.show(this.#store.revision, state, state === 'open' ? '' : this.#goodbye);
  }

  /** @param {string} name */
  #rename(name) {
    if (name === this.name) return;
    this.name = name;
    kept_name.set(name);
    this.stream?.connect();  // one is called as one says in the hello
  }

  /** @param {string} token */
  #use_token(token) {
    this.token = token;
    kept_token.set(token);
    this.stream?.connect();
  }
}
