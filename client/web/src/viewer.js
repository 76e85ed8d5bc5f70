import DoubleClickZoom from 'ol/interaction/DoubleClickZoom.js';
import DragZoom from 'ol/interaction/DragZoom.js';

import {format_address} from './address.js';
import {watch_cache} from './cache_watch.js';
import {element, icon_button} from './dom.js';
import {Editor} from './edit/editor.js';
import {go_to_box} from './go_to.js';
import {listen_to_keys} from './keyboard.js';
import {level_range, LevelRail} from './level_rail.js';
import {with_separators} from './numbers.js';
import {PageGridLayer} from './page_grid_layer.js';
import {level_for, PageLayer} from './page_layer.js';
import {PageLedger} from './page_ledger.js';
import {PageStore} from './page_store.js';
import {Player, step_chosen} from './player.js';
import {ReadOut, ScaleBar} from './read_out.js';
import {Live} from './live/live.js';
import {SceneClock} from './live/scene_clock.js';
import {connection} from './server.js';
import {make_map} from './texture_map.js';
import {copy_link, toggle_fullscreen} from './viewer_actions.js';
import {viewer_element} from './viewer_element.js';
import {ViewMotion} from './view_motion.js';
import {Viewing} from './viewing.js';
import {WaitingSign} from './waiting_sign.js';

/** The viewer of one texture: map, bars and keys. */
export class Viewer {
  #closed = new AbortController();
  #ledger = new PageLedger();
  #store;
  #pages;
  #grid;
  #clock = new SceneClock();
  /** @type {import('ol/Map.js').default} */
  #map;
  #motion;
  /** @type {{x: number, y: number} | null} The texel under the pointer. */
  #pointer = null;
  #frame = 0;
  #settle = 0;

  /**
   * @param {import('./texture.js').Texture} texture
   * @param {import('./address.js').Address} address
   * @param {{
   *   say: (text: string) => void, help: () => void, leave: () => void, stale: () => void,
   *   moved: (hash: string, jump: boolean) => void
   * }} page `moved` is told the address of each new view; a jump deserves an entry in the history.
   */
  constructor(texture, address, page) {
    this.texture = texture;
    this.page = page;
    this.viewing = new Viewing(texture, address.options, {
      ask: () => this.#store.set_request(this.#request()),
      texels: (smooth) => this.#set_smooth(smooth),
      chosen: () => this.page.moved(this.#hash(), false),
      say: page.say,
    });
    this.step = step_chosen(address.options.step, texture.animated) ?? 0;
    this.#store = new PageStore(texture, this.#ledger, this.#request(), page.stale);
    this.#pages = new PageLayer(texture, this.#store);
    this.#pages.smooth = this.viewing.smooth;
    this.#grid = new PageGridLayer(texture, this.#ledger, () => this.#room().top);
    this.#grid.shown = address.options.grid === '1';
    this.#clock.follow_wall(texture);
    this.live = new Live(texture, this.#store, this.#clock, {
      stale: page.stale,
      place: ({x, y}) => this.#map.getPixelFromCoordinate([x, -y]),
      go: (place) => {
        this.page.moved(this.#hash(), true);
        this.#motion.fly_to(place);
      },
    });
    this.#build();
    this.#map = this.#make_map();
    this.#motion = new ViewMotion(this.#view, texture, () => this.#room());
    this.#listen();
    this.show(address);
    this.player.offer(step_chosen(address.options.step, texture.animated));
  }

  /** Call when the element is in the document. */
  opened() {
    document.title = `${this.texture.title} · Tessera`;
    this.#map.setTarget(this.canvas);
    this.live.open();
  }

  close() {
    this.#closed.abort();
    this.player.close();
    this.editor.close();
    this.live.close();
    clearTimeout(this.#settle);
    this.viewing.close();
    cancelAnimationFrame(this.#frame);
    this.#map.setTarget(undefined);
    this.#map.dispose();
    this.#store.close();
  }

  /** Takes over the view and options of an address of this texture. @param {import('./address.js').Address} address */
  show({view, options}) {
    this.viewing.take(options);
    this.#set_grid(options.grid === '1');
    const middle = this.texture.side_texels / 2;
    const {level, x, y} = view ?? this.texture.view ?? {level: Math.min(1, this.texture.coarsest_level), x: middle, y: middle};
    const {finest, coarsest} = level_range(this.texture);
    const clamp = (/** @type {number} */ value, /** @type {number} */ low, /** @type {number} */ high) => Math.min(high, Math.max(low, value));
    this.#view.cancelAnimations();
    this.#view.setResolution(2 ** clamp(level, finest, coarsest));
    this.#view.setCenter([clamp(x, 0, this.texture.side_texels), -clamp(y, 0, this.texture.side_texels)]);
  }

  /** The server's present description of the texture. @param {import('./texture.js').Texture} texture */
  refresh(texture) {
    this.texture = texture;
    this.#store.set_texture(texture);
    this.viewing.refresh(texture);
    this.live.set_texture(texture);
    if (!this.live.stream?.open) this.#clock.follow_wall(texture);
    this.player.offer(this.player.paused_at);
  }

  get #view() {
    return this.#map.getView();
  }

  #request() {
    return {...this.viewing.request, step: this.step};
  }

  #make_map() {
    const map = make_map(this.texture, [this.#pages, this.editor.layer, this.#grid]);
    map.on('pointermove', (event) => {
      if (event.dragging) return;
      const [x, y] = event.coordinate;
      this.#pointer = {x, y: -y};
      this.live.be_at({...this.#pointer, level: level_for(this.#view.getResolution() ?? 1, this.texture.coarsest_level)});
      this.#refresh_soon();
    });
    map.on('postrender', ({frameState}) => frameState && this.#after_frame(frameState));
    map.on('moveend', () => this.page.moved(this.#hash(), false));
    return map;
  }

  #build() {
    const texture = this.texture;
    this.canvas = element('div', {
      class: 'map',
      tabindex: 0,
      role: 'application',
      'aria-label': `${texture.title}. Arrow keys move, plus and minus zoom, H shows every key.`,
    });
    this.editor = this.#make_editor();
    this.#pages.instead = (page) => this.editor.carries.instead(page);
    this.read_out = new ReadOut(() => this.#retry(), this.live.sign.element);
    this.scale_bar = new ScaleBar();
    this.rail = new LevelRail(level_range(texture), {
      go: (level) => this.#view.setResolution(2 ** level),
      step: (levels) => this.#motion.step(levels),
      fit: () => this.#motion.fit(),
    });
    this.go_to = go_to_box((place) => this.#go_to(place));
    this.waiting = new WaitingSign();
    this.player = new Player(this.#store, this.#clock, {
      change: (step) => this.#set_step(step),
      set_clock: (change) => this.#set_clock(change),
      say: this.page.say,
      chosen: () => this.page.moved(this.#hash(), false),
    });
    this.grid_button = icon_button('Page grid (G)', 'grid', () => this.#toggle_grid(), {'aria-pressed': 'false'});
    this.element = viewer_element(this, {
      copy_link: icon_button('Copy a link to this view (C)', 'link', () => this.#copy_link()),
      fullscreen: icon_button('Full screen (F)', 'fullscreen', () => toggle_fullscreen(this.page.say)),
      help: icon_button('Help (H)', 'help', this.page.help),
    });
  }

  #make_editor() {
    return new Editor(this.live, {
      texture: this.texture, store: this.#store, canvas: this.canvas,
      options: () => this.#request(),
      smooth: () => this.viewing.smooth,
      step: () => this.step,
      texel_at: (pixel) => {
        const coordinate = this.#map.getCoordinateFromPixel(pixel);
        return coordinate && {x: coordinate[0], y: -coordinate[1]};
      },
      resolution: () => this.#view.getResolution() ?? 1,
      view: () => {
        const size = this.#map.getSize();
        if (!size) return null;
        const [left, bottom, right, top] = this.#view.calculateExtent(size);
        return {x0: left, y0: -top, x1: right, y1: -bottom};
      },
      changed: () => this.#map?.render(),
      say: this.page.say,
      hold_still: (still) => {
        for (const interaction of this.#map.getInteractions().getArray()) {
          if (interaction instanceof DoubleClickZoom || interaction instanceof DragZoom) interaction.setActive(!still);
        }
      },
    });
  }

  #listen() {
    const until = {signal: this.#closed.signal};
    this.#ledger.addEventListener('change', () => this.#refresh_soon(true), until);
    connection.addEventListener('up', () => {
      this.#retry();
      this.page.stale();
      this.live.stream?.try_now();
    }, until);
    this.canvas.addEventListener('pointerleave', () => {
      this.#pointer = null;
      this.live.be_at({x: undefined, y: undefined});
      this.#refresh_soon();
    }, until);
    this.live.addEventListener('rights', () => this.player.set_rights(this.live.may_edit), until);
    this.element.addEventListener('pointerdown', ({target}) => {
      for (const part of [this.viewing.menu, this.player, this.live.panel]) if (!part.element.contains(target)) part.close_menu();
    }, until);
    const bars = new ResizeObserver(() => this.element.style.setProperty('--bars', `${Math.round(this.#room().top)}px`));
    bars.observe(this.element.querySelector('.top-bar'));
    this.#closed.signal.addEventListener('abort', () => bars.disconnect());
    watch_cache(this.#ledger, this.#closed.signal);
    const move = (/** @type {number} */ x, /** @type {number} */ y) => (/** @type {KeyboardEvent} */ event) => this.#motion.move(x, y, event.shiftKey);
    listen_to_keys(
      {
        ArrowLeft: move(-1, 0),
        ArrowRight: move(1, 0),
        ArrowUp: move(0, -1),
        ArrowDown: move(0, 1),
        '+': () => this.#motion.step(-1),
        '=': () => this.#motion.step(-1),
        '-': () => this.#motion.step(1),
        0: () => this.#motion.fit(),
        c: () => this.#copy_link(),
        e: () => this.#toggle_editor(),
        f: () => toggle_fullscreen(this.page.say),
        g: () => this.#toggle_grid(),
        h: this.page.help,
        '?': this.page.help,
        l: this.page.leave,
        m: ({shiftKey}) => this.viewing.next_channels(shiftKey ? -1 : 1),
        s: () => this.viewing.toggle_texels(),
        t: () => this.go_to.focus(),
        '/': () => this.go_to.focus(),
        ',': () => this.viewing.step_slice(-1),
        '.': () => this.viewing.step_slice(1),
        p: () => this.#toggle_player(),
        '[': () => this.#step_player(-1),
        ']': () => this.#step_player(1),
      },
      this.#closed.signal,
    );
  }

  /** @param {any} frame */
  #after_frame({extent: [left, bottom, right, top], viewState: {resolution}}) {
    const view = {x0: left, y0: -top, x1: right, y1: -bottom};
    this.live.watch?.look_at(view, level_for(resolution, this.texture.coarsest_level));
    this.live.cursors.draw();
    this.editor.look_at(view);
    this.waiting.show(this.#pages.bare && this.#ledger.loading > 0);
    this.#refresh_soon();
    clearTimeout(this.#settle);
    const keep = () => {
      if (this.#store.keep_to_wanted()) this.#settle = setTimeout(keep, 100);
    };
    this.#settle = setTimeout(keep, 30);
  }

  /** Brings the bars up to date, once a frame; and the grid, when a page's state changed. */
  #refresh_soon(pages_changed = false) {
    if (pages_changed && this.#grid.shown) this.#grid.changed();
    if (this.#frame) return;
    this.#frame = requestAnimationFrame(() => {
      this.#frame = 0;
      const resolution = this.#view.getResolution() ?? 1;
      const [x, y] = this.#view.getCenter() ?? [0, 0];
      const level = level_for(resolution, this.texture.coarsest_level);
      this.read_out.show({texture: this.texture, resolution, level, texel: this.#pointer ?? {x, y: -y}, ledger: this.#ledger});
      this.scale_bar.show(resolution);
      this.rail.show(Math.log2(resolution));
      this.element.dataset.loading = String(this.#ledger.loading);
      if (this.#ledger.loading === 0) this.waiting.show(false);
    });
  }

  #hash() {
    const [x, y] = this.#view.getCenter() ?? [0, 0];
    const options = this.viewing.in_address;
    if (this.player.paused_at !== null && this.texture.animated) options.step = String(this.player.paused_at);
    if (this.#grid.shown) options.grid = '1';
    return format_address({
      scene: this.texture.id,
      view: {level: Math.log2(this.#view.getResolution() ?? 1), x, y: -y},
      options,
    });
  }

  /** @param {boolean} smooth */
  #set_smooth(smooth) {
    this.#pages.smooth = smooth;
    this.#pages.changed();
  }

  /** @param {number} step */
  #set_step(step) {
    this.step = step;
    this.#store.set_step(step);
  }

  #toggle_editor() {
    if (this.editor.button.hidden) return this.page.say('There are no sprites here to be edited');
    this.editor.toggle();
  }

  #toggle_player() {
    if (!this.texture.animated) return this.page.say('Nothing moves in this scene');
    this.player.toggle();
  }

  /** @param {number} steps */
  #step_player(steps) {
    if (!this.texture.animated) return this.page.say('Nothing moves in this scene');
    this.player.move(steps);
  }

  /** For everybody. @param {any} change A ClockChange. */
  async #set_clock(change) {
    try {
      await this.live.edit([{change: {case: 'setClock', value: change}}]);
    } catch (error) {
      this.page.say(`The clock was not set: ${/** @type {Error} */ (error).message}`);
    }
  }

  #retry() {
    this.#store.retry();
  }

  /** @param {boolean} shown */
  #set_grid(shown) {
    this.#grid.shown = shown;
    this.grid_button.setAttribute('aria-pressed', String(shown));
    this.#grid.changed();
  }

  #toggle_grid() {
    this.#set_grid(!this.#grid.shown);
    this.page.moved(this.#hash(), false);
  }

  /** CSS pixels of the view, and what the bars cover of it: above, below, and on each side, so that what is fitted stays in the middle. */
  #room() {
    const view = this.element.getBoundingClientRect();
    const box_of = (/** @type {string} */ name) => this.element.querySelector(name).getBoundingClientRect();
    return {
      width: this.canvas.clientWidth,
      height: this.canvas.clientHeight,
      top: box_of('.top-bar').bottom - view.top,
      bottom: view.bottom - box_of('.lower').top,
      side: view.right - box_of('.level-rail').left,
    };
  }

  /** @param {{x: number, y: number, level: number | null}} place */
  #go_to({x, y, level}) {
    const {side_texels, coarsest_level} = this.texture;
    if (!this.texture.contains({x, y})) return `Texels of this scene are 0 to ${with_separators(side_texels - 1)}.`;
    if (level !== null && level > coarsest_level) return `Levels of this scene are 0 to ${coarsest_level}.`;
    this.page.moved(this.#hash(), true);
    this.#view.cancelAnimations();
    if (level !== null) this.#view.setResolution(2 ** level);
    this.#view.setCenter([x, -y]);
    this.canvas.focus();
    return null;
  }

  #copy_link() {
    copy_link(this.#hash(), this.page.say);
  }
}
