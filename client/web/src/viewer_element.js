import {element, icon, mark} from './dom.js';
import {with_separators} from './numbers.js';
import {kind_name} from './texture.js';

/**
 * What a viewer consists of, in its places.
 * @param {import('./viewer.js').Viewer} viewer @param {{copy_link: Element, fullscreen: Element, help: Element}} buttons
 */
export function viewer_element({texture, canvas, live, editor, viewing, waiting, player, go_to, grid_button, rail, scale_bar, read_out}, buttons) {
  const side = with_separators(texture.side_texels);
  const place = element(
    'div',
    {class: 'panel place'},
    element('a', {class: 'home', href: '#', title: 'All scenes (L)', 'aria-label': 'All scenes'}, icon('back'), mark()),
    element(
      'div',
      {class: 'place-text'},
      element('h1', {text: texture.title}),
      element('p', {text: [kind_name(texture.kind), `${side}² texels`].filter(Boolean).join(' · ')}),
    ),
  );
  const tools = element(
    'div',
    {class: 'panel tools', role: 'toolbar', 'aria-label': 'Tools'},
    go_to.element, editor.button, grid_button, viewing.menu.element, buttons.copy_link, buttons.fullscreen, buttons.help,
  );
  return element(
    'div',
    {class: 'viewer'},
    canvas,
    live.cursors.element,
    waiting.element,
    element('div', {class: 'progress', 'aria-hidden': 'true'}),
    element('header', {class: 'top-bar'}, place, viewing.selector.element, viewing.slices.element, player.element, live.panel.element, tools),
    rail.element,
    editor.palette.element,
    element(
      'div',
      {class: 'lower'},
      editor.bar.element,
      element('div', {class: 'above-read-out'}, scale_bar.element, texture.attribution && element('p', {class: 'attribution', text: texture.attribution})),
      read_out.element,
    ),
    live.sign.drawer,
  );
}
