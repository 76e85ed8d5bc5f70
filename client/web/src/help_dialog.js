import {element, icon_button} from './dom.js';

const shortcuts = [
  ['Move', ['←', '↑', '→', '↓'], 'with Shift: a whole screen'],
  ['Zoom', ['+', '−'], 'one level at a time'],
  ['Whole texture', ['0'], ''],
  ['Go to a texel', ['T'], ''],
  ['Page grid', ['G'], 'borders, keys and state of every page'],
  ['Crisp or smooth', ['S'], 'when a texel is larger than a pixel'],
  ['Next channels', ['M'], 'normals, roughness … if the scene has them; with Shift: back'],
  ['Slice', [',', '.'], 'before and next, if the scene has a third dimension'],
  ['Pause or play', ['P'], 'if the scene moves'],
  ['Step', ['[', ']'], 'back and on, if the scene moves'],
  ['Edit', ['E'], 'if sprites lie in the scene and you may'],
  ['Full screen', ['F'], ''],
  ['Copy a link to this view', ['C'], ''],
  ['List of scenes', ['L'], ''],
  ['This help', ['H'], ''],
];

const editing = [
  ['Place a pattern', ['1', '–', '9'], 'or pick one, then click'],
  ['Select and move', ['V'], 'Shift and click adds, Shift and drag frames several'],
  ['Undo, redo', ['Ctrl+Z', 'Ctrl+⇧+Z'], ''],
  ['Nudge', ['←', '↑', '→', '↓'], 'with Shift: ten times as far'],
  ['Turn', ['R'], 'with Shift: the other way'],
  ['Front, back', ['PgUp', 'PgDn'], ''],
  ['Duplicate', ['Ctrl+D'], ''],
  ['Select all in view', ['Ctrl+A'], ''],
  ['Delete', ['Del'], ''],
  ['Let go, deselect, leave', ['Esc'], ''],
];

/** @param {any[][]} keys */
const key_list = (keys) =>
  element(
    'dl',
    {},
    ...keys.map(([what, names, note]) =>
      element(
        'div',
        {},
        element('dt', {}, element('span', {text: what}), note && element('small', {text: note})),
        element('dd', {}, ...names.map((/** @type {string} */ key) => element('kbd', {text: key}))),
      ),
    ),
  );

/** Keyboard, mouse and touch, in a modal dialog: Escape closes it. */
export function help_dialog() {
  const dialog = element('dialog', {class: 'help', 'aria-labelledby': 'help-title'});
  const close = icon_button('Close', 'close', () => dialog.close());
  dialog.append(
    element('header', {}, element('h2', {id: 'help-title', text: 'Getting around'}), close),
    key_list(shortcuts),
    element('h3', {text: 'While editing'}),
    key_list(editing),
    element(
      'p',
      {},
      'Drag to move, turn the wheel or pinch to zoom, double-click to come closer, hold Shift and drag to frame a part. ',
      'The address always names the view: copy it, and whoever opens it sees the same texels.',
    ),
    element(
      'footer',
      {},
      'Drawn with OpenLayers. ',
      element('a', {href: 'licences.txt', target: '_blank', rel: 'noopener', text: 'Licences'}),
    ),
  );
  // A click on the backdrop reaches the dialog itself, one inside it reaches a child
  dialog.addEventListener('click', (event) => event.target === dialog && dialog.close());
  return dialog;
}
