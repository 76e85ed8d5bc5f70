import {key_text} from './texture.js';

/**
 * What is known of a page: of its answer when there was one, of the failure when there was none.
 * @typedef {{
 *   state: 'loading' | 'ready' | 'cached' | 'failed',
 *   from_cache?: boolean, bytes?: number, milliseconds?: number, server_milliseconds?: number, server_cached?: boolean,
 *   method?: string, bound?: string, valid_from?: number, valid_until?: number, revision?: number, problem?: string, url?: string
 * }} PageRecord
 */

const remembered_pages = 4096;

/** The state of every page that was asked for lately; fires `change`. */
export class PageLedger extends EventTarget {
  /** @type {Map<string, PageRecord>} Oldest first. */
  #records = new Map();
  #loading = 0;
  #failed = 0;

  get loading() {
    return this.#loading;
  }

  get failed() {
    return this.#failed;
  }

  /** @param {import('./texture.js').PageKey} page @returns {PageRecord | undefined} */
  find(page) {
    return this.#records.get(key_text(page));
  }

  /** @param {import('./texture.js').PageKey} page @param {PageRecord} record */
  note(page, record) {
    const key = key_text(page);
    if (record.state === 'ready' && this.#records.get(key)?.from_cache) record.state = 'cached';
    this.#forget(key);
    this.#records.set(key, record);
    if (record.state === 'loading') ++this.#loading;
    if (record.state === 'failed') ++this.#failed;
    if (this.#records.size > remembered_pages) this.#forget(this.#records.keys().next().value);
    this.dispatchEvent(new Event('change'));
  }

  /** @param {string} address Absolute URL of a page that the browser had kept. */
  came_from_cache(address) {
    const {pathname, search} = new URL(address);
    const record = [...this.#records.values()].find(({url}) => url === pathname + search);
    if (record?.state === 'loading') record.from_cache = true;  // the browser tells before the page is decoded
    if (record?.state !== 'ready') return;
    record.state = 'cached';
    this.dispatchEvent(new Event('change'));
  }

  /** The page left the view before it came. @param {import('./texture.js').PageKey} page */
  forget(page) {
    this.#forget(key_text(page));
    this.dispatchEvent(new Event('change'));
  }

  clear() {
    this.#records.clear();
    this.#loading = this.#failed = 0;
    this.dispatchEvent(new Event('change'));
  }

  /** @param {string} key */
  #forget(key) {
    const record = this.#records.get(key);
    if (record?.state === 'loading') --this.#loading;
    if (record?.state === 'failed') --this.#failed;
    this.#records.delete(key);
  }
}
