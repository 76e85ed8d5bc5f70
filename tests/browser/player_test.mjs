// A scene that moves plays by the wall clock; pages are asked for again only when their interval has ended.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, open_page, set_the_stage, wait_for_colour, web_folder} from './harness.mjs';
import {flat_page} from './png.mjs';
import {start_page_server} from './page_server.mjs';

const stage = set_the_stage();
const middle = [640, 400];
const clock = {animated: true, steps_per_second: 10, loop_steps: '40'};
const colours = [[200, 40, 40], [40, 200, 40], [40, 40, 200], [200, 200, 40]];
const step_of = (request) => Number(new URL(request, 'http://127.0.0.1').searchParams.get('step') ?? 0);

/** Pages change every ten steps, of which the scene has forty; the topmost row rests for ever. */
function answer_page({y}, response, url) {
  const step = Number(url.searchParams.get('step') ?? 0), tens = Math.floor(step / 10);
  response.setHeader('content-type', 'image/png').setHeader('cache-control', 'no-store');
  response.setHeader('tessera-valid-from', y === 0 ? 'always' : String(tens * 10));
  response.setHeader('tessera-valid-until', y === 0 ? 'never' : String(tens * 10 + 10));
  response.end(flat_page(y === 0 ? [90, 90, 90] : colours[((tens % 4) + 4) % 4]));
  return true;
}

async function open_moving(t, query = '', moving = clock) {
  const server = await start_page_server({web: web_folder, clock: moving, answer_page});
  t.after(server.stop);
  const opened = await open_page(stage.browser, `${server.origin}/#tints/0/1024/512${query}`);
  return {...opened, server};
}

test('plays by the clock, and asks for no page at each step of its interval', async (t) => {
  const {page, complaints, server, close} = await open_moving(t);
  const asked_for = () => server.requests.filter((request) => /\.png/.test(request));
  const intervals = () => new Set(asked_for().map((request) => Math.floor(step_of(request) / 10)));
  for (let waited = 0; intervals().size < 3 && waited < 60; ++waited) await page.waitForTimeout(500);
  assert.ok(intervals().size >= 3, 'three intervals were shown');
  await wait_for_colour(page, middle, (shown) => colours.some((colour) => String(colour) === String(shown)));
  const asked = asked_for();
  const pages = new Map();
  for (const request of asked) {
    const path = request.replace(/\?.*/, '');
    if (!pages.has(path)) pages.set(path, []);
    pages.get(path).push(step_of(request));
  }
  for (const [path, steps] of pages) {
    assert.ok(steps.every((step) => step >= 0 && step < 40), `${path}: ${steps}`);
    // One that was on its way when the step changed may be asked for once more
    const rests = /\/4\/\d+\/0\.png/.test(path);
    const lasting = rests ? 1 : new Set(steps.map((step) => Math.floor(step / 10))).size;
    assert.ok(steps.length <= 2 * lasting, `${path} was asked for at ${steps}`);
  }
  assert.deepEqual(complaints, []);
  await close();
});

test('pauses at a step that the address says, and goes on', async (t) => {
  const {page, complaints, close} = await open_moving(t, '?step=25');
  await all_pages_shown(page);
  await wait_for_colour(page, middle, colours[2]);
  await page.getByText('Step 25').waitFor();
  await page.waitForTimeout(1500);
  await wait_for_colour(page, middle, colours[2]);
  await page.getByRole('button', {name: 'Play (P)'}).click();
  await page.waitForFunction(() => document.querySelector('.player-step').textContent !== 'Step 25');
  await page.keyboard.press('p');
  await page.waitForFunction(() => /step=\d+/.test(location.hash));
  assert.deepEqual(complaints, []);
  await close();
});

test('has no player where nothing moves', async (t) => {
  const {page, server, close} = await open_moving(t, '', {animated: false});
  await all_pages_shown(page);
  assert.equal(await page.getByRole('button', {name: 'Pause (P)'}).isVisible(), false);
  await page.keyboard.press('p');
  await page.getByText('Nothing moves in this scene').waitFor();
  assert.ok(server.requests.every((request) => !request.includes('step=')));
  await close();
});
