import {parse_address} from './address.js';
import {element} from './dom.js';
import {help_dialog} from './help_dialog.js';
import {ConnectionBanner, message_page, Toast} from './messages.js';
import {SceneList} from './scene_list.js';
import {connection, fetch_tilejson, Refused, Unreachable} from './server.js';
import {Texture} from './texture.js';
import {Viewer} from './viewer.js';

import '../styles/app.css';

const toast = new Toast();
const help = help_dialog();
const stage = element('div', {id: 'stage'});
document.body.append(stage, new ConnectionBanner().element, toast.element, help);

/** What is on the stage now. @type {{close(): void} | null} */
let shown = null;
/** The scene that is shown or being opened. @type {string | null} */
let scene_wanted = null;

/** @param {Element} content @param {{close(): void} | null} owner */
function put_on_stage(content, owner) {
  shown?.close();
  shown = owner;
  stage.replaceChildren(content);
}

function follow_address() {
  const address = parse_address(location.hash);
  const same_scene = address.scene !== null && address.scene === scene_wanted;
  scene_wanted = address.scene;
  if (address.scene === null) {
    const list = new SceneList();
    put_on_stage(list.element, list);
  } else if (same_scene && shown instanceof Viewer) {
    shown.show(address);
  } else {
    open_scene(address.scene);
  }
}

/** @param {string} id */
async function open_scene(id) {
  document.title = `${id} · Tessera`;
  put_on_stage(element('div', {class: 'opening', role: 'status', 'aria-label': 'Opening the scene'}), null);
  try {
    const texture = new Texture(await fetch_tilejson(id));
    if (scene_wanted !== id) return;
    const viewer = new Viewer(texture, parse_address(location.hash), {
      say: (text) => toast.say(text),
      help: () => (help.open ? help.close() : help.showModal()),
      leave: () => (location.hash = '#'),
      stale: () => refresh(viewer, id),
      moved: record_view,
    });
    put_on_stage(viewer.element, viewer);
    viewer.opened();
  } catch (error) {
    if (scene_wanted === id) show_problem(id, error);
  }
}

let refreshing = false;

/** Asks what the scene is now: after a silence of the server, or when it knows a page's revision no longer. @param {Viewer} viewer @param {string} id */
async function refresh(viewer, id) {
  if (refreshing) return;
  refreshing = true;
  try {
    const tilejson = await fetch_tilejson(id);
    if (shown === viewer) viewer.refresh(new Texture(tilejson));
  } catch (error) {
    if (shown === viewer && error instanceof Refused && error.status === 404) show_problem(id, error);
  }
  refreshing = false;
}

/** @param {string} id @param {unknown} error */
function show_problem(id, error) {
  const to_list = {text: 'All scenes', act: () => (location.hash = '#')};
  if (error instanceof Unreachable) {
    const owner = new AbortController();
    connection.addEventListener('up', () => scene_wanted === id && open_scene(id), {once: true, signal: owner.signal});
    const content = message_page({
      title: 'The server is not answering',
      detail: 'The scene opens as soon as it is back.',
      icon: 'unplugged',
    });
    put_on_stage(content, {close: () => owner.abort()});
    return;
  }
  const unknown = error instanceof Refused && error.status === 404;
  const content = message_page({
    title: unknown ? `There is no scene called “${id}”` : `“${id}” could not be opened`,
    detail: unknown ? 'It may have been renamed, or the server was started with another folder of scenes.' : /** @type {Error} */ (error).message,
    action: to_list,
  });
  put_on_stage(content, null);
}

/** @param {string} hash @param {boolean} jump */
function record_view(hash, jump) {
  if (jump) history.pushState(null, '', hash);
  else if (hash !== location.hash) history.replaceState(null, '', hash);
}

window.addEventListener('hashchange', follow_address);
follow_address();
