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
