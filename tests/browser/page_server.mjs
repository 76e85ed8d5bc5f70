// A server of pages that does what a test tells it to: busy, slow, silent. For the answers that the real server gives
// only in a bad hour.
import {once} from 'node:events';
import {readFile} from 'node:fs/promises';
import {createServer} from 'node:http';
import path from 'node:path';

import {flat_page} from './png.mjs';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml'};

/**
 * @param {{web: string, n?: number, port?: number, channels?: string[], slices?: number, clock?: object, info?: () => object, answer_other?: (response: any, url: URL, request: any) => boolean, answer_page?: (page: {z: number, x: number, y: number}, response: import('node:http').ServerResponse, url: URL) => boolean | Promise<boolean>}} options
 *   `clock`: what TileJSON says of a scene that moves. `info`: more of it, each time. `answer_page` and
 *   `answer_other` return true when they have answered.
 */
export async function start_page_server({web, n = 4, port = 0, channels = undefined, slices = undefined, clock = {}, info = () => ({}), answer_page = () => false, answer_other = () => false}) {
  const requests = [];
  const server = createServer(async (request, response) => {
    const url = new URL(request.url ?? '/', 'http://127.0.0.1');
    requests.push(url.pathname + url.search);
    const json = (value) => response.setHeader('content-type', 'application/json').end(JSON.stringify(value));
    const page = url.pathname.match(/^\/scenes\/tints\/(?:r\d+-[0-9a-f]+\/|without-[\d,]+\/)?(\d+)\/(\d+)\/(\d+)\.png$/);
    if (url.pathname === '/healthz') return response.end('ok');
    if (url.pathname === '/scenes') return json({scenes: [{id: 'tints', title: 'Tints', texture: 'constant', extent_log2_pages: n}]});
    if (url.pathname === '/scenes/tints') {
      return json({tilejson: '3.0.0', name: 'Tints', maxzoom: n, tessera: {
        id: 'tints', extent_log2_pages: n, formats: ['png'], texture: 'constant', page_url: '/scenes/tints/r0-abc/{z}/{x}/{y}',
        channels, slices, ...clock, ...info(),
      }});
    }
    if (page) {
      const [z, x, y] = page.slice(1).map(Number);
      if (await answer_page({z, x, y}, response, url)) return;
      response.setHeader('content-type', 'image/png').setHeader('cache-control', 'no-store');
      response.setHeader('tessera-method', 'constant').setHeader('tessera-bound', '0');
      const set = url.searchParams.get('channels');
      const slice = url.searchParams.get('slice');
      return response.end(flat_page(set ? set_colours[set] : slice ? slice_colour(Number(slice)) : tint(n - z, x, y)));
    }
    if (answer_other(response, url, request)) return;
    const file = path.join(web, url.pathname === '/' ? 'index.html' : path.basename(url.pathname));
    const bytes = await readFile(file).catch(() => null);
    if (!bytes) return response.writeHead(404).end('no such page');
    response.setHeader('content-type', types[path.extname(file)] ?? 'text/plain').end(bytes);
  });
  server.listen(port, '127.0.0.1');
  await once(server, 'listening');
  const stop = async () => {
    server.closeAllConnections();
    server.close();
    await once(server, 'close');
  };
  return {origin: `http://127.0.0.1:${server.address().port}`, port: server.address().port, http: server, requests, stop};
}

/** The colour of every page of a channel set that is no colour. @type {Record<string, number[]>} */
export const set_colours = {normal: [128, 128, 255], roughness: [210, 210, 210], height: [90, 90, 90]};

/** The colour of every page of a slice but the first. @param {number} slice */
export const slice_colour = (slice) => [220, 40 + ((slice & 7) * 20), slice < 0 ? 200 : 60];

/** The colour of a page of albedo: another one for each. */
export const tint = (level, x, y) => [40 + ((x * 53) % 160), 40 + ((y * 97) % 160), 40 + ((level * 31) % 160)];
