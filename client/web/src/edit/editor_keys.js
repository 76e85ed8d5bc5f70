const directions = /** @type {Record<string, number[]>} */ ({ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]});
const nudge_far = 10, turn_part = 1 / 24;

/**
 * Keys of the editor, while it is open: they come before those of the map.
 * @param {import('./editor.js').Editor} editor @param {() => number} resolution Texels of a pixel. @param {AbortSignal} until
 */
export function listen_to_editor_keys(editor, resolution, until) {
  document.addEventListener(
    'keydown',
    (event) => {
      const target = /** @type {HTMLElement} */ (event.target);
      if (!editor.active || event.altKey || target.closest?.('input:not([type=range], [type=radio], [type=checkbox]), dialog')) return;
      if (event.key === 'Escape' && target.closest?.('.menu-anchor, .drawer, .live-sign')) return;  // closes that first
      const act = action_of(editor, resolution(), event);
      if (!act) return;
      event.preventDefault();
      event.stopPropagation();
      act();
    },
    {capture: true, signal: until},
  );
}

/** @param {import('./editor.js').Editor} editor @param {number} resolution @param {KeyboardEvent} event @returns {(() => void) | null} */
function action_of(editor, resolution, {key, ctrlKey, metaKey, shiftKey}) {
  const name = key.length === 1 ? key.toLowerCase() : key;
  if (ctrlKey || metaKey) {
    if (name === 'z') return () => (shiftKey ? editor.redo() : editor.undo());
    if (name === 'y') return () => editor.redo();
    if (name === 'd') return () => editor.duplicate();
    return name === 'a' ? () => editor.select_all() : null;
  }
  if (name === 'Escape') return () => editor.escape();
  if (name === 'v') return () => editor.choose(null);
  if (/^[1-9]$/.test(name) && Number(name) <= (editor.patterns?.count ?? 0)) return () => editor.choose(Number(name) - 1);
  if (editor.selection.length === 0) return null;
  if (name === 'Delete' || name === 'Backspace') return () => editor.remove();
  if (name === 'PageUp' || name === 'PageDown') return () => editor.raise(name === 'PageUp');
  if (name === 'r') return () => editor.change_together({turn: shiftKey ? -turn_part : turn_part});
  if (!directions[name]) return null;
  const [x, y] = directions[name];
  const far = (shiftKey ? nudge_far : 1) * Math.max(1, Math.round(resolution));
  return () => editor.change_together({dx: x * far, dy: y * far});
}
