/** Colours of people: bright enough over any texture, and told apart by most eyes. */
const colours = ['#e9b872', '#7cc4e8', '#d98fb8', '#9ccc7a', '#f08a6c', '#b39ddb', '#5fd0b0', '#e6d35c'];

/** @param {number} session */
export const colour_of = (session) => colours[session % colours.length];

/** @typedef {{session: number, name: string, colour: string, may_edit: boolean, at: {x: number, y: number} | null, level: number, held: any, selected: bigint[], moved: number}} Person */

/** Who else is here. Fires `change` when somebody comes, goes or has another name, and `moved` when somebody moves. */
export class People extends EventTarget {
  /** @type {Map<number, Person>} By session. */
  here = new Map();

  /** @param {any} present A Present. */
  tell({people, left}) {
    let changed = left.length > 0;
    for (const session of left) this.here.delete(Number(session));
    for (const {session: number, name, presence, mayEdit: may_edit} of people) {
      const session = Number(number);
      const known = this.here.get(session);
      const at = presence?.x !== undefined && presence.y !== undefined ? {x: presence.x, y: presence.y} : null;
      changed ||= !known || known.name !== name || known.may_edit !== may_edit;
      this.here.set(session, {
        session, name: name || 'Somebody', may_edit, colour: colour_of(session), at, level: presence?.level ?? 0,
        held: presence?.held ?? null, selected: presence?.selected ?? [],
        moved: known && at?.x === known.at?.x && at?.y === known.at?.y ? known.moved : performance.now(),
      });
    }
    this.dispatchEvent(new Event('moved'));
    if (changed) this.dispatchEvent(new Event('change'));
  }

  /** How a session is called. @param {number} session @param {string} author As the edit says. */
  name_of(session, author) {
    return author || this.here.get(session)?.name || 'Somebody';
  }

  clear() {
    if (this.here.size === 0) return;
    this.here.clear();
    this.dispatchEvent(new Event('moved'));
    this.dispatchEvent(new Event('change'));
  }
}
