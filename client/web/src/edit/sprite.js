/**
 * A sprite as the editor holds it; positions in texels of level 0.
 * @typedef {{id: bigint, pattern: number, x: number, y: number, scale: number, turn: number, order: number,
 *   first_step: number, end_step: number, path: Path | null, more?: any}} Sprite `more`: what the editor keeps as it is.
 * @typedef {{to_x: number, to_y: number, first_step: number, steps: number, then: number}} Path How it moves by itself, from (x, y) on.
 */

export const least_scale = 1 / 64, most_scale = 4;

const thens = ['rest', 'repeat', 'reverse'];

/** @param {any} path A SpritePath, of the stream or of JSON. @returns {Path | null} */
function path_of(path) {
  if (!path) return null;
  const then = typeof path.then === 'string' ? thens.indexOf(path.then) : path.then ?? 0;
  return {to_x: path.toX ?? path.to_x ?? 0, to_y: path.toY ?? path.to_y ?? 0, first_step: Number(path.firstStep ?? path.first_step ?? 0), steps: path.steps ?? 1, then};
}

/** Where it is at a step, as one of the same kind that rests there. @param {Sprite} sprite @param {number} step @returns {Sprite} */
export function at_step(sprite, step) {
  const {path} = sprite;
  if (!path) return sprite;
  const since = Math.max(0, step - path.first_step);
  const turning = since % (2 * path.steps);
  const done = path.then === 0 ? Math.min(since, path.steps) : path.then === 1 ? since % path.steps : Math.min(turning, 2 * path.steps - turning);
  const share = done / path.steps;
  return {...sprite, x: sprite.x + (path.to_x - sprite.x) * share, y: sprite.y + (path.to_y - sprite.y) * share};
}

/**
 * What it shows at a step: its animation's pattern then, as the pages do; its own while it has none that is known.
 * @param {Sprite} sprite @param {number} step @param {{pattern?: number, steps?: number}[][]} animations The scene's, by index.
 */
export function shown_pattern(sprite, step, animations) {
  const frames = animations[sprite.more?.animation ?? -1];
  if (!frames) return sprite.pattern;
  const run = BigInt(frames.reduce((sum, {steps = 1}) => sum + steps, 0));
  let left = Number((((BigInt(Math.floor(step)) + (sprite.more.phase ?? 0n)) % run) + run) % run);
  return frames.find(({steps = 1}) => (left -= steps) < 0)?.pattern ?? 0;
}

/** @param {any} placed A SpritePlacement, of the stream (camelCase, BigInts) or of JSON (snake_case, text). @returns {Sprite} */
export function sprite_of(placed) {
  const whole = (/** @type {any} */ value) => (value === undefined ? undefined : BigInt(value));
  const number = (/** @type {any} */ value, /** @type {number} */ usual) => (value === undefined ? usual : Number(value));
  return {
    id: BigInt(placed.id), pattern: placed.pattern ?? 0, x: number(placed.x, 0), y: number(placed.y, 0), scale: placed.scale ?? 1,
    turn: placed.turn ?? 0, order: placed.order ?? 0, path: path_of(placed.path),
    first_step: number(placed.firstStep ?? placed.first_step, -Infinity), end_step: number(placed.endStep ?? placed.end_step, Infinity),
    more: {animation: placed.animation, phase: whole(placed.phase), firstStep: whole(placed.firstStep ?? placed.first_step), endStep: whole(placed.endStep ?? placed.end_step)},
  };
}

/** As the server counts: positions in 256ths of a texel, scales and turns in 65536ths. @param {Sprite} sprite @returns {Sprite} */
export function settled(sprite) {
  const scale = Math.min(most_scale, Math.max(least_scale, Math.round(sprite.scale * 65536) / 65536));
  const turn = ((Math.round(sprite.turn * 65536) / 65536) % 1 + 1) % 1;
  const whole = (/** @type {number} */ texels) => Math.round(texels * 256) / 256;
  const path = sprite.path && {...sprite.path, to_x: whole(sprite.path.to_x), to_y: whole(sprite.path.to_y)};
  return {...sprite, x: whole(sprite.x), y: whole(sprite.y), path, scale, turn};
}

/** A SpritePlacement. @param {Sprite} sprite */
export const placement_of = ({id, pattern, x, y, scale, turn, order, path, more}) => ({
  id, pattern, x, y, scale, turn, order, ...more,
  ...(path && {path: {toX: path.to_x, toY: path.to_y, firstStep: BigInt(path.first_step), steps: path.steps, then: path.then}}),
});

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

/** The texels that it may colour at any step. @param {Sprite} sprite @param {number} side */
export const way_of = (sprite, side) =>
  box_around([box_of(sprite, side), ...(sprite.path ? [box_of({...sprite, x: sprite.path.to_x, y: sprite.path.to_y}, side)] : [])]);

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
  const moved = (/** @type {number} */ x, /** @type {number} */ y) => {
    const [u, v] = [x - about.x, y - about.y];
    return [about.x + u * cos - v * sin + dx, about.y + u * sin + v * cos + dy];
  };
  return sprites.map((sprite) => {
    const [x, y] = moved(sprite.x, sprite.y);
    const [to_x, to_y] = sprite.path ? moved(sprite.path.to_x, sprite.path.to_y) : [0, 0];
    return settled({...sprite, x, y, path: sprite.path && {...sprite.path, to_x, to_y}, scale: sprite.scale * scale, turn: sprite.turn + turn});
  });
}

/** The changes that make `from` what `to` is; none if they are alike. @param {Sprite} from @param {Sprite} to */
export function changes_between(from, to) {
  const names = /** @type {const} */ (['x', 'y', 'scale', 'turn', 'order', 'pattern']);
  const different = names.filter((name) => from[name] !== to[name]);
  if (from.path && to.path && (from.path.to_x !== to.path.to_x || from.path.to_y !== to.path.to_y)) {
    // A move leaves the path where it is: the sprite is taken away and placed with all of its way
    return [{change: {case: 'removeSprite', value: {id: from.id}}}, {change: {case: 'placeSprite', value: placement_of(to)}}];
  }
  if (different.length === 0) return [];
  return [{change: {case: 'moveSprite', value: Object.fromEntries([['id', to.id], ...different.map((name) => [name, to[name]])])}}];
}
