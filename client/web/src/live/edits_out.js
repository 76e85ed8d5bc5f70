/** Refusals that pass: the same edit is sent again. */
const passing = new Set(['overloaded', 'unknown']);
const why_names = ['wrong', 'conflict', 'other_content', 'too_old', 'overloaded', 'unavailable', 'unknown', 'forbidden'];
const most_attempts = 6;
const answer_within = 20_000;

/** The server did not make an edit; its words say why. */
export class EditRefused extends Error {
  /** @param {string} why As in EditRefused of proto/stream.proto. @param {string} detail */
  constructor(why, detail) {
    super(detail || 'The server did not take the edit.');
    this.why = why;
  }
}

/** A UUID; browsers have their own function for it on secure origins only. */
export function new_id() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 15) | 64;
  bytes[8] = (bytes[8] & 63) | 128;
  return [...bytes].map((byte, i) => ([4, 6, 8, 10].includes(i) ? '-' : '') + byte.toString(16).padStart(2, '0')).join('');
}

/** Edits that wait for their answer. One that a break swallowed is sent again: its id makes that harmless. */
export class EditsOut {
  #stream;
  #author;
  /** @type {Map<string, {edit: any, attempt: number, timer: number, resolve: (answer: any) => void, reject: (error: Error) => void}>} By id. */
  #waiting = new Map();

  /** @param {import('./stream.js').Stream} stream @param {() => string} author */
  constructor(stream, author) {
    this.#stream = stream;
    this.#author = author;
    stream.addEventListener('editRefused', (event) => this.#refused(/** @type {CustomEvent} */ (event).detail));
    stream.addEventListener('hello', () => {
      for (const id of this.#waiting.keys()) this.#send(id);
    });
  }

  /**
   * Makes an edit; the answer when it is in for good. Throws EditRefused.
   * @param {any[]} changes As of proto/edit.proto: {change: {case, value}}. @param {number} known_revision @returns {Promise<any>}
   */
  make(changes, known_revision) {
    const edit = {id: new_id(), knownRevision: BigInt(known_revision), author: this.#author(), changes};
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => {
        this.#waiting.delete(edit.id);
        reject(new EditRefused('unknown', 'The server did not answer in time: whether the edit was made will show.'));
      }, answer_within);
      this.#waiting.set(edit.id, {edit, attempt: 1, timer, resolve, reject});
      this.#send(edit.id);
    });
  }

  /** The changes of one that waits for its answer. @param {string} id */
  changes_of(id) {
    return this.#waiting.get(id)?.edit.changes;
  }

  /** @param {string} id @param {any} answer True if it was one of these. */
  done(id, answer) {
    this.#take(id)?.resolve(answer);
  }

  close() {
    for (const id of [...this.#waiting.keys()]) this.#take(id)?.reject(new EditRefused('unknown', 'The scene was left.'));
  }

  /** @param {string} id */
  #send(id) {
    const waiting = this.#waiting.get(id);
    if (waiting) this.#stream.send('edit', waiting.edit);
  }

  /** @param {string} id */
  #take(id) {
    const waiting = this.#waiting.get(id);
    if (!waiting) return undefined;
    clearTimeout(waiting.timer);
    this.#waiting.delete(id);
    return waiting;
  }

  /** @param {any} refusal */
  #refused({id, why, detail}) {
    const waiting = this.#waiting.get(id);
    if (!waiting) return;
    const name = why_names[why] ?? 'wrong';
    if (passing.has(name) && waiting.attempt < most_attempts) {
      setTimeout(() => this.#send(id), 100 * 2 ** waiting.attempt++);
      return;
    }
    this.#take(id)?.reject(new EditRefused(name, detail));
  }
}
