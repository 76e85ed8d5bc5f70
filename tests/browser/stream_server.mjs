// A scene that is edited, by hand of a test: pages change when the test says so, and the stream tells it, or breaks.
import {once} from 'node:events';

import {as_server, WebSocketServer} from './messages.mjs';
import {start_page_server} from './page_server.mjs';
import {flat_page} from './png.mjs';

/** The colour of a page at one of its revisions. */
export const colour_at = (level, x, y, revision) => [40 + ((x * 53 + revision * 37) % 160), 40 + ((y * 97 + revision * 59) % 160), 40 + ((level * 31 + revision * 83) % 160)];

/** The pages of all levels up to n that meet boxes of texels. */
export function box_pages(boxes, n) {
  const pages = new Map();
  for (const {x0, y0, x1, y1} of boxes) {
    for (let level = 0; level <= n; ++level) {
      const size = 256 * 2 ** level;
      for (let y = Math.floor(y0 / size); y * size < y1; ++y) {
        for (let x = Math.floor(x0 / size); x * size < x1; ++x) pages.set(`${level}/${x}/${y}`, {level, x, y});
      }
    }
  }
  return [...pages.values()];
}

/**
 * @param {{web: string, n?: number, port?: number, page_delay?: number, revision?: number, hello?: object, clock?: object, info?: object,
 *   answer_other?: (response: any, url: URL) => boolean, page_of?: (level: number, x: number, y: number, url: URL) => Buffer, edit?: (edit: any, tools: {done: (value: object) => void, refuse: (value: object) => void}) => void}} options
 */
export async function start_stream_server({web, n = 4, port = 0, page_delay = 0, revision = 0, hello = {}, clock = {}, info = {}, edit = undefined, page_of = undefined, answer_other = () => false}) {
  const own = new Map();
  const scene = {revision, page_delay, hello, refuse_streams: false, swallow: 0};
  const edit_ids = [];
  /** @type {Set<any>} */
  const clients = new Set();
  let sessions = 0;
  /** Pages that are being answered, by their address; and the most that were at once for one page. */
  const under_way = new Map();
  const most = new Map();

  const answer_page = async ({z, x, y}, response, url) => {
    const level = n - z;
    const key = `${level}/${x}/${y}`;
    const picture = page_of?.(level, x, y, url, response);  // as it is now, however late it comes
    const pinned = url.pathname.match(/\/r(\d+)-/)?.[1];
    under_way.set(key, (under_way.get(key) ?? 0) + 1);
    most.set(key, Math.max(most.get(key) ?? 0, under_way.get(key)));
    const now = own.get(key) ?? 0;
    if (scene.page_delay > 0) await new Promise((resolve) => setTimeout(resolve, scene.page_delay));
    under_way.set(key, under_way.get(key) - 1);
    response.setHeader('cache-control', 'no-store');
    if (pinned !== undefined && Number(pinned) < now) return response.writeHead(410).end(`the page has changed at revision ${now}`) && true;
    response.setHeader('content-type', 'image/png').setHeader('tessera-revision', String(now));
    response.end(picture ?? flat_page(colour_at(level, x, y, now)));
    return true;
  };
  const server = await start_page_server({web, n, port, clock, answer_page, answer_other, info: () => ({stream: '/scenes/tints/stream', revision: String(scene.revision), fingerprint: 'abc', ...info})});
  const sockets = new WebSocketServer({server: server.http, path: '/scenes/tints/stream', verifyClient: () => !scene.refuse_streams, handleProtocols: (protocols) => [...protocols][0]});

  const tell = (client, kind, value) => client.socket.readyState === 1 && client.socket.send(as_server.write(kind, value));
  const watches = ({windows}, {level, x, y}) => windows.some((window) => window.level === level && window.x0 <= x && x < window.x1 && window.y0 <= y && y < window.y1);
  const stale_since = (client, seen) =>
    [...own].map(([key, changed]) => ({key: key.split('/').map(Number), changed}))
      .filter(({key: [level, x, y], changed}) => changed > seen && watches(client, {level, x, y}))
      .map(({key: [level, x, y], changed}) => ({level, x: [BigInt(x)], y: [BigInt(y)], revision: [BigInt(changed)]}));

  sockets.on('connection', (socket) => {
    const client = {socket, session: ++sessions, name: '', windows: [], heard: []};
    clients.add(client);
    socket.on('close', () => {
      clients.delete(client);
      for (const other of clients) tell(other, 'present', {people: [], left: [BigInt(client.session)]});
    });
    socket.on('message', (data) => {
      const {kind, value} = as_server.read(new Uint8Array(data));
      client.heard.push({kind, value});
      if (kind === 'hello') {
        client.name = value.name;
        tell(client, 'hello', {
          scene: 'tints', title: 'Tints', revision: BigInt(scene.revision), lineage: 'line', fingerprint: 'abc', extentLog2Pages: n, session: BigInt(client.session),
          resumed: value.lineage === 'line', mayEdit: true, takesEdits: true, limits: {windows: 64, windowPages: 16384, messageBytes: 262144}, ...scene.hello,
        });
      }
      if (kind === 'windows') {
        client.windows = value.windows.map(({level, x0, y0, x1, y1}) => ({level, x0: Number(x0), y0: Number(y0), x1: Number(x1), y1: Number(y1)}));
        tell(client, 'invalidation', {revision: BigInt(scene.revision), stale: stale_since(client, Number(value.seenRevision))});
      }
      if (kind === 'ping') tell(client, 'pong', {payload: value.payload});
      if (kind === 'edit') {
        edit_ids.push(value.id);
        if (scene.swallow-- > 0) return;
        edit?.(value, {
          done: (done) => tell(client, 'editDone', {id: value.id, session: BigInt(client.session), author: value.author, ...done}),
          refuse: (refusal) => tell(client, 'editRefused', {id: value.id, ...refusal}),
        });
      }
    });
  });

  /** These pages, at the next revision. @param {{level: number, x: number, y: number}[]} pages */
  const touch = (pages, tell_more = () => {}) => {
    const at = ++scene.revision;
    for (const {level, x, y} of pages) own.set(`${level}/${x}/${y}`, at);
    for (const client of clients) {
      const stale = pages.filter((page) => watches(client, page)).map(({level, x, y}) => ({level, x: [BigInt(x)], y: [BigInt(y)], revision: [BigInt(at)]}));
      tell(client, 'invalidation', {revision: BigInt(at), stale});
    }
    tell_more(at);
  };

  return {
    ...server, touch, edit_ids, scene, clients, most, own,
    /** The pages of all levels that hold a page of level 0, at the next revision. */
    change(x, y, {quiet = false, done = {}} = {}) {
      const at = ++scene.revision;
      const changed = [];
      for (let level = 0; level <= n; ++level) {
        own.set(`${level}/${x >> level}/${y >> level}`, at);
        changed.push({level, x: x >> level, y: y >> level});
      }
      if (quiet) return at;
      for (const client of clients) {
        const stale = changed.filter((page) => watches(client, page)).map(({level, x, y}) => ({level, x: [BigInt(x)], y: [BigInt(y)], revision: [BigInt(at)]}));
        tell(client, 'invalidation', {revision: BigInt(at), stale});
        tell(client, 'editDone', {id: `e${at}`, session: 99n, author: 'Anna', answer: {revision: BigInt(at)}, changes: [{change: {case: 'moveSprite', value: {id: 1n, x: 1}}}], ...done});
      }
      return at;
    },
    tell_all: (kind, value) => [...clients].forEach((client) => tell(client, kind, value)),
    break_streams: () => [...clients].forEach(({socket}) => socket.terminate()),
    async stop() {
      for (const {socket} of clients) socket.terminate();
      sockets.close();
      await server.stop();
    },
    connected: async () => {
      for (let i = 0; i < 100 && ![...clients].some(({windows}) => windows.length > 0); ++i) await new Promise((resolve) => setTimeout(resolve, 50));
    },
  };
}
