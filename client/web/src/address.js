import {short_decimal} from './numbers.js';

/**
 * What the address names: nothing (the list of scenes), a scene, or a view of a scene.
 * `level` is log2 of the texels under one pixel of the page: negative when texels are magnified.
 * `x`, `y`: the texel of level 0 in the middle of the view.
 * @typedef {{level: number, x: number, y: number}} View
 * @typedef {{scene: string | null, view: View | null, options: Record<string, string>}} Address
 */

/** @param {string} hash As in location.hash. @returns {Address} */
export function parse_address(hash) {
  const [path, query = ''] = hash.replace(/^#/, '').split('?');
  const [scene_text, ...numbers] = path.split('/');
  const [level, x, y] = numbers.map((text) => (text === '' ? NaN : Number(text)));
  const complete = numbers.length === 3 && [level, x, y].every(Number.isFinite);
  return {
    scene: decoded(scene_text) || null,
    view: complete ? {level, x, y} : null,
    options: Object.fromEntries(new URLSearchParams(query)),
  };
}

/** @param {Address} address @returns {string} A hash, "#" included. */
export function format_address({scene, view, options}) {
  if (!scene) return '#';
  const path = [encodeURIComponent(scene)];
  if (view) {
    // Whole texels are enough until one of them is larger than a pixel
    const position = view.level >= 0 ? (value) => String(Math.round(value)) : short_decimal;
    path.push(short_decimal(view.level), position(view.x), position(view.y));
  }
  const query = new URLSearchParams(options).toString();
  return `#${path.join('/')}${query ? `?${query}` : ''}`;
}

/** @param {string} text A hand-edited address may hold a stray "%". */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
