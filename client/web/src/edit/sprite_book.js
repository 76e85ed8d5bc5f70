import {ask, refusal} from '../server.js';
import {at_step, box_of, boxes_meet, drawn_before, sprite_of} from './sprite.js';

const most_edits = 256;
/** A sprite on screen can be taken hold of in a square of at least so many pixels. */
const least_hold_pixels = 14;

/** The sprites around the view, kept up to date by everybody's edits. Fires `change`. */
export class SpriteBook extends EventTarget {
  #texture;
  #patterns;
  /** @type {Map<bigint, import('./sprite.js').Sprite>} */
  #sprites = new Map();
  /** @type {import('./sprite.js').Sprite[] | null} In the order of drawing. */
  #sorted = null;
  /** @type {{x0: number, y0: number, x1: number, y1: number} | null} Of which all are known. */
  #box = null;
  /** @type {{revision: number, changes: any[]}[]} The latest, to be made again on a list that is older. */
  #edits = [];
  #asking = false;
  #again = false;
  /** @type {{x0: number, y0: number, x1: number, y1: number} | null} */
  #view = null;
  #closed = false;
  /** There are more in the view than are known. */
  partial = false;

  /** @param {import('../texture.js').Texture} texture @param {import('./pattern_images.js').PatternImages} patterns */
  constructor(texture, patterns) {
    super();
    this.#texture = texture;
    this.#patterns = patterns;
  }

  close() {
    this.#closed = true;
  }

  /** @param {{x0: number, y0: number, x1: number, y1: number}} view Texels. */
  look_at(view) {
    this.#view = view;
    const box = this.#box;
    const inside = box && box.x0 <= view.x0 && box.y0 <= view.y0 && box.x1 >= view.x1 && box.y1 >= view.y1;
    const closer = this.partial && box && view.x1 - view.x0 < (box.x1 - box.x0) / 2.5;
    if (!inside || closer) this.#ask();
  }

  /** What is known may be wrong. */
  forget() {
    this.#box = null;
    if (this.#view) this.#ask();
  }

  /** @param {bigint} id */
  find(id) {
    return this.#sprites.get(id);
  }

  /** In the order of drawing. */
  get list() {
    this.#sorted ??= [...this.#sprites.values()].sort(drawn_before);
    return this.#sorted;
  }

  /** The uppermost sprite at a place. @param {{x: number, y: number}} texel @param {number} resolution Texels of a pixel. @param {number} step */
  at({x, y}, resolution, step) {
    const least_half = (least_hold_pixels / 2) * resolution;
    for (let i = this.list.length - 1; i >= 0; --i) {
      const sprite = at_step(this.list[i], step);
      const whole = this.#patterns.side * sprite.scale;
      const [dx, dy] = [x - sprite.x, y - sprite.y];
      if (Math.max(Math.abs(dx), Math.abs(dy)) > Math.max(whole, least_half)) continue;
      if (step < sprite.first_step || step >= sprite.end_step) continue;
      if (whole / 2 < least_half && Math.abs(dx) < least_half && Math.abs(dy) < least_half) return this.list[i];
      const [cos, sin] = [Math.cos(sprite.turn * 2 * Math.PI), Math.sin(sprite.turn * 2 * Math.PI)];
      if (this.#patterns.covers(this.#patterns.shown(sprite, step), (dx * cos + dy * sin) / whole + 0.5, (dy * cos - dx * sin) / whole + 0.5)) return this.list[i];
    }
    return undefined;
  }

  /** Those whose middle lies in a box at a step. @param {{x0: number, y0: number, x1: number, y1: number}} box @param {number} step */
  within({x0, y0, x1, y1}, step) {
    return this.list.filter((sprite) => {
      const {x, y} = at_step(sprite, step);
      return x0 <= x && x < x1 && y0 <= y && y < y1;
    });
  }

  /** An edit was made. @param {any[]} changes @param {number} revision @param {any[]} dirty */
  take(changes, revision, dirty) {
    this.#edits.push({revision, changes});
    if (this.#edits.length > most_edits) this.#edits.shift();
    if (!this.#make(changes, dirty)) this.#ask();
    this.dispatchEvent(new Event('change'));
  }

  /** False if a list is needed to know what is there now. @param {any[]} changes @param {any[]} dirty */
  #make(changes, dirty) {
    this.#sorted = null;
    let known = changes.length > 0 || !dirty?.some((box) => this.#box && boxes_meet(this.#box, numbers_of(box)));
    for (const {change: {case: kind, value}} of changes) {
      if (kind === 'placeSprite') {
        const sprite = sprite_of(value);
        if (this.#box && boxes_meet(this.#box, box_of(sprite, this.#patterns.side))) this.#sprites.set(sprite.id, sprite);
      } else if (kind === 'removeSprite') {
        this.#sprites.delete(value.id);
      } else if (kind === 'moveSprite') {
        const sprite = this.#sprites.get(value.id);
        const told = Object.fromEntries(['x', 'y', 'scale', 'turn', 'order', 'pattern'].filter((name) => value[name] !== undefined).map((name) => [name, value[name]]));
        if (sprite) this.#sprites.set(value.id, {...sprite, ...told});
        else if (this.#box && told.x !== undefined && told.y !== undefined && boxes_meet(this.#box, {x0: told.x - 1, y0: told.y - 1, x1: told.x + 1, y1: told.y + 1})) known = false;
      }
    }
    return known;
  }

  async #ask() {
    this.#again = true;
    if (this.#asking) return;
    this.#asking = true;
    while (this.#again && !this.#closed) {
      this.#again = false;
      const {x0, y0, x1, y1} = /** @type {any} */ (this.#view);
      const [dx, dy] = [(x1 - x0) / 2, (y1 - y0) / 2];
      const box = {x0: Math.floor(x0 - dx), y0: Math.floor(y0 - dy), x1: Math.ceil(x1 + dx), y1: Math.ceil(y1 + dy)};
      try {
        const response = await ask(`/scenes/${encodeURIComponent(this.#texture.id)}/sprites?x0=${box.x0}&y0=${box.y0}&x1=${box.x1}&y1=${box.y1}`, {cache: 'no-store'});
        if (!response.ok) throw await refusal(response);
        const {revision = 0, sprites = [], more = false} = await response.json();
        this.#sprites = new Map(sprites.map(sprite_of).map((/** @type {any} */ sprite) => [sprite.id, sprite]));
        this.#box = box;
        this.partial = more;
        for (const edit of this.#edits.filter((edit) => edit.revision > Number(revision))) this.#make(edit.changes, []);
      } catch {
        await new Promise((resolve) => setTimeout(resolve, 1500));
        this.#again = true;
      }
      this.#sorted = null;
      this.dispatchEvent(new Event('change'));
    }
    this.#asking = false;
  }
}

/** @param {any} box A DirtyBox. */
export const numbers_of = ({x0, y0, x1, y1}) => ({x0: Number(x0), y0: Number(y0), x1: Number(x1), y1: Number(y1)});
