import {element} from '../dom.js';

const idle_after = 8000, gone_after = 90_000;
/** Of the way to where a cursor was told to be, in a sixtieth of a second. */
const glide = 0.35;
const calm = matchMedia('(prefers-reduced-motion: reduce)');

/** The hands of the others, with their names: they glide over the map, and fade when they rest. */
export class Cursors {
  #people;
  #place;
  /** @type {Map<number, {node: HTMLElement, x: number, y: number}>} By session; texels. */
  #shown = new Map();
  #frame = 0;
  #timer = 0;
  element = element('div', {class: 'cursors', 'aria-hidden': 'true'});

  /**
   * @param {import('./people.js').People} people
   * @param {(texel: {x: number, y: number}) => number[] | null} place CSS pixels of the view.
   */
  constructor(people, place) {
    this.#people = people;
    this.#place = place;
    people.addEventListener('moved', () => this.draw_soon());
    this.#timer = setInterval(() => this.draw_soon(), 2000);  // somebody may have come to rest
  }

  close() {
    clearInterval(this.#timer);
    cancelAnimationFrame(this.#frame);
  }

  draw_soon() {
    if (!this.#frame) this.#frame = requestAnimationFrame(() => this.draw());
  }

  /** Call in each frame of the map, so that cursors stay where they are on it. */
  draw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    const now = performance.now();
    let moving = false;
    for (const [session, {node}] of this.#shown) {
      const person = this.#people.here.get(session);
      if (person?.at && now - person.moved < gone_after) continue;
      node.remove();
      this.#shown.delete(session);
    }
    for (const person of this.#people.here.values()) {
      if (!person.at || now - person.moved >= gone_after) continue;
      const shown = this.#shown.get(person.session) ?? this.#add(person);
      const [dx, dy] = [person.at.x - shown.x, person.at.y - shown.y];
      const share = calm.matches ? 1 : glide;
      shown.x += dx * share;
      shown.y += dy * share;
      const pixels = this.#place({x: shown.x, y: shown.y}), goal = this.#place(person.at);
      if (!pixels || !goal) continue;
      if (Math.hypot(goal[0] - pixels[0], goal[1] - pixels[1]) > 0.3) moving = true;
      else Object.assign(shown, person.at);
      shown.node.style.transform = `translate(${pixels[0]}px, ${pixels[1]}px)`;
      shown.node.classList.toggle('idle', now - person.moved > idle_after);
      const label = /** @type {HTMLElement} */ (shown.node.lastElementChild);
      if (label.textContent !== person.name) label.textContent = person.name;
    }
    if (moving) this.draw_soon();
  }

  /** @param {import('./people.js').Person} person */
  #add({session, name, colour, at}) {
    const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    svg.setAttribute('viewBox', '0 0 20 20');
    const arrow = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    arrow.setAttribute('d', 'M2 2l5.2 15 2.6-6.2L16 8.2z');
    svg.append(arrow);
    const node = element('div', {class: 'cursor'}, svg, element('span', {text: name}));
    node.style.setProperty('--person', colour);
    this.element.append(node);
    const shown = {node, x: at?.x ?? 0, y: at?.y ?? 0};
    this.#shown.set(session, shown);
    return shown;
  }
}
