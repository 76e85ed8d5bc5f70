import {change_words, place_of_dirt} from './change_words.js';

const most_remembered = 100;
/** Edits of one person that follow each other within this are told as one. */
const together_milliseconds = 2000;

/**
 * What somebody did.
 * @typedef {{who: string, mine: boolean, session: number, what: string, changes: any[], revision: number, times: number, at: number, place: {x: number, y: number, side: number} | null}} News
 */

/** The last edits of a scene, the newest first; a drag is one of them. Fires `change`. */
export class EditNews extends EventTarget {
  /** @type {News[]} */
  list = [];

  /** @param {any} done An EditDone. @param {{who: string, mine: boolean, changes?: any[]}} by */
  tell({answer, session, changes}, {who, mine, changes: known}) {
    if (!answer || answer.again) return;
    const told = known ?? changes;
    const now = Date.now();
    const revision = Number(answer.revision);
    const news = {who, mine, session: Number(session), what: change_words(told), changes: told, revision, times: 1, at: now, place: place_of_dirt(answer.dirty)};
    const [last] = this.list;
    if (last && last.who === who && last.session === news.session && last.what === news.what && now - last.at < together_milliseconds) {
      this.list[0] = {...news, times: last.times + 1};
    } else {
      this.list.unshift(news);
      this.list.length = Math.min(this.list.length, most_remembered);
    }
    this.dispatchEvent(new Event('change'));
  }

  clear() {
    this.list = [];
    this.dispatchEvent(new Event('change'));
  }
}
