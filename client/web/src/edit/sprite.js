/**
 * A sprite as the editor holds it; positions in texels of level 0.
 * @typedef {{id: bigint, pattern: number, x: number, y: number, scale: number, turn: number, order: number, moves: boolean,
 *   first_step: number, end_step: number, more?: any}} Sprite `more`: what the editor keeps as it is.
 */

export const least_scale = 1 / 64, most_scale = 4;

/** @param {any} placed A SpritePlacement, of the stream (camelCase, BigInts) or of JSON (snake_case, text). @returns {Sprite} */
export function sprite_of(placed) {
  const whole = (/** @type {any} */ value) => (value === undefined ? undefined : BigInt(value));
  const number = (/** @type {any} */ value, /** @type {number} */ usual) => (value === undefined ? usual : Number(value));
  return {
    id: BigInt(placed.id), pattern: placed.pattern ?? 0, x: number(placed.x, 0), y: number(placed.y, 0), scale: placed.scale ?? 1,
    turn: placed.turn ?? 0, order: placed.order ?? 0, moves: Boolean(placed.path),
    first_step: number(placed.firstStep ?? placed.first_step, -Infinity), end_step: number(placed.endStep ?? placed.end_step, Infinity),
    more: {animation: placed.animation, phase: whole(placed.phase), firstStep: whole(placed.firstStep ?? placed.first_step), endStep: whole(placed.endStep ?? placed.end_step)},
  };
}

/** As the server counts: positions in 256ths of a texel, scales and turns in 65536ths. @param {Sprite} sprite @returns {Sprite} */
export function settled(sprite) {
  const scale = Math.min(most_scale, Math.max(least_scale, Math.round(sprite.scale * 65536) / 65536));
  const turn = ((Math.round(sprite.turn * 65536) / 65536) % 1 + 1) % 1;
  return {...sprite, x: Math.round(sprite.x * 256) / 256, y: Math.round(sprite.y * 256) / 256, scale, turn};
}

/** A SpritePlacement. @param {Sprite} sprite */
export const placement_of = ({id, pattern, x, y, scale, turn, order, more}) => ({id, pattern, x, y, scale, turn, order, ...more});

/** An id that nobody else draws. */
export function new_sprite_id() {
  const [high, low] = crypto.getRandomValues(new Uint32Array(2));
  return (BigInt(high >>> 1) << 32n) | BigInt(low || 1);
}

/** Whether `a` is drawn before, and so below, `b`. @param {Sprite} a @param {Sprite} b */
export const drawn_before = (a, b) => a.order - b.order || (a.id < b.id ? -1 : a.id > b.id ? 1 : 0);

/** A sprite's corners, clockwise from its own top left. @param {Sprite} sprite @param {number} side Of its pattern. */
export function corners_of({x, y, scale, turn}, side) {
  const half = (side * scale) / 2;
  const [cos, sin] = [Math.cos(turn * 2 * Math.PI), Math.sin(turn * 2 * Math.PI)];
  return [[-half, -half], [half, -half], [half, half], [-half, half]].map(([u, v]) => ({x: x + u * cos - v * sin, y: y + u * sin + v * cos}));
}

/** The texels that it may colour. @param {Sprite} sprite @param {number} side */
export function box_of(sprite, side) {
  const corners = corners_of(sprite, side);
  const [xs, ys] = [corners.map(({x}) => x), corners.map(({y}) => y)];
  return {x0: Math.min(...xs) - 1, y0: Math.min(...ys) - 1, x1: Math.max(...xs) + 1, y1: Math.max(...ys) + 1};
}

/** @param {{x0: number, y0: number, x1: number, y1: number}} a @param {{x0: number, y0: number, x1: number, y1: number}} b */
export const boxes_meet = (a, b) => a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;

/** @param {{x0: number, y0: number, x1: number, y1: number}[]} boxes At least one. */
export const box_around = (boxes) => ({
  x0: Math.min(...boxes.map(({x0}) => x0)), y0: Math.min(...boxes.map(({y0}) => y0)),
  x1: Math.max(...boxes.map(({x1}) => x1)), y1: Math.max(...boxes.map(({y1}) => y1)),
});

/** The box of a page in texels of level 0. @param {import('../texture.js').PageKey} page */
export function box_of_page({level, x, y}) {
  const side = 256 * 2 ** level;
  return {x0: x * side, y0: y * side, x1: (x + 1) * side, y1: (y + 1) * side};
}

/**
 * Sprites moved, and scaled and turned about a point.
 * @param {Sprite[]} sprites @param {{dx?: number, dy?: number, scale?: number, turn?: number, about?: {x: number, y: number}}} how
 */
export function transformed(sprites, {dx = 0, dy = 0, scale = 1, turn = 0, about = {x: 0, y: 0}}) {
  const [cos, sin] = [Math.cos(turn * 2 * Math.PI) * scale, Math.sin(turn * 2 * Math.PI) * scale];
  return sprites.map((sprite) => {
    const [u, v] = [sprite.x - about.x, sprite.y - about.y];
    return settled({...sprite, x: about.x + u * cos - v * sin + dx, y: about.y + u * sin + v * cos + dy, scale: sprite.scale * scale, turn: sprite.turn + turn});
  });
}

/** The change that makes `from` what `to` is; null if there is none. @param {Sprite} from @param {Sprite} to */
export function move_between(from, to) {
  const names = /** @type {const} */ (['x', 'y', 'scale', 'turn', 'order', 'pattern']);
  const different = names.filter((name) => from[name] !== to[name]);
  if (different.length === 0) return null;
  return {change: {case: 'moveSprite', value: Object.fromEntries([['id', to.id], ...different.map((name) => [name, to[name]])])}};
}
