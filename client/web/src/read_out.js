import {element} from './dom.js';
import {format_bytes, format_milliseconds, round_number_below, short_decimal, with_separators} from './numbers.js';
import {connection} from './server.js';
import {key_text} from './texture.js';

const state_words = {loading: 'loading', ready: 'ready', cached: 'from the cache', failed: 'failed'};

/**
 * The bar below the view: level, texel and page under the pointer (or in the middle of the view, when there is no
 * pointer), the page's state, and how many pages are on their way.
 */
export class ReadOut {
  #level = element('output', {class: 'value', 'data-read': 'level'});
  #zoom = element('span', {class: 'quiet', 'data-read': 'zoom'});
  #x = element('output', {class: 'value number', 'data-read': 'x'});
  #y = element('output', {class: 'value number', 'data-read': 'y'});
  #page = element('output', {class: 'value', 'data-read': 'page'});
  #dot = element('span', {class: 'dot'});
  #state = element('output', {class: 'value', 'data-read': 'state'});
  #facts = element('span', {class: 'quiet', 'data-read': 'facts'});
  #loading = element('output', {class: 'loading-count', 'data-read': 'loading'});

  /** @param {() => void} retry_failed @param {Element} revision The sign of the scene's revision. */
  constructor(retry_failed, revision) {
    this.retry = element('button', {type: 'button', class: 'text-button', hidden: true, onclick: retry_failed});
    this.element = element(
      'footer',
      {class: 'read-out panel', 'aria-label': 'Read-out'},
      group('Level', this.#level, this.#zoom),
      group('Texel', element('span', {class: 'axis', text: 'x'}), this.#x, element('span', {class: 'axis', text: 'y'}), this.#y),
      group('Page', this.#page),
      element('div', {class: 'read-group read-state'}, this.#dot, this.#state, this.#facts),
      element('div', {class: 'read-group read-loading'}, this.#loading, this.retry, revision),
    );
  }

  /**
   * @param {{
   *   texture: import('./texture.js').Texture, resolution: number, level: number,
   *   texel: {x: number, y: number}, ledger: import('./page_ledger.js').PageLedger
   * }} now `texel` may lie between texels, and outside of the texture.
   */
  show({texture, resolution, level, texel, ledger}) {
    this.#level.textContent = String(level);
    this.#zoom.textContent = magnification(resolution, level);
    const inside = texture.contains(texel);
    this.#x.textContent = inside ? with_separators(Math.floor(texel.x)) : '–';
    this.#y.textContent = inside ? with_separators(Math.floor(texel.y)) : '–';
    const page = texture.page_at(texel, level);
    this.#page.textContent = inside ? `level ${key_text(page)}` : 'outside';
    this.#page.title = inside ? `Column ${page.x}, row ${page.y} of level ${level}. In addresses: ${texture.z_of(level)}/${page.x}/${page.y}, since z counts from the coarsest level.` : '';
    const record = inside ? ledger.find(page) : undefined;
    this.element.dataset.state = record?.state ?? 'none';
    this.#state.textContent = record ? state_words[record.state] : inside ? 'not asked for' : 'nothing here';
    this.#show_facts(record ? facts_of(record) : []);
    this.#facts.title = record?.url ?? '';
    this.#loading.textContent =
      ledger.loading === 0 ? '' : ledger.loading === 1 ? '1 page loading' : `${with_separators(ledger.loading)} pages loading`;
    this.retry.hidden = ledger.failed === 0 || !connection.is_up;  // the banner offers it then
    this.retry.textContent = ledger.failed === 1 ? '1 failed: retry' : `${ledger.failed} failed: retry`;
  }

  /** @param {Fact[]} facts */
  #show_facts(facts) {
    const text = facts.map((fact) => fact.text).join(' · ');
    if (this.#facts.textContent === text) return;  // an explanation that is being read stays
    this.#facts.replaceChildren(
      ...facts.flatMap(({text, meaning}, i) => [i > 0 ? ' · ' : '', meaning ? element('span', {class: 'explained', title: meaning, text}) : text]),
    );
  }
}

/** @param {string} name @param {...any} values */
const group = (name, ...values) => element('div', {class: 'read-group'}, element('span', {class: 'label', text: name}), ...values);

/** How large a texel of the level shown is on screen, where it is not one pixel. @param {number} resolution @param {number} level */
function magnification(resolution, level) {
  const factor = 2 ** level / resolution;
  return Math.abs(factor - 1) < 0.005 ? '' : `× ${factor >= 10 ? Math.round(factor) : short_decimal(factor)}`;
}

/** What the server's words for its ways to make a page mean. @type {Record<string, string>} */
const method_meanings = {
  constant: 'One colour everywhere.',
  closed_form: 'A formula gives the mean colour under each texel.',
  exemplar: 'Level 0: the texels of the photograph itself, blended where patches meet.',
  stamps: 'Each texel sums the filtered patches (stamps) that meet it.',
  variants: 'Tiles of a few texels are looked up among images made beforehand, one for each type of tile.',
  quadtree: 'A texel covers whole tiles: its colour is looked up by the type of its node in the quadtree of choices.',
  enumeration: 'A texel covers many tiles: all of their contents are summed.',
  expectation: 'A texel covers so many tiles that the mean over all choices stands for them; the bound says how far off that may be.',
};

/** @param {string} method @returns {Fact} */
const method_fact = (method) => ({text: method.replaceAll('_', ' '), meaning: method_meanings[method.replaceAll(' ', '_')]});

/** Something known of a page, and what it means where that needs saying. @typedef {{text: string, meaning?: string}} Fact */

/** @param {import('./page_ledger.js').PageRecord} record @returns {Fact[]} */
function facts_of({state, problem, bytes, milliseconds, server_milliseconds, server_cached, method, bound, revision}) {
  if (state === 'failed') return problem ? [{text: problem}] : [];
  /** @type {Fact[]} */
  const facts = [];
  if (bytes !== undefined) facts.push({text: format_bytes(bytes)});
  if (state === 'ready' && milliseconds !== undefined) facts.push({text: `came in ${format_milliseconds(milliseconds)}`});
  if (state === 'ready' && server_cached) facts.push({text: 'kept by the server'});
  if (state === 'ready' && server_milliseconds !== undefined) facts.push({text: `made in ${format_milliseconds(server_milliseconds)}`});
  if (revision) facts.push({text: `revision ${with_separators(revision)}`, meaning: 'Of the page: the last edit that touched it.'});
  if (method) facts.push(method_fact(method));
  if (bound) facts.push({text: bound_text(Number(bound)), meaning: bound_meaning(Number(bound))});
  return facts;
}

/** @param {number} codes */
const bound_meaning = (codes) =>
  codes === 0
    ? 'Every texel is the exact mean of the level-0 texels under it, rounded to 8 bits.'
    : 'How far a texel may be from the exact mean of the level-0 texels under it, before rounding: a code is one step of 8-bit linear light.';

/** @param {number} codes The most by which a channel is wrong, in 8-bit codes. */
const bound_text = (codes) => (codes === 0 ? 'exact' : codes < 0.01 ? 'within 0.01 code' : `within ${short_decimal(codes)} codes`);

/** A bar as long as a round number of texels. */
export class ScaleBar {
  #bar = element('div', {class: 'scale-line'});
  #text = element('span', {});
  element = element('div', {class: 'scale-bar', role: 'img'}, this.#text, this.#bar);

  /** @param {number} resolution Level-0 texels under one CSS pixel. */
  show(resolution) {
    const texels = round_number_below(140 * resolution);
    const text = `${with_separators(texels)} ${texels === 1 ? 'texel' : 'texels'}`;
    this.#bar.style.width = `${texels / resolution}px`;
    this.#text.textContent = text;
    this.element.setAttribute('aria-label', `Scale: ${text}`);
  }
}
