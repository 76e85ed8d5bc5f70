import {decode, encode, subprotocol} from './messages.js';

const first_wait = 500, longest_wait = 8000;
/** After so many attempts without a stream it is done without one, and asked for seldom. */
const most_attempts = 3;
const seldom = 60_000;
/** Between two signs of life that are asked for, and how long one may take. */
const ping_every = 15_000, pong_within = 10_000;
/** What waits to be sent: more, and the server is not reading. */
const most_waiting_bytes = 4 << 20;

/**
 * The stream of a scene: told what changes, by proto/stream.proto. After a break it connects again, at growing
 * intervals, and goes on from where it was. Fires `state`, and an event for each kind of the server's messages, with the
 * message as `detail`.
 */
export class Stream extends EventTarget {
  #url;
  #hello;
  /** @type {WebSocket | null} */
  #socket = null;
  #timer = 0;
  #life = 0;
  #attempt = 0;
  #closed = false;
  /** What resuming needs of the last hello. */
  #lineage = '';
  #fingerprint = '';
  /** Everything up to this revision was told. */
  told = 0;
  /** @type {'connecting' | 'open' | 'waiting' | 'absent'} */
  state = 'connecting';

  /**
   * @param {string} path Of the stream, on the server of this page.
   * @param {() => {name: string, token: string}} hello Who is here.
   */
  constructor(path, hello) {
    super();
    this.#url = new URL(path, location.href.replace(/^http/, 'ws')).href;
    this.#hello = hello;
  }

  get open() {
    return this.state === 'open';
  }

  /** Connects, or connects anew at once: what is said in the hello has changed. */
  connect() {
    if (this.#closed) return;
    this.#drop();
    this.#set_state('connecting');
    const socket = new WebSocket(this.#url, subprotocol);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    socket.onopen = () => {
      const {name, token} = this.#hello();
      const {told: seen} = this;
      this.#send('hello', {name, token, lineage: this.#lineage, fingerprint: this.#fingerprint, seenRevision: BigInt(seen), wantsPresence: true, wantsEdits: true});
      this.#expect_life();
    };
    socket.onmessage = ({data}) => this.#heard(new Uint8Array(data));
    socket.onclose = () => this.#lost();
    this.#life = setTimeout(() => this.#lost(), pong_within);
  }

  /** Tries at once, if it is waiting to. */
  try_now() {
    if (this.state === 'waiting' || this.state === 'absent') this.connect();
  }

  close() {
    this.#closed = true;
    this.#drop();
  }

  /** False if it could not be sent. @param {string} kind @param {object} value */
  send(kind, value) {
    return this.open && this.#send(kind, value);
  }

  /** @param {string} kind @param {object} value */
  #send(kind, value) {
    const socket = this.#socket;
    if (!socket || socket.readyState !== WebSocket.OPEN || socket.bufferedAmount > most_waiting_bytes) return false;
    socket.send(encode(kind, value));
    return true;
  }

  /** @param {Uint8Array} bytes */
  #heard(bytes) {
    this.#expect_life();
    /** @type {{kind: string | undefined, value: any}} */
    let message;
    try {
      message = decode(bytes);
    } catch {
      return this.#lost();  // Another end than ours, or a broken one
    }
    const {kind, value} = message;
    if (kind === 'hello') this.#greeted(value);
    if (kind === 'replaced' && value.hello) this.#remember(value.hello);
    if (kind === undefined || !this.open) return;
    this.dispatchEvent(new CustomEvent(kind, {detail: value}));
    if (kind === 'invalidation') this.told = Math.max(this.told, Number(value.revision));
  }

  /** @param {any} hello */
  #greeted(hello) {
    this.#attempt = 0;
    this.#remember(hello);
    this.#set_state('open');
  }

  /** @param {any} hello */
  #remember({lineage, fingerprint}) {
    this.#lineage = lineage;
    this.#fingerprint = fingerprint;
  }

  /** Asks for a sign of life after a while of silence, and gives the connection up if none comes. */
  #expect_life() {
    clearTimeout(this.#life);
    this.#life = setTimeout(() => {
      this.#send('ping', {payload: 0n});
      this.#life = setTimeout(() => this.#lost(), pong_within);
    }, ping_every);
  }

  #drop() {
    clearTimeout(this.#timer);
    clearTimeout(this.#life);
    const socket = this.#socket;
    this.#socket = null;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }

  #lost() {
    this.#drop();
    if (this.#closed) return;
    ++this.#attempt;
    const absent = this.#lineage === '' && this.#fingerprint === '' && this.#attempt >= most_attempts;
    this.#set_state(absent ? 'absent' : 'waiting');
    const wait = absent ? seldom : Math.min(longest_wait, first_wait * 2 ** (this.#attempt - 1));
    this.#timer = setTimeout(() => this.connect(), wait * (0.75 + Math.random() / 2));
  }

  /** @param {'connecting' | 'open' | 'waiting' | 'absent'} state */
  #set_state(state) {
    if (state === this.state) return;
    this.state = state;
    this.dispatchEvent(new Event('state'));
  }
}
