// A scene's clock is everybody's: whoever looks sees it paused, set and sped up by others; what one does to it oneself is
// one's own unless one says otherwise. What comes next is here before it is shown.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {open_page, set_the_stage, until, wait_for_colour, web_folder} from './harness.mjs';
import {flat_page} from './png.mjs';
import {start_stream_server} from './stream_server.mjs';

const stage = set_the_stage({with_server: false});
const middle = [640, 400];
const colours = [[200, 40, 40], [40, 200, 40], [40, 40, 200], [200, 200, 40]];
const moving = {animated: true, steps_per_second: 10, loop_steps: '0'};
const clock_of = (step, more = {}) => ({stepsPerSecond: 10, loopSteps: 0n, playing: true, step: BigInt(step), ...more});

/** Pages change every ten steps. */
function page_of(level, x, y, url, response) {
  const tens = Math.floor(Number(url.searchParams.get('step') ?? 0) / 10);
  response.setHeader('tessera-valid-from', String(tens * 10)).setHeader('tessera-valid-until', String(tens * 10 + 10));
  return flat_page(colours[((tens % 4) + 4) % 4]);
}

async function open_moving(t, {clock, ...options}) {
  const edits = [];
  const server = await start_stream_server({
    web: web_folder, clock: moving, page_of, hello: {animated: true, clock},
    edit: (edit, {done}) => {
      edits.push(edit.changes[0].change);
      done({answer: {revision: 1n}});
    },
    ...options,
  });
  t.after(server.stop);
  const opened = await open_page(stage.browser, `${server.origin}/#tints/0/1152/640`);
  t.after(opened.close);
  await server.connected();
  return {...opened, server, edits};
}

const shown_step = async (page) => Number((await page.textContent('.player-step')).replace(/\D/g, ''));

test('follows the clock as others pause it, set it and change its speed', async (t) => {
  const {page, server, complaints} = await open_moving(t, {clock: clock_of(1000, {playing: false})});
  await page.getByText('Step 1,000').waitFor();
  await wait_for_colour(page, middle, colours[0]);
  assert.equal(await page.getAttribute('.player', 'data-state'), 'stopped');
  server.tell_all('clock', clock_of(2025, {playing: false}));
  await page.getByText('Step 2,025').waitFor();
  await wait_for_colour(page, middle, colours[2]);
  const told = Date.now();
  server.tell_all('clock', clock_of(3000, {stepsPerSecond: 40}));
  await page.waitForFunction(() => Number(document.querySelector('.player-step').textContent.replace(/\D/g, '')) > 3030);
  const [step, seconds] = [await shown_step(page), (Date.now() - told) / 1000];
  assert.ok(step <= 3000 + 40 * (seconds + 0.5), `step ${step} after ${seconds} s`);
  assert.deepEqual(complaints, []);
});

test('a pause is one’s own, until one chooses that it is for everybody', async (t) => {
  const {page, server, edits} = await open_moving(t, {clock: clock_of(100)});
  await page.waitForSelector('.live-sign[data-state="open"]');
  await page.getByRole('button', {name: 'Pause (P)'}).click();
  await page.waitForSelector('.player[data-state="here"]');
  const at = await shown_step(page);
  await page.waitForTimeout(400);
  assert.equal(await shown_step(page), at);
  await page.keyboard.press(']');
  await until(async () => (await shown_step(page)) === at + 1, 'one step on');
  assert.deepEqual(edits, []);

  await page.getByRole('button', {name: /^Step/, exact: false}).first().click();
  await page.getByRole('button', {name: 'Back to the clock'}).click();
  await page.waitForSelector('.player[data-state="plays"]');
  await page.getByRole('switch', {name: /For everybody/}).check();
  await page.getByRole('button', {name: 'Pause (P)'}).click();
  await until(() => edits.length === 1, 'an edit that pauses the clock');
  assert.equal(edits[0].case, 'setClock');
  assert.equal(edits[0].value.playing, false);
  server.tell_all('clock', clock_of(500, {playing: false}));
  await page.getByText('Step 500').waitFor();
  await page.getByLabel('Steps a second').fill('24');
  await page.keyboard.press('Enter');
  await until(() => edits.length === 2, 'an edit that sets the speed');
  assert.equal(edits[1].value.stepsPerSecond, 24);
});

test('what comes next is asked for before it is shown, and a frame never mixes two', async (t) => {
  const {page, server} = await open_moving(t, {clock: clock_of(5), page_delay: 150});
  await wait_for_colour(page, middle, (colour) => colours.some((one) => String(one) === String(colour)));
  await page.evaluate(() => {
    const frames = (window.frames_seen = []);
    const look = () => {
      const context = document.querySelector('canvas.pages').getContext('2d');
      frames.push([[200, 250], [640, 400], [1100, 600]].map(([x, y]) => [...context.getImageData(x, y, 1, 1).data].join(' ')));
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  // A second for an interval, on however slow a machine
  await page.waitForFunction(() => new Set(window.frames_seen.map(String)).size >= 4);
  const frames = await page.evaluate(() => window.frames_seen);
  const complete = frames.slice(frames.findIndex((places) => places.every((place) => place === places[0])));
  const mixed = complete.filter((places) => places.some((place) => place !== places[0]));
  assert.equal(mixed.length, 0, `${mixed.length} of ${complete.length} frames showed pages of two steps: ${mixed[0]}`);
  for (const [key, at_once] of server.most) assert.ok(at_once <= 1, `${key} was asked for ${at_once} times at once`);
});

test('menus lie in the window and over everything else, one at a time', async (t) => {
  const {page} = await open_moving(t, {clock: clock_of(100, {playing: false})});
  await page.waitForSelector('.live-sign[data-state="open"]');
  const open_menus = () => page.evaluate(() => [...document.querySelectorAll('.menu:not([hidden])')].map(({id}) => id));
  const hidden_corners = (id) => page.evaluate((id) => {
    const menu = document.getElementById(id), {left, top, right, bottom} = menu.getBoundingClientRect();
    const corners = [[left + 16, top + 16], [right - 16, top + 16], [left + 16, bottom - 16], [right - 16, bottom - 16]];
    return corners.filter(([x, y]) => !menu.contains(document.elementFromPoint(x, y)));
  }, id);
  // A menu follows the window a frame later
  const settled = async (id) => {
    let hidden = await hidden_corners(id);
    for (let tries = 0; tries < 300 && hidden.length; ++tries) {
      await page.waitForTimeout(20);
      hidden = await hidden_corners(id);
    }
    return hidden;
  };
  for (const [width, height] of [[1280, 800], [1100, 700], [390, 844]]) {
    await page.setViewportSize({width, height});
    await page.waitForFunction((width) => innerWidth === width, width);
    for (const id of ['player-menu', 'people', 'options']) {
      await page.click(`[aria-controls="${id}"]`);
      assert.deepEqual(await open_menus(), [id], `${width} pixels`);
      assert.deepEqual(await settled(id), [], `${id} in ${width} pixels`);
      if (width < 640) await page.keyboard.press('Escape');  // it covers the other buttons
    }
    await page.keyboard.press('Escape');
    assert.deepEqual(await open_menus(), [], `${width} pixels`);
  }
  await page.setViewportSize({width: 1280, height: 800});
  await page.waitForFunction(() => innerWidth === 1280);
  await page.click('[aria-controls="player-menu"]');
  await page.setViewportSize({width: 700, height: 800});
  await page.waitForFunction(() => innerWidth === 700);
  assert.deepEqual(await settled('player-menu'), [], 'a menu that is open while the window becomes narrow');
});
