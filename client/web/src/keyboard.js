/**
 * Calls the action of a key that is pressed outside of text fields and dialogs, without Ctrl, Alt or Meta.
 * @param {Record<string, (event: KeyboardEvent) => void>} actions By KeyboardEvent.key, letters in lower case.
 * @param {AbortSignal} until
 */
export function listen_to_keys(actions, until) {
  document.addEventListener(
    'keydown',
    (event) => {
      const target = /** @type {HTMLElement} */ (event.target);
      if (event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
      if (target.closest('input:not([type=range], [type=radio]), dialog')) return;
      if (target.matches('input') && event.key.startsWith('Arrow')) return;  // moves the slider or the choice itself
      const act = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!act) return;
      event.preventDefault();
      act(event);
    },
    {signal: until},
  );
}
