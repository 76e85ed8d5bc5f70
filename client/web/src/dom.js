/**
 * @param {string} tag
 * @param {Record<string, any>} [attributes] `on…` adds a listener, `class`, `text` and the rest do what they say;
 *   false, null and undefined leave an attribute out.
 * @param {...(Node|string|null|undefined|false)} children
 * @returns {any} The element; loosely typed, since its tag is a string here.
 */
export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === false || value === null || value === undefined) continue;
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (name === 'text') node.textContent = value;
    else node.setAttribute(name, value === true ? '' : String(value));
  }
  node.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

const svg_namespace = 'http://www.w3.org/2000/svg';

/** @param {string} tag @param {Record<string, string>} attributes */
function shape(tag, attributes) {
  const node = document.createElementNS(svg_namespace, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

// Drawn on a 24-unit square with a stroke of 1.75.
const icon_paths = {
  plus: 'M12 5v14M5 12h14',
  minus: 'M5 12h14',
  pause: 'M8.5 5v14M15.5 5v14',
  play: 'M8 5l11 7-11 7z',
  fit: 'M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5M9.5 9.5h5v5h-5z',
  grid: 'M4 4h16v16H4zM4 12h16M12 4v16',
  options: 'M4 7h9M17 7h3M4 17h3M11 17h9M15 4.5v5M9 14.5v5',
  link: 'M10 14a4 4 0 0 0 5.7 0l3-3a4 4 0 0 0-5.7-5.7l-1 1M14 10a4 4 0 0 0-5.7 0l-3 3a4 4 0 0 0 5.7 5.7l1-1',
  fullscreen: 'M14 4h6v6M20 4l-7 7M10 20H4v-6M4 20l7-7',
  help: 'M9 9.2a3 3 0 1 1 4.4 2.6c-.9.5-1.4 1.1-1.4 2.2M12 17.6v.2',
  back: 'M14.5 5.5 8 12l6.5 6.5',
  close: 'M6 6l12 12M18 6 6 18',
  pencil: 'M5 19l1-4.2L16.2 4.6a1.6 1.6 0 0 1 2.3 0l.9.9a1.6 1.6 0 0 1 0 2.3L9.2 18zM14.5 6.3l3.2 3.2',
  undo: 'M8.5 5 4 9.5 8.5 14M4.5 9.5H14a5 5 0 0 1 0 10h-3',
  redo: 'M15.5 5 20 9.5 15.5 14M19.5 9.5H10a5 5 0 0 0 0 10h3',
  hand: 'M6 3.5v14.2l4-3.7 2.6 6 2.6-1.1-2.6-5.9 5.4-.4z',
  bin: 'M4.5 7h15M9.5 7V4.5h5V7M6.5 7l1 13h9l1-13M10.5 11v5M13.5 11v5',
  duplicate: 'M8.5 8.5h11v11h-11zM15.5 8.5v-4h-11v11h4',
  raise: 'M5 4h14M12 20V8.5M7 13l5-5 5 5',
  lower: 'M5 20h14M12 4v11.5M7 11l5 5 5-5',
  arrow: 'M5 12h13M12.5 6.5 18 12l-5.5 5.5',
  warning: 'M12 4 21 20H3zM12 10v4.6M12 17.2v.2',
  unplugged: 'M4 20l4-4M20 4l-4 4M6.5 13.5l4 4 2-2-4-4zM13.5 6.5l4 4-2 2-4-4zM11 10.5 9.5 12M13.5 13 12 14.5',
};

/** @param {keyof typeof icon_paths} name */
export function icon(name) {
  const picture = shape('svg', {viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true'});
  picture.append(shape('path', {d: icon_paths[name]}));
  return picture;
}

/** The mark: three tesserae set, the fourth being laid. */
export function mark() {
  const picture = shape('svg', {viewBox: '0 0 32 32', class: 'mark', 'aria-hidden': 'true'});
  picture.append(
    shape('path', {d: 'M4 5.5 14.5 4l.5 10.5L5 15z', fill: '#e9b872'}),
    shape('path', {d: 'M17.5 4.5 28 5l-1 10-9.5-.5z', fill: '#8fb8a8'}),
    shape('path', {d: 'M4.5 17.5 15 17l-.5 10.5L5 28z', fill: '#6d8fb3'}),
    shape('path', {d: 'm19.5 18.2 9-1.2 1.2 9.4-9 1.4z', fill: '#d9765f'}),
  );
  return picture;
}

/**
 * @param {string} label Spoken, and shown when the pointer rests on it.
 * @param {keyof typeof icon_paths} icon_name
 * @param {(event: Event) => void} act
 * @param {Record<string, any>} [attributes]
 */
export function icon_button(label, icon_name, act, attributes = {}) {
  return element(
    'button',
    {type: 'button', class: 'icon-button', 'aria-label': label, title: label, onclick: act, ...attributes},
    icon(icon_name),
  );
}

const window_margin = 10;

/** @type {Set<HTMLElement>} Open ones. */
const kept_menus = new Set();

/**
 * Shifts an open menu sideways until all of it is in the window, and keeps it there until it is hidden: the window and
 * what stands beside the menu's button may change their widths.
 * @param {HTMLElement} menu
 */
export function keep_in_window(menu) {
  if (kept_menus.has(menu)) return;
  kept_menus.add(menu);
  let shift = 0;
  menu.style.translate = '';
  const place = () => {
    if (menu.hidden || !menu.isConnected) return void kept_menus.delete(menu);
    const {left, right} = menu.getBoundingClientRect();
    const beyond = Math.max(0, right - shift - document.documentElement.clientWidth + window_margin);
    const wanted = Math.max(-beyond, window_margin - (left - shift));
    if (wanted !== shift) menu.style.translate = `${(shift = wanted)}px 0`;
    requestAnimationFrame(place);
  };
  place();
}
