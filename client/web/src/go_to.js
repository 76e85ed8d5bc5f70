import {element, icon_button} from './dom.js';
import {parse_texel} from './texel_text.js';

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
