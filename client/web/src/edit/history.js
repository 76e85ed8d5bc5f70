const most_remembered = 200;

/** What can be undone and done again: the server's own inverse edits. Fires `change`. */
export class History extends EventTarget {
  #make;
  /** @type {any[][]} Changes that undo. */
  #undo = [];
  /** @type {any[][]} Changes that do again. */
  #redo = [];
  #busy = Promise.resolve();

  /** @param {(changes: any[]) => Promise<any>} make Makes an edit; its answer. */
  constructor(make) {
    super();
    this.#make = make;
  }

  get can_undo() {
    return this.#undo.length > 0;
  }

  get can_redo() {
    return this.#redo.length > 0;
  }

  /** Something was done. @param {any} answer An EditAnswer. */
  done(answer) {
    this.#redo = [];
    this.#remember(this.#undo, answer);
  }

  /** One after the other, however fast they are asked for. Throws what the server says. */
  undo() {
    return this.#go(this.#undo, this.#redo);
  }

  redo() {
    return this.#go(this.#redo, this.#undo);
  }

  /** @param {any[][]} from @param {any[][]} to */
  #go(from, to) {
    const turn = this.#busy.then(async () => {
      const changes = from.pop();
      if (!changes) return false;
      this.dispatchEvent(new Event('change'));
      this.#remember(to, await this.#make(changes));
      return true;
    });
    this.#busy = turn.then(() => {}, () => {});
    return turn;
  }

  /** @param {any[][]} stack @param {any} answer */
  #remember(stack, answer) {
    if (answer.inverse?.changes.length) stack.push(answer.inverse.changes);
    if (stack.length > most_remembered) stack.shift();
    this.dispatchEvent(new Event('change'));
  }
}
