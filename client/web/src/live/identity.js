/** What this browser remembers of who sits at it; a browser may forbid to remember anything. */
const kept = (/** @type {() => Storage} */ storage, /** @type {string} */ key) => ({
  get() {
    try {
      return storage().getItem(key) ?? '';
    } catch {
      return '';
    }
  },
  set(/** @type {string} */ value) {
    try {
      storage().setItem(key, value);
    } catch {
      // only for this page, then
    }
  },
});

/** As others are told; empty: somebody without a name. */
export const kept_name = kept(() => localStorage, 'tessera.name');
/** Of an editor, as long as the tab is open. */
export const kept_token = kept(() => sessionStorage, 'tessera.token');

/** At most 64 bytes of UTF-8. @param {string} text */
export function fit_name(text) {
  let name = text.trim().replace(/\s+/g, ' ');
  while (new TextEncoder().encode(name).length > 64) name = [...name].slice(0, -1).join('');
  return name;
}
