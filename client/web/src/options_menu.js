import {element, icon_button, keep_in_window} from './dom.js';

/** What a view can be asked for, beside a place. The first of each is the default, which the address leaves unsaid. */
export const choices = {
  format: {title: 'Format', values: {png: 'PNG', webp: 'WebP', jpg: 'JPEG'}, default: 'png'},
  accuracy: {title: 'Accuracy', values: {exact: 'Exact', high: 'High', fast: 'Fast'}, default: 'high'},
  texels: {title: 'Magnified texels', values: {crisp: 'Crisp', smooth: 'Smooth'}, default: 'crisp'},
};

/** @param {Record<string, string>} asked As in the address. @returns {Record<keyof typeof choices, string>} */
export function chosen(asked) {
  const entries = Object.entries(choices).map(([name, {values, default: usual}]) => [name, asked[name] in values ? asked[name] : usual]);
  return Object.fromEntries(entries);
}

/**
 * A button with a small menu of choices below it.
 * @param {Record<string, string>} values
 * @param {string[]} formats That the server offers for this texture.
 * @param {(name: string, value: string) => void} change
 */
export function options_menu(values, formats, change) {
  const menu = element('div', {class: 'menu panel', id: 'options', hidden: true, role: 'group', 'aria-label': 'View options'});
  const button = icon_button('View options', 'options', () => toggle(menu.hidden), {
    'aria-expanded': 'false',
    'aria-controls': 'options',
  });
  const radios = new Map();
  for (const [name, {title, values: names}] of Object.entries(choices)) {
    const segments = Object.entries(names).map(([value, text]) => {
      const radio = element('input', {
        type: 'radio',
        name,
        value,
        checked: values[name] === value,
        disabled: name === 'format' && !formats.includes(value),
        onchange: () => change(name, value),
      });
      radios.set(`${name} ${value}`, radio);
      return element('label', {}, radio, element('span', {text}));
    });
    menu.append(element('fieldset', {}, element('legend', {text: title}), element('div', {class: 'segments'}, ...segments)));
  }

  /** @param {boolean} open */
  function toggle(open) {
    menu.hidden = !open;
    button.setAttribute('aria-expanded', String(open));
    if (!open) return;
    keep_in_window(menu);
    menu.querySelector('input:checked')?.focus();
  }
  const root = element('div', {class: 'menu-anchor'}, button, menu);
  root.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== 'Escape' || menu.hidden) return;
    event.stopPropagation();
    toggle(false);
    button.focus();
  });
  return {
    element: root,
    close_menu: () => toggle(false),
    /** @param {string} name @param {string} value */
    check: (name, value) => (radios.get(`${name} ${value}`).checked = true),
  };
}
