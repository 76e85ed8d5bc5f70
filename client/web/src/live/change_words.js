import {with_separators} from '../numbers.js';

/** What each kind of change does, to one and to several. @type {Record<string, (count: number) => string>} */
const deeds = {
  placeSprite: (count) => (count === 1 ? 'placed a sprite' : `placed ${with_separators(count)} sprites`),
  moveSprite: (count) => (count === 1 ? 'moved a sprite' : `moved ${with_separators(count)} sprites`),
  removeSprite: (count) => (count === 1 ? 'removed a sprite' : `removed ${with_separators(count)} sprites`),
  paintMap: () => 'painted',
  setParameter: (count) => (count === 1 ? 'set a parameter' : `set ${with_separators(count)} parameters`),
  changeAnimation: () => 'changed an animation',
  setTarget: (count) => (count === 1 ? 'moved a target' : `moved ${with_separators(count)} targets`),
  removeTarget: (count) => (count === 1 ? 'removed a target' : `removed ${with_separators(count)} targets`),
  setClock: () => 'set the clock',
};

/** A move that only turns, or only scales, says so. @param {any} move */
const move_kind = ({x, y, turn, scale}) => (x !== undefined || y !== undefined ? 'moved' : turn !== undefined ? 'turned' : scale !== undefined ? 'scaled' : 'changed');

/** @param {any[]} moves */
function move_words(moves) {
  const kinds = new Set(moves.map(move_kind));
  const words = deeds.moveSprite(moves.length);
  return kinds.size === 1 ? words.replace('moved', [...kinds][0]) : words;
}

/** @param {any} clock A ClockChange. */
const clock_words = ({playing, step, stepsPerSecond}) =>
  step !== undefined ? `set the clock to step ${with_separators(Number(step))}`
  : playing !== undefined ? (playing ? 'let the clock run' : 'stopped the clock')
  : stepsPerSecond !== undefined ? `set the clock to ${Math.round(stepsPerSecond * 100) / 100} steps a second` : 'set the clock';

/**
 * "moved 3 sprites and painted".
 * @param {any[]} changes Of an edit; empty: they are not known.
 */
export function change_words(changes) {
  /** @type {Map<string, any[]>} */
  const kinds = new Map();
  for (const {change} of changes) {
    if (!change.case) continue;
    if (!kinds.has(change.case)) kinds.set(change.case, []);
    kinds.get(change.case)?.push(change.value);
  }
  const parts = [...kinds].map(([kind, values]) =>
    kind === 'moveSprite' ? move_words(values) : kind === 'setClock' ? clock_words(values[values.length - 1]) : deeds[kind]?.(values.length) ?? 'changed something',
  );
  if (parts.length === 0) return 'changed something';
  return parts.length === 1 ? parts[0] : `${parts.slice(0, -1).join(', ')} and ${parts[parts.length - 1]}`;
}

/** @param {any[]} dirty Boxes of texels. @returns {{x: number, y: number, side: number} | null} The middle and size of what they cover. */
export function place_of_dirt(dirty) {
  if (!dirty?.length) return null;
  const [x0, y0] = ['x0', 'y0'].map((name) => Math.min(...dirty.map((box) => Number(box[name]))));
  const [x1, y1] = ['x1', 'y1'].map((name) => Math.max(...dirty.map((box) => Number(box[name]))));
  return {x: (x0 + x1) / 2, y: (y0 + y1) / 2, side: Math.max(x1 - x0, y1 - y0)};
}
