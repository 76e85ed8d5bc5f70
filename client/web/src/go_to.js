import {element, icon_button} from './dom.js';
import {parse_grouped} from './numbers.js';

/**
 * "x, y" or "x, y, level" -> numbers; null if that is not what it says. A comma with three digits behind it groups
 * digits unless the text separates the numbers by blanks or semicolons: "1,234 5,678" and "1234, 5678" both mean two.
 * @param {string} text
 * @returns {{x: number, y: number, level: number | null} | null}
 */
export function parse_texel(text) {
  const trimmed = text.trim().replace(/^[x(\s]+|[)\s]+$/g, '');
  const parts = /[;\s]/.test(trimmed) ? trimmed.split(/[;,]?\s+|;/) : trimmed.split(',');
  const numbers = parts.filter((part) => part !== '').map(parse_grouped);
  if ((numbers.length !== 2 && numbers.length !== 3) || numbers.includes(null)) return null;
  const [x, y, level = null] = numbers;
  return {x: /** @type {number} */ (x), y: /** @type {number} */ (y), level};
}

/**
 * The box to go to a texel.
 * @param {(place: {x: number, y: number, level: number | null}) => string | null} go Answers what is wrong, or null.
 */
export function go_to_box(go) {
  const input = element('input', {
    type: 'text',
    id: 'go-to',
    autocomplete: 'off',
    spellcheck: 'false',
    placeholder: 'Go to texel: x, y',
    'aria-label': 'Go to texel: x, y and, if you like, a level',
    'aria-describedby': 'go-to-problem',
  });
  const problem = element('span', {id: 'go-to-problem', class: 'problem', role: 'alert'});
  const form = element('form', {class: 'go-to'}, input, icon_button('Go', 'arrow', () => {}, {type: 'submit'}), problem);
  form.addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    const place = parse_texel(input.value);
    const wrong = place ? go(place) : 'Two whole numbers, as in 1024, 512; a third one is the level.';
    problem.textContent = wrong ?? '';
    input.toggleAttribute('aria-invalid', Boolean(wrong));
    if (!wrong) input.blur();
  });
  input.addEventListener('input', () => (problem.textContent = ''));
  input.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => event.key === 'Escape' && input.blur());
  return {element: form, focus: () => input.select()};
}
