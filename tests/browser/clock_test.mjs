// A scene's clock is everybody's: whoever looks sees it paused, set and sped up by others; what one does to it oneself is
// one's own unless one says otherwise. What comes next is here before it is shown.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {open_page, set_the_stage, wait_for_colour, web_folder} from './harness.mjs';
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
  server.tell_all('clock', clock_of(3000, {stepsPerSecond: 40}));
  await page.waitForFunction(() => Number(document.querySelector('.player-step').textContent.replace(/\D/g, '')) > 3030, null, {timeout: 8000});
  assert.ok((await shown_step(page)) < 3600);
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
  assert.equal(await shown_step(page), at + 1);
  assert.deepEqual(edits, []);

  await page.getByRole('button', {name: /^Step/, exact: false}).first().click();
  await page.getByRole('button', {name: 'Back to the clock'}).click();
  await page.waitForSelector('.player[data-state="plays"]');
  await page.getByRole('switch', {name: /For everybody/}).check();
  await page.getByRole('button', {name: 'Pause (P)'}).click();
  for (let i = 0; i < 100 && edits.length === 0; ++i) await page.waitForTimeout(20);
  assert.equal(edits[0].case, 'setClock');
  assert.equal(edits[0].value.playing, false);
  server.tell_all('clock', clock_of(500, {playing: false}));
  await page.getByText('Step 500').waitFor();
  await page.getByLabel('Steps a second').fill('24');
  await page.keyboard.press('Enter');
  for (let i = 0; i < 100 && edits.length === 1; ++i) await page.waitForTimeout(20);
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
  await page.waitForFunction(() => new Set(window.frames_seen.map(String)).size >= 4, null, {timeout: 30000});
  const frames = await page.evaluate(() => window.frames_seen);
  const complete = frames.slice(frames.findIndex((places) => places.every((place) => place === places[0])));
  const mixed = complete.filter((places) => places.some((place) => place !== places[0]));
  assert.equal(mixed.length, 0, `${mixed.length} of ${complete.length} frames showed pages of two steps: ${mixed[0]}`);
  for (const [key, at_once] of server.most) assert.ok(at_once <= 1, `${key} was asked for ${at_once} times at once`);
});
