// A scene of sprites over one colour, edited over the stream as the real server lets it: for the moments that a fast server
// does not have, such as a page that comes late.
import {box_pages, start_stream_server} from './stream_server.mjs';
import {page_of_texels} from './png.mjs';

export const ground = [52, 84, 70];
export const side = 64;
/** Of the patterns: a full square, and one with a clear border. */
export const pattern_colours = [[222, 164, 66], [190, 70, 90]];

const covers = (sprite, x, y) => {
  const [dx, dy] = [x - sprite.x, y - sprite.y];
  const [cos, sin] = [Math.cos((sprite.turn ?? 0) * 2 * Math.PI), Math.sin((sprite.turn ?? 0) * 2 * Math.PI)];
  const half = ((sprite.pattern === 1 ? 0.6 : 1) * side * (sprite.scale ?? 1)) / 2;
  return Math.abs(dx * cos + dy * sin) < half && Math.abs(dy * cos - dx * sin) < half;
};

const box_of = ({x, y, scale = 1}) => {
  const half = side * scale * 0.75;
  return {x0: Math.floor(x - half), y0: Math.floor(y - half), x1: Math.ceil(x + half), y1: Math.ceil(y + half)};
};

/** Of the scene: both patterns, each for two steps. */
const animations = [{frames: [{steps: 2}, {pattern: 1, steps: 2}]}];
const frame_at = (sprite, step) => (sprite.animation === undefined ? sprite : {...sprite, pattern: Math.floor(step / 2) % 2});

/** @param {{web: string, sprites?: any[], page_delay?: number, hello?: object, clock?: object}} options Sprites: {id, pattern, x, y, …}. */
export async function start_sprite_server({web, sprites = [], page_delay = 0, hello = {}, clock = {}}) {
  const here = new Map(sprites.map((sprite) => [BigInt(sprite.id), {scale: 1, turn: 0, order: 0, ...sprite, id: BigInt(sprite.id)}]));
  const lifted_asked = [];
  const state = {refuse: null};
  const texels = (level, x, y, without, step) => {
    const size = 2 ** level;
    const shown = [...here.values()].filter(({id}) => !without.includes(id)).map((sprite) => frame_at(sprite, step)).sort((a, b) => a.order - b.order || Number(a.id - b.id));
    return page_of_texels((u, v) => {
      const [tx, ty] = [(x * 256 + u + 0.5) * size, (y * 256 + v + 0.5) * size];
      const top = shown.findLast((sprite) => covers(sprite, tx, ty));
      return [...(top ? pattern_colours[top.pattern] : ground), 255];
    });
  };
  const server = await start_stream_server({
    web, page_delay, clock, hello: {patterns: ['square', 'small square'], patternSideTexels: side, mayEdit: true, takesEdits: true, ...hello},
    page_of: (level, x, y, url) => {
      const ids = url.pathname.match(/\/without-([\d,]+)\//)?.[1].split(',').map(BigInt) ?? [];
      if (ids.length > 0) lifted_asked.push(url.pathname);
      return texels(level, x, y, ids, Number(url.searchParams.get('step') ?? 0));
    },
    answer_other: (response, url) => {
      const pattern = url.pathname.match(/\/patterns\/(\d)\.png$/)?.[1];
      if (pattern !== undefined) {
        const inset = pattern === '1' ? side * 0.2 : 0;
        response.setHeader('content-type', 'image/png').end(page_of_texels((u, v) =>
          Math.min(u, v) >= inset && Math.max(u, v) < side - inset ? [...pattern_colours[pattern], 255] : [0, 0, 0, 0]));
        return true;
      }
      if (url.pathname === '/scenes/tints/editables') {
        response.setHeader('content-type', 'application/json').end(JSON.stringify({revision: String(server.scene.revision), sprite_animations: animations}));
        return true;
      }
      if (url.pathname !== '/scenes/tints/sprites') return false;
      const [x0, y0, x1, y1] = ['x0', 'y0', 'x1', 'y1'].map((name) => Number(url.searchParams.get(name)));
      const met = [...here.values()].filter((sprite) => sprite.x > x0 && sprite.x < x1 && sprite.y > y0 && sprite.y < y1);
      response.setHeader('content-type', 'application/json').end(JSON.stringify({revision: String(server.scene.revision), sprites: met.map((sprite) => ({...sprite, id: String(sprite.id)}))}));
      return true;
    },
    edit: (edit, {done, refuse}) => {
      if (state.refuse) return refuse(state.refuse);
      const inverse = [], boxes = [];
      for (const {change: {case: kind, value}} of edit.changes) {
        const id = value.id;
        const old = here.get(id);
        if (kind !== 'placeSprite' && kind !== 'setClock' && !old) return refuse({why: 0, detail: `changes[0]: there is no sprite ${id}`});
        if (kind === 'placeSprite') {
          here.set(id, {scale: 1, turn: 0, order: 0, ...Object.fromEntries(Object.entries(value).filter(([name, of]) => of !== undefined && !name.startsWith('$')))});
          inverse.unshift({change: {case: 'removeSprite', value: {id}}});
        } else if (kind === 'removeSprite') {
          here.delete(id);
          inverse.unshift({change: {case: 'placeSprite', value: old}});
        } else if (kind === 'moveSprite') {
          const told = Object.fromEntries(['x', 'y', 'scale', 'turn', 'order', 'pattern'].filter((name) => value[name] !== undefined).map((name) => [name, value[name]]));
          here.set(id, {...old, ...told});
          inverse.unshift({change: {case: 'moveSprite', value: {id, ...Object.fromEntries(Object.keys(told).map((name) => [name, old[name]]))}}});
        }
        for (const sprite of [old, here.get(id)]) if (sprite) boxes.push(box_of(sprite));
      }
      server.touch(box_pages(boxes, 4), (revision) =>
        done({answer: {revision: BigInt(revision), inverse: {changes: inverse}, dirty: boxes.map(({x0, y0, x1, y1}) => ({x0: BigInt(x0), y0: BigInt(y0), x1: BigInt(x1), y1: BigInt(y1)}))}}));
    },
  });
  /** Another session's edit. @param {bigint} session @param {bigint} id @param {{x: number, y: number}} to */
  const move_by = (session, id, to) => {
    const old = here.get(id);
    here.set(id, {...old, ...to});
    const boxes = [box_of(old), box_of(here.get(id))];
    const dirty = boxes.map(({x0, y0, x1, y1}) => ({x0: BigInt(x0), y0: BigInt(y0), x1: BigInt(x1), y1: BigInt(y1)}));
    server.touch(box_pages(boxes, 4), (revision) =>
      server.tell_all('editDone', {id: `other-${revision}`, session, author: 'Anna', answer: {revision: BigInt(revision), dirty}, changes: [{change: {case: 'moveSprite', value: {id, ...to}}}]}));
  };
  return {...server, here, lifted_asked, state, move_by};
}
