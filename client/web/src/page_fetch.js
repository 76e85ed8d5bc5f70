import {ask, refusal} from './server.js';

const most_attempts = 8;

/**
 * Fetches one page and decodes it. A server that is busy (503) or stumbles (5xx) is asked again, after the time it
 * asks for or a growing one with some chance in it, so that many pages do not come back all at once.
 * @param {string} url
 * @param {AbortSignal} signal
 * @returns {Promise<{image: ImageBitmap, facts: Partial<import('./page_ledger.js').PageRecord>}>}
 */
export async function fetch_page(url, signal) {
  for (let attempt = 1; ; ++attempt) {
    const started = performance.now();
    const response = await ask(url, {signal});
    if (response.ok) {
      const blob = await response.blob();
      const milliseconds = performance.now() - started;
      const image = await createImageBitmap(blob);
      return {image, facts: {bytes: blob.size, milliseconds, ...stated_by(response.headers)}};
    }
    const refused = await refusal(response);
    if (response.status < 500 || attempt === most_attempts) throw refused;
    await pause(wait_milliseconds(response.headers.get('retry-after'), attempt), signal);
  }
}

/** What the server says of its answer. @param {Headers} headers */
function stated_by(headers) {
  return {
    method: headers.get('tessera-method') ?? '',
    bound: headers.get('tessera-bound') ?? '',
    valid_from: step_of(headers.get('tessera-valid-from')),
    valid_until: step_of(headers.get('tessera-valid-until')),
    revision: headers.has('tessera-revision') ? Number(headers.get('tessera-revision')) : undefined,
    ...server_timing(headers.get('server-timing') ?? ''),
  };
}

/** A step of the clock, "always" or "never". @param {string | null} text */
function step_of(text) {
  return text === 'never' ? Infinity : text === 'always' ? -Infinity : text === null ? undefined : Number(text);
}

/**
 * "cache;desc=miss, evaluate;dur=1.06, encode;dur=0.78" -> how long the server worked for it, or that it did not.
 * @param {string} text
 */
export function server_timing(text) {
  const durations = [...text.matchAll(/\b(?:evaluate|encode);dur=([\d.]+)/g)].map((match) => Number(match[1]));
  return {
    server_cached: /\bcache;desc="?hit\b/.test(text),
    server_milliseconds: durations.length > 0 ? durations.reduce((sum, duration) => sum + duration, 0) : undefined,
  };
}

/** @param {string | null} retry_after Seconds; dates are not worth the trouble here. @param {number} attempt From 1. */
function wait_milliseconds(retry_after, attempt) {
  const asked = Number(retry_after);
  const seconds = retry_after && asked > 0 ? Math.min(asked, 30) : Math.min(8, 0.25 * 2 ** (attempt - 1));
  return seconds * 1000 * (1 + Math.random() / 2);
}

/** @param {number} milliseconds @param {AbortSignal} signal @returns {Promise<void>} */
function pause(milliseconds, signal) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, milliseconds);
    signal.addEventListener('abort', () => {
      clearTimeout(timer);
      reject(signal.reason);
    });
  });
}
