// What every browser test needs: the real server on made scenes, Chromium, and the colours of a page's pixels.
// The environment names the programs: see CMakeLists.txt.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {mkdir, mkdtemp, rm, writeFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {createInterface} from 'node:readline';
import {after, before} from 'node:test';

import {flat_picture} from './png.mjs';

/** @param {string} name */
function from_environment(name) {
  const value = process.env[name];
  assert.ok(value, `${name} is not set: run these tests with ctest -L browser`);
  return value;
}

export const web_folder = from_environment('TESSERA_WEB');
const {chromium} = createRequire(path.join(from_environment('TESSERA_NODE_MODULES'), 'index.js'))('playwright-core');

export const clay = [180, 96, 61];
export const light_square = [236, 230, 214];
export const dark_square = [24, 60, 120];
export const square_texels = 32;

const color = ([red, green, blue]) => ({red, green, blue});
const scenes = {
  clay: {title: 'Fired clay', extent_log2_pages: 30, attribution: 'Made for a test', constant: {color: color(clay)}},
  board: {
    title: 'Draughts board',
    extent_log2_pages: 20,
    checker: {cell_texels: square_texels, first: color(light_square), second: color(dark_square)},
    view: {x: 1000000, y: 2000000, level: 2.5},
  },
  'four-pages': {title: 'Four pages', extent_log2_pages: 1, constant: {color: color(dark_square)}},
  torn: {title: 'Torn', colour: 'red'},
};

/** A scene of one sprite pattern over one colour, to be edited. */
const signs = {
  title: 'Signs', extent_log2_pages: 4, constant: {color: color([52, 84, 70])},
  sprites: {patterns: {files: ['amber.png']}},
};

/** A folder of four scenes, of which `torn` is broken; and, if asked for, one with sprites. */
export async function make_scenes({with_sprites = false} = {}) {
  const folder = await mkdtemp(path.join(tmpdir(), 'tessera-browser-'));
  for (const [id, scene] of Object.entries(scenes)) {
    await mkdir(path.join(folder, id));
    await writeFile(path.join(folder, id, 'scene.json'), JSON.stringify(scene));
  }
  if (with_sprites) {
    await mkdir(path.join(folder, 'signs'));
    await writeFile(path.join(folder, 'signs', 'scene.json'), JSON.stringify(signs));
    await writeFile(path.join(folder, 'signs', 'amber.png'), flat_picture(64, [222, 164, 66]));
  }
  const paint_clay = (rgb) =>
    writeFile(path.join(folder, 'clay', 'scene.json'), JSON.stringify({...scenes.clay, constant: {color: color(rgb)}}));
  return {folder, paint_clay, remove: () => rm(folder, {recursive: true, force: true})};
}

/** `tessera serve`, ready when this returns. @param {string} folder Of scenes. @param {number} [port] 0: any. @param {string[]} [more_options] */
export async function start_tessera(folder, port = 0, more_options = []) {
  const options = ['serve', '--scenes', folder, '--listen', `127.0.0.1:${port}`, '--web', web_folder, ...more_options];
  const server = spawn(from_environment('TESSERA_BINARY'), options, {stdio: ['ignore', 'pipe', 'inherit']});
  const ended = once(server, 'exit');
  const first_line = once(createInterface(server.stdout), 'line').then(([line]) => line);
  const line = await Promise.race([first_line, ended.then(([code]) => `ended with code ${code}`)]);
  const origin = line.match(/^tessera: listening on (http:\/\/127\.0\.0\.1:\d+)$/)?.[1];
  assert.ok(origin, `tessera did not start: ${line}`);
  const stop = async () => {
    server.kill('SIGTERM');
    await ended;
  };
  return {origin, port: Number(new URL(origin).port), stop, reload_scenes: () => server.kill('SIGHUP')};
}

const flags = [
  '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--force-color-profile=srgb',
];

/** What does not come in this many milliseconds does not come: a browser that starts on a machine that builds takes half a minute. */
const patience = 90_000;

/** Chromium, with a profile of its own. */
export const open_browser = () => chromium.launch({executablePath: from_environment('CHROMIUM'), args: flags});

/**
 * What the tests of a file share, there before the first and gone after the last: a browser, a folder of scenes, and a
 * server of them unless each test starts its own.
 * @returns {{browser: any, scenes: any, server: any}}
 */
export function set_the_stage({with_server = true, with_sprites = false} = {}) {
  const stage = {browser: null, scenes: null, server: null};
  before(async () => {
    stage.scenes = await make_scenes({with_sprites});
    [stage.browser, stage.server] = await Promise.all([open_browser(), with_server ? start_tessera(stage.scenes.folder) : null]);
  });
  after(async () => {
    await stage.browser?.close();
    await stage.server?.stop();
    await stage.scenes?.remove();
  });
  return stage;
}

/**
 * A page that holds whatever went wrong on it: messages of the console, and requests to other hosts.
 * @param {any} browser @param {string} address
 */
export async function open_page(browser, address, {width = 1280, height = 800} = {}) {
  const context = await browser.newContext({viewport: {width, height}, reducedMotion: 'reduce'});
  context.setDefaultTimeout(patience);
  const page = await context.newPage();
  /** @type {string[]} */
  const complaints = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on('pageerror', (error) => complaints.push(`exception: ${error.message}`));
  page.on('request', (request) => {
    const {hostname, protocol} = new URL(request.url());
    if (protocol !== 'data:' && hostname !== '127.0.0.1') complaints.push(`asked ${request.url()}`);
  });
  await page.goto(address);
  return {page, complaints, close: () => context.close()};
}

/** Waits until the viewer shows every page in view, for several frames: what a key asks for is asked for a frame later. */
export const all_pages_shown = (page) =>
  page.waitForFunction(() => new Promise((resolve) => {
    let quiet_since = Infinity, frames = 0;
    const look = (now) => {
      const quiet =
        document.querySelector('.viewer')?.dataset.loading === '0' && ['ready', 'cached'].includes(document.querySelector('.read-out')?.dataset.state);
      if (!quiet) [quiet_since, frames] = [Infinity, 0];
      else if (quiet_since === Infinity) quiet_since = now;
      else if (++frames >= 5 && now - quiet_since > 250) return resolve(true);  // pages fade in for 160 ms
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  }));

/**
 * Waits until something holds, on however slow a machine; fails with what it is called if it never does.
 * @param {() => unknown} holds May be asynchronous. @param {string} [what]
 */
export async function until(holds, what = String(holds)) {
  for (const give_up = Date.now() + patience; Date.now() < give_up; ) {
    if (await holds()) return;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  assert.fail(`never: ${what}`);
}

/** Which parts of the page cover one another, or leave the window. @param {any} page @param {string[]} names Selectors. @param {number} width */
async function overlaps(page, names, width) {
  const boxes = [];
  for (const name of names) boxes.push([name, await page.locator(name).boundingBox()]);
  const wrong = boxes.filter(([, box]) => box.x < 0 || box.x + box.width > width).map(([name]) => `${name} leaves a window of ${width}`);
  for (const [name, box] of boxes) {
    for (const [other, beside] of boxes) {
      const apart =
        name >= other || box.x + box.width <= beside.x || beside.x + beside.width <= box.x || box.y + box.height <= beside.y ||
        beside.y + beside.height <= box.y;
      if (!apart) wrong.push(`${name} covers ${other} in a window of ${width}`);
    }
  }
  return wrong;
}

/** Waits until a window that has just become so wide has its parts beside one another. @param {any} page @param {string[]} names @param {number} width */
export async function wait_for_room(page, names, width) {
  let wrong = [];
  for (const give_up = Date.now() + patience; Date.now() < give_up; ) {
    wrong = await overlaps(page, names, width);
    if (wrong.length === 0) return;
    await page.waitForTimeout(50);
  }
  assert.deepEqual(wrong, []);
}

/** A value of the read-out bar: level, x, y, page, state, facts. @param {any} page @param {string} name */
export const read = (page, name) => page.textContent(`[data-read="${name}"]`);

/** Waits for a value of the read-out bar. @param {any} page @param {string} name @param {string} value */
export const wait_for_reading = (page, name, value) =>
  page.waitForFunction(
    ([name, value]) => document.querySelector(`[data-read="${name}"]`)?.textContent === value, [name, value], {timeout: patience},
  );

/**
 * Colours of pixels as the user sees them, out of a picture of the screen.
 * @param {any} page @param {number[][]} points x and y, from the top-left corner
 * @returns {Promise<number[][]>} Red, green and blue of each.
 */
export async function colours_at(page, points) {
  const [left, top] = [0, 1].map((axis) => Math.min(...points.map((point) => point[axis])));
  const [right, bottom] = [0, 1].map((axis) => Math.max(...points.map((point) => point[axis])));
  const picture = await page.screenshot({clip: {x: left, y: top, width: right - left + 1, height: bottom - top + 1}});
  return (await darkroom_of(page.context().browser())).evaluate(
    async ([picture, points]) => {
      const bytes = Uint8Array.from(atob(picture), (letter) => letter.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], {type: 'image/png'}));
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return points.map(([x, y]) => [...context.getImageData(x, y, 1, 1).data].slice(0, 3));
    },
    [picture.toString('base64'), points.map(([x, y]) => [x - left, y - top])],
  );
}

/**
 * Waits until a pixel has a colour that passes, on however slow a machine; fails with the colour it has in the end.
 * @param {any} page @param {number[]} point @param {number[] | ((colour: number[]) => boolean)} wanted
 */
export async function wait_for_colour(page, point, wanted) {
  const passes = typeof wanted === 'function' ? wanted : (colour) => String(colour) === String(wanted);
  let colour;
  for (const give_up = Date.now() + patience; Date.now() < give_up; ) {
    [colour] = await colours_at(page, [point]);
    if (passes(colour)) return;
    await page.waitForTimeout(100);
  }
  assert.fail(`pixel ${point} has colour ${colour} in the end; wanted ${wanted}`);
}

const darkrooms = new WeakMap();

/** An empty page that develops pictures, in a window of its own: the viewer's policy forbids its scripts to read them. */
async function darkroom_of(browser) {
  if (!darkrooms.has(browser)) darkrooms.set(browser, await (await browser.newContext()).newPage());
  return darkrooms.get(browser);
}

/** The colour of the checker's square that a texel of level 0 lies in. @param {number} x @param {number} y */
export const square_at = (x, y) =>
  (Math.floor(x / square_texels) + Math.floor(y / square_texels)) % 2 === 0 ? light_square : dark_square;
