import {format_address} from './address.js';
import {element, icon, mark} from './dom.js';
import {message_page} from './messages.js';
import {format_bytes, with_separators} from './numbers.js';
import {connection, fetch_scenes, Unreachable} from './server.js';
import {kind_name, opening_view, page_side, uncompressed_bytes} from './texture.js';

/** The list of scenes: a card each, with live texels; those that could not be loaded say why. */
export class SceneList {
  #closed = new AbortController();
  #content = element('div', {class: 'list-content', 'aria-busy': 'true'});
  element = element(
    'div',
    {class: 'scene-list'},
    element(
      'header',
      {class: 'masthead'},
      mark(),
      element('div', {}, element('h1', {text: 'Tessera'}), element('p', {text: 'Endless textures, made page by page as you look.'})),
    ),
    this.#content,
  );

  constructor() {
    document.title = 'Tessera';
    connection.addEventListener('up', () => this.#load(), {signal: this.#closed.signal});
    this.#load();
  }

  close() {
    this.#closed.abort();
  }

  async #load() {
    try {
      const {scenes, broken} = await fetch_scenes();
      this.#show(scenes, broken);
    } catch (error) {
      this.#content.replaceChildren(
        error instanceof Unreachable
          ? message_page({
              title: 'The server is not answering',
              detail: 'The scenes appear here as soon as it is back.',
              icon: 'unplugged',
            })
          : message_page({
              title: 'The list of scenes did not come',
              detail: /** @type {Error} */ (error).message,
              action: {text: 'Try again', act: () => this.#load()},
            }),
      );
    }
    this.#content.removeAttribute('aria-busy');
  }

  /** @param {any[]} scenes @param {any[]} broken */
  #show(scenes, broken) {
    if (scenes.length + broken.length === 0) {
      this.#content.replaceChildren(
        message_page({
          title: 'No scenes yet',
          detail: 'Start the server with --scenes FOLDER, where each folder in it holds a scene.json, or give ./run.sh a photograph.',
        }),
      );
      return;
    }
    this.#content.replaceChildren(
      element('main', {}, element('ul', {class: 'cards'}, ...inviting_first(scenes).map(scene_card))),
      ...(broken.length > 0 ? [broken_scenes(broken)] : []),
    );
  }
}

/** Scenes that are there to judge filters by come last. @param {any[]} scenes */
function inviting_first(scenes) {
  const rank = (/** @type {any} */ {texture}) => ['checker', 'constant'].indexOf(texture);
  return [...scenes].sort((a, b) => rank(a) - rank(b));
}

/** @param {any} scene A SceneSummary of proto/page.proto; zeros are left out of its JSON. */
function scene_card({id, title, attribution, texture, extent_log2_pages: n = 0, view}) {
  const side = with_separators(page_side * 2 ** n);
  return element(
    'li',
    {class: 'card'},
    element(
      'a',
      {href: format_address({scene: id, view: null, options: {}})},
      element('div', {class: 'thumbnail'}, thumbnail(id, n, opening_view(view))),
      element(
        'div',
        {class: 'card-text'},
        element('h2', {text: title || id}),
        element('p', {class: 'card-kind'}, kind_name(texture ?? ''), element('span', {class: 'card-open'}, icon('arrow'))),
        element(
          'dl',
          {},
          element('div', {}, element('dt', {text: 'Extent'}), element('dd', {text: `${side} × ${side} texels`})),
          element('div', {}, element('dt', {text: 'Levels'}), element('dd', {text: `0 to ${n}`})),
          element('div', {}, element('dt', {text: 'Uncompressed'}), element('dd', {text: format_bytes(uncompressed_bytes(n))})),
        ),
      ),
    ),
    attribution && element('p', {class: 'card-attribution', text: attribution}),
  );
}

/**
 * Live texels of the opening view; of the middle of the texture where the scene names none, near level 0, where there is
 * something to see.
 * @param {string} id @param {number} n @param {import('./address.js').View | null} view
 */
function thumbnail(id, n, view) {
  const level = Math.min(Math.max(0, Math.round(view?.level ?? 1)), n);
  const z = n - level;
  const pages = Math.min(3, 2 ** z);
  const canvas = element('canvas', {width: pages * page_side, height: Math.min(2, pages) * page_side, 'aria-hidden': 'true'});
  const context = canvas.getContext('2d');
  const first = (/** @type {number | undefined} */ texel, /** @type {number} */ across) => {
    const middle = texel === undefined ? 2 ** (z - 1) : texel / (page_side * 2 ** level);
    return Math.min(Math.max(0, Math.round(middle - across / 2)), 2 ** z - across);
  };
  const first_x = first(view?.x, pages);
  const first_y = first(view?.y, Math.min(2, pages));
  for (let y = 0; y < Math.min(2, pages); ++y) {
    for (let x = 0; x < pages; ++x) {
      const image = new Image();
      image.onload = () => {
        context.drawImage(image, x * page_side, y * page_side);
        canvas.classList.add('drawn');
      };
      image.src = `/scenes/${encodeURIComponent(id)}/${z}/${first_x + x}/${first_y + y}.png`;
    }
  }
  return canvas;
}

/** @param {any[]} broken */
function broken_scenes(broken) {
  return element(
    'section',
    {class: 'broken', 'aria-labelledby': 'broken-title'},
    element('h2', {id: 'broken-title', text: broken.length === 1 ? 'One scene could not be loaded' : `${broken.length} scenes could not be loaded`}),
    element(
      'ul',
      {},
      ...broken.map(({id, problem}) => element('li', {}, icon('warning'), element('div', {}, element('h3', {text: id}), element('p', {text: problem})))),
    ),
  );
}
