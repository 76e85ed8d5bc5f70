/** The server could not be reached at all: no answer of HTTP came back. */
export class Unreachable extends Error {
  constructor() {
    super('The server is not answering.');
  }
}

/** The server answered, but not with what was asked for. */
export class Refused extends Error {
  /** @param {number} status @param {string} detail */
  constructor(status, detail) {
    super(detail || `The server answered with status ${status}.`);
    this.status = status;
  }
}

/**
 * Whether the server answers. Once it does not, it is asked again, at growing intervals, until it does.
 * Fires `down` when it falls silent, `waiting` before each new attempt (with `seconds`), and `up` when it is back.
 */
class Connection extends EventTarget {
  #attempt = 0;
  #timer = 0;
  is_up = true;

  /** A request got no answer. */
  lost() {
    if (!this.is_up) return;
    this.is_up = false;
    this.#attempt = 0;
    this.dispatchEvent(new Event('down'));
    this.#wait();
  }

  /** A request got an answer, whatever its status. */
  answered() {
    if (this.is_up) return;
    clearTimeout(this.#timer);
    this.is_up = true;
    this.dispatchEvent(new Event('up'));
  }

  async try_now() {
    clearTimeout(this.#timer);
    try {
      await fetch('/healthz', {cache: 'no-store', signal: AbortSignal.timeout(5000)});
      this.answered();
    } catch {
      if (!this.is_up) this.#wait();
    }
  }

  #wait() {
    const seconds = Math.min(8, 2 ** this.#attempt++);
    this.dispatchEvent(new CustomEvent('waiting', {detail: {seconds}}));
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.try_now(), seconds * 1000);
  }
}

export const connection = new Connection();

/**
 * `fetch` that tells a silent server (Unreachable) from an aborted request (AbortError).
 * @param {string} url @param {RequestInit} [options]
 */
export async function ask(url, options) {
  try {
    const response = await fetch(url, options);
    connection.answered();
    return response;
  } catch (error) {
    if (options?.signal?.aborted) throw error;
    connection.lost();
    throw new Unreachable();
  }
}

/** The server's own words about a failure, if they are fit to show. @param {Response} response */
export async function refusal(response) {
  const text = (await response.text().catch(() => '')).trim();
  let detail = text;
  try {
    const json = JSON.parse(text);
    detail = json.detail ?? json.error ?? json.message ?? '';
  } catch {
    // plain text, or a proxy's page
  }
  return new Refused(response.status, typeof detail === 'string' && !detail.startsWith('<') ? detail.slice(0, 400) : '');
}

/** @param {string} url */
async function ask_json(url) {
  const response = await ask(url, {cache: 'no-cache', headers: {accept: 'application/json'}});
  if (!response.ok) throw await refusal(response);
  return response.json();
}

/** GET /scenes. */
export async function fetch_scenes() {
  const list = await ask_json('/scenes');
  return {scenes: list.scenes ?? [], broken: list.broken ?? []};
}

/** GET /scenes/{id}. @param {string} id */
export const fetch_tilejson = (id) => ask_json(`/scenes/${encodeURIComponent(id)}`);
