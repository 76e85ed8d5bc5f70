import {fetch_page} from './page_fetch.js';
import {Refused} from './server.js';
import {key_text} from './texture.js';

/** A page that nobody looks at for this long is no longer waited for. */
const patience_milliseconds = 200;
/** Pages that are kept; those in view always are. */
const most_pages = 384;
const most_requests = 12;
/** Of a page that moves: the one that is shown, and those that come next. */
const most_slots = 4;
/** A page may change again between hearing of it and asking for it: so often it is asked for anew at once. */
const most_overtaken = 4;
const settled_after = 2000;

/**
 * One picture of a page: right for the steps [from, until), with all edits up to `revision` that touched the page.
 * `look` is everything else it depends on.
 * @typedef {{image: ImageBitmap, revision: number, from: number, until: number, look: string}} Slot
 */

/** All that is known of one page. */
class Entry {
  /** @type {Slot | null} What is on screen: stays until something better is decoded. */
  shown = null;
  /** @type {Slot[]} Pictures of other steps. */
  slots = [];
  /** When its first picture came: it fades in from then on. */
  born = 0;
  /** The page's own revision, as far as it is told: pictures of earlier ones are out of date. */
  least = 0;
  /** Whether `least` is the page's own revision now, so that its immutable address is known. */
  sure = false;
  /** @type {number | null} The scene's revision up to which `least` is known; null while the page is watched: up to now. */
  seen;
  /** Asks for it that found it changed once more. */
  overtaken = 0;
  failed = false;
  /** @type {{abort: AbortController, step: number, unwanted_since: number} | null} */
  request = null;
  wanted = false;

  /** @param {import('./texture.js').PageKey} page @param {number} told */
  constructor(page, told) {
    this.page = page;
    this.seen = told;
  }

  /** The picture that is right for a step, if it is here. @param {number} step @param {string} look @returns {Slot | undefined} */
  right_for(step, look) {
    const is_right = (/** @type {Slot | null} */ slot) =>
      slot !== null && slot.look === look && slot.revision >= this.least && slot.from <= step && step < slot.until;
    return is_right(this.shown) ? /** @type {Slot} */ (this.shown) : this.slots.find(is_right);
  }
}

/**
 * The pages of one texture as the view wants them. Each has at most one request under way, and its old picture stays
 * until the new one is decoded: what changes, changes from one frame to the next. Fires `change` when a frame would
 * show something else.
 */
export class PageStore extends EventTarget {
  #texture;
  #ledger;
  #options;
  /** @type {Map<string, Entry>} The latest wanted last. */
  #entries = new Map();
  /** @type {Entry[]} What the last frame wanted, the most urgent first; and how many of them it shows. */
  #wanted = [];
  #in_view = 0;
  /** @type {number[]} Steps that are to come. */
  #coming = [];
  #requests = 0;
  /** The scene's revision, as far as anybody spoke of it. */
  revision = 0;
  #news_at = -Infinity;
  /** Up to this revision it is told which pages changed. */
  told = 0;
  /** How long pages took lately, in milliseconds. */
  latency = 60;

  /**
   * @param {import('./texture.js').Texture} texture
   * @param {import('./page_ledger.js').PageLedger} ledger
   * @param {{format: string, accuracy: string, channels: string, slice: number, step: number}} options
   * @param {() => void} on_stale The server no longer knows the texture that is asked for.
   */
  constructor(texture, ledger, options, on_stale) {
    super();
    this.#texture = texture;
    this.#ledger = ledger;
    this.#options = {...options};
    this.on_stale = on_stale;
    this.revision = this.told = texture.revision;
  }

  get step() {
    return this.#options.step;
  }

  /** From now on pages are asked for with these; those on screen stay until the new ones are there. @param {any} options */
  set_request({format, accuracy, channels, slice}) {
    Object.assign(this.#options, {format, accuracy, channels, slice});
    this.#renew();
  }

  /** The server describes the texture anew. @param {import('./texture.js').Texture} texture */
  set_texture(texture) {
    const other = texture.fingerprint !== this.#texture.fingerprint;
    const newer = texture.revision > this.revision;
    this.#texture = texture;
    this.revision = other ? texture.revision : Math.max(this.revision, texture.revision);
    if (other) this.#renew(true);
    else if (newer) this.doubt_all();
  }

  /** Shows a step: from pictures that are here, the others are asked for. @param {number} step */
  set_step(step) {
    this.#options.step = step;
    this.#coming = [];
    for (const entry of this.#wanted) {
      this.#show_best(entry);
      entry.failed = false;
    }
    this.#ask();
    this.#changed();
  }

  /** Asks ahead for what these steps will show. @param {number[]} steps Nearest first. */
  prepare(steps) {
    this.#coming = steps;
    this.#ask();
  }

  /** Whether all that is in view is here for a step; what failed is not waited for. @param {number} step */
  ready_for(step) {
    const look = this.#look();
    return this.#wanted.slice(0, this.#in_view).every((entry) => entry.failed || entry.right_for(step, look));
  }

  /**
   * Call in each frame, with the pages that it shows and then those that are good to have, the most urgent first.
   * @param {import('./texture.js').PageKey[]} in_view @param {import('./texture.js').PageKey[]} nearby
   */
  want(in_view, nearby) {
    for (const entry of this.#wanted) entry.wanted = false;
    this.#wanted = [...in_view, ...nearby].map((page) => this.#touch(page));
    this.#in_view = in_view.length;
    for (const entry of this.#wanted) {
      entry.wanted = true;
      this.#show_best(entry);
    }
    this.#forget_some();
    this.#ask();
  }

  /** Cancels what has been out of view for a while; true if there is more to look after. */
  keep_to_wanted() {
    const now = performance.now();
    let waiting = false;
    for (const {request, wanted} of this.#entries.values()) {
      if (!request) continue;
      waiting = true;
      if (wanted) request.unwanted_since = Infinity;
      else if (request.unwanted_since === Infinity) request.unwanted_since = now;
      else if (now - request.unwanted_since > patience_milliseconds) request.abort.abort();
    }
    return waiting;
  }

  /** Pages that failed or found no server are asked for again. */
  retry() {
    for (const entry of this.#entries.values()) entry.failed = false;
    this.#ask();
  }

  /** What the last frame showed of a page. @param {import('./texture.js').PageKey} page */
  find(page) {
    return this.#entries.get(key_text(page));
  }

  /** Its own revision has become this one. @param {import('./texture.js').PageKey} page @param {number} revision */
  invalidate(page, revision) {
    this.revision = Math.max(this.revision, revision);
    this.#news_at = performance.now();
    const entry = this.#entries.get(key_text(page));
    if (!entry || revision <= entry.least) return;
    entry.least = revision;
    entry.sure = true;
    entry.failed = false;
    entry.overtaken = 0;
  }

  /** After one or more invalidate(). */
  ask_for_stale() {
    this.#ask();
  }

  /**
   * Which pages are watched: of the others it is remembered up to which revision they are known.
   * @param {(page: import('./texture.js').PageKey) => boolean} watched
   * @returns {number | null} The scene's revision up to which all that are watched from now on are known; null if none is here.
   */
  watch(watched) {
    /** @type {number | null} */
    let known = null;
    for (const entry of this.#entries.values()) {
      if (!watched(entry.page)) {
        entry.seen ??= this.told;
        entry.sure = false;
      } else if (entry.seen !== null) {
        known = Math.min(known ?? Infinity, entry.seen);
        entry.seen = null;
      }
    }
    return known;
  }

  /**
   * Nobody told what changed up to `revision`: all pages are asked for again, and what is right is found in the browser's cache.
   * @param {number} [revision]
   */
  doubt_all(revision = this.revision) {
    this.revision = Math.max(this.revision, revision);
    this.told = Math.max(this.told, revision);
    for (const entry of this.#entries.values()) {
      entry.sure = false;
      entry.request?.abort.abort();  // it may have been answered before
      if (entry.seen !== null) entry.seen = this.told;
      entry.failed = false;
      entry.least = Math.max(entry.least, (entry.shown?.revision ?? -1) + 0.5);
    }
    this.#ask();
  }

  close() {
    for (const entry of this.#entries.values()) this.#drop(entry);
    this.#entries.clear();
    this.#wanted = [];
  }

  /** All that a page depends on but its revision and the step. */
  #look() {
    const {format, accuracy, channels, slice} = this.#options;
    return [this.#texture.fingerprint, format, accuracy, channels, slice].join(' ');
  }

  /** @param {boolean} [other_texture] Nothing that was known of its pages holds. */
  #renew(other_texture = false) {
    this.#ledger.clear();
    if (other_texture) this.told = this.revision;
    for (const entry of this.#entries.values()) {
      entry.request?.abort.abort();
      entry.failed = false;
      if (other_texture) {
        entry.sure = false;
        entry.least = entry.overtaken = 0;
        if (entry.seen !== null) entry.seen = this.told;
      }
      for (const {image} of entry.slots) image.close();
      entry.slots = [];
    }
    this.#ask();
    this.#changed();
  }

  #changed() {
    this.dispatchEvent(new Event('change'));
  }

  /** @param {import('./texture.js').PageKey} page */
  #touch(page) {
    const key = key_text(page);
    const entry = this.#entries.get(key) ?? new Entry(page, this.told);
    this.#entries.delete(key);
    this.#entries.set(key, entry);
    return entry;
  }

  #forget_some() {
    for (const [key, entry] of this.#entries) {
      if (this.#entries.size <= most_pages || entry.wanted) break;
      this.#drop(entry);
      this.#entries.delete(key);
    }
  }

  /** @param {Entry} entry */
  #drop(entry) {
    entry.request?.abort.abort();
    entry.shown?.image.close();
    for (const {image} of entry.slots) image.close();
  }

  /** @param {Entry} entry */
  #show_best(entry) {
    const right = entry.right_for(this.#options.step, this.#look());
    if (!right || right === entry.shown) return;
    const old = entry.shown;
    entry.slots = entry.slots.filter((slot) => slot !== right);
    entry.shown = right;
    if (!old) return;
    if (old.look === right.look && old.revision >= entry.least) entry.slots.push(old);
    else old.image.close();
    this.#tidy(entry);
  }

  /** Keeps the pictures that are shown soonest. @param {Entry} entry */
  #tidy(entry) {
    const soon = (/** @type {Slot} */ slot) => (slot.until > this.#options.step ? slot.from - this.#options.step : 2 ** 53 - slot.until);
    entry.slots.sort((a, b) => soon(a) - soon(b));
    for (const {image} of entry.slots.splice(most_slots - 1)) image.close();
  }

  #ask() {
    const look = this.#look();
    for (const step of [this.#options.step, ...this.#coming]) {
      for (const entry of this.#wanted) {
        if (this.#requests >= most_requests) return;
        if (!entry.request && !entry.failed && !entry.right_for(step, look)) this.#load(entry, step);
      }
    }
  }

  /** Where the page is asked for. @param {Entry} entry @param {number} step */
  #url({page, least, sure, overtaken}, step) {
    const options = {...this.#options, step};
    // An address that names the page's own revision is never asked for twice; one of the scene's would be redirected
    // While edits come in, one that was not told of may be on its way: then the page is asked for as it is
    const settled = least === this.told || performance.now() - this.#news_at > settled_after;
    if (sure && overtaken === 0 && settled) return this.#texture.page_url(page, options, least);
    return this.revision === 0 ? this.#texture.page_url(page, options, 0) : this.#texture.page_url_now(page, options);
  }

  /** @param {Entry} entry @param {number} step */
  async #load(entry, step) {
    const {page} = entry;
    const look = this.#look();
    const url = this.#url(entry, step);
    const request = {abort: new AbortController(), step, unwanted_since: Infinity};
    const note = (/** @type {import('./page_ledger.js').PageRecord} */ record) => {
      if (look === this.#look()) this.#ledger.note(page, record);
    };
    entry.request = request;
    ++this.#requests;
    if (entry.shown?.look !== look) note({state: 'loading', url});  // what is only renewed is not waited for
    try {
      const {image, facts} = await fetch_page(url, request.abort.signal);
      const revision = facts.revision ?? entry.least;
      this.latency += (Math.min(1000, facts.milliseconds ?? 0) - this.latency) / 8;
      note({state: 'ready', url, ...facts});
      const moves = this.#texture.animated;
      this.#take(entry, {image, revision, look, from: moves ? facts.valid_from ?? step : -Infinity, until: moves ? facts.valid_until ?? step + 1 : Infinity});
    } catch (error) {
      this.#refused(entry, request, error, url, note, look);
    }
    --this.#requests;
    if (entry.request === request) entry.request = null;
    this.#ask();
  }

  /** @param {Entry} entry @param {Slot} slot */
  #take(entry, slot) {
    if (slot.look !== this.#look() || !this.#entries.has(key_text(entry.page))) return slot.image.close();
    if (slot.revision < entry.least) {
      // Doubted, and right after all; or overtaken by an edit: asked for again
      if (!Number.isInteger(entry.least)) entry.least = slot.revision;
      else if (++entry.overtaken > most_overtaken) entry.least = slot.revision;
    } else {
      entry.least = slot.revision;
      entry.overtaken = 0;
    }
    if (entry.seen === null) entry.sure = Number.isInteger(slot.revision) && slot.revision === entry.least;
    if (entry.born === 0) entry.born = performance.now();
    const stale = (/** @type {Slot} */ other) => other.look !== slot.look || other.revision < slot.revision;
    for (const {image} of entry.slots.filter(stale)) image.close();
    entry.slots = entry.slots.filter((other) => !stale(other));
    const {step} = this.#options;
    if (entry.shown === null || (slot.from <= step && step < slot.until) || stale(entry.shown)) {
      // Even one that is overtaken is nearer to the truth than what it replaces
      entry.shown?.image.close();
      entry.shown = slot;
    } else {
      entry.slots.push(slot);
      this.#tidy(entry);
    }
    this.#changed();
  }

  /** @param {Entry} entry @param {any} request @param {unknown} error @param {string} url @param {(record: any) => void} note @param {string} look */
  #refused(entry, request, error, url, note, look) {
    if (request.abort.signal.aborted) {
      if (look === this.#look() && !entry.wanted) this.#ledger.forget(entry.page);
      return;
    }
    if (error instanceof Refused && error.status === 410 && entry.sure) {
      // Changed once more since it was told: what it is now is asked for
      entry.sure = false;
      ++entry.overtaken;
      return;
    }
    entry.failed = true;
    note({state: 'failed', url, problem: /** @type {Error} */ (error).message});
    if (error instanceof Refused && (error.status === 404 || error.status === 410)) this.on_stale();
  }
}
