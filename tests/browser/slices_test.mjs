// The third dimension: one slice of it is shown.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, open_page, set_the_stage, wait_for_colour, wait_for_room, web_folder} from './harness.mjs';
import {slice_colour, start_page_server, tint} from './page_server.mjs';

const stage = set_the_stage();
const middle = [640, 400];

/** A page at a scene with so many slices, until the test ends. */
async function open_sliced(t, slices, query = '') {
  const server = await start_page_server({web: web_folder, slices});
  t.after(server.stop);
  const opened = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024${query}`);
  await all_pages_shown(opened.page);
  return {...opened, server};
}

const hash_holds = (page, text) => page.waitForFunction((text) => location.hash.includes(text), text);
const number_of = (page) => page.getByRole('spinbutton', {name: 'Slice'});

test('steps through the slices by key, round and round, and says so in the address', async (t) => {
  const {page, complaints, server, close} = await open_sliced(t, 4);
  await wait_for_colour(page, middle, tint(1, 2, 2));
  for (const [key, slice] of [['.', 1], ['.', 2], ['.', 3]]) {
    await page.keyboard.press(key);
    await wait_for_colour(page, middle, slice_colour(slice));
  }
  await hash_holds(page, 'slice=3');
  assert.equal(await number_of(page).inputValue(), '3');
  assert.ok(server.requests.includes('/scenes/tints/r0-abc/3/2/2.png?slice=3'));
  await page.keyboard.press('.');
  await wait_for_colour(page, middle, tint(1, 2, 2));
  await page.waitForFunction(() => !location.hash.includes('slice'));
  await page.keyboard.press(',');
  await page.getByText('Slice 3').waitFor();
  await wait_for_colour(page, middle, slice_colour(3));
  assert.deepEqual(complaints, []);
  await close();
});

test('takes a slice from the slider, the number and the buttons', async (t) => {
  const {page, complaints, close} = await open_sliced(t, 16);
  await page.getByRole('slider', {name: 'Slice'}).fill('5');
  await wait_for_colour(page, middle, slice_colour(5));
  await number_of(page).fill('23');
  await number_of(page).press('Enter');
  await wait_for_colour(page, middle, slice_colour(7));
  assert.equal(await number_of(page).inputValue(), '7');
  await page.getByRole('button', {name: 'Slice before'}).click();
  await wait_for_colour(page, middle, slice_colour(6));
  await number_of(page).fill('');
  await number_of(page).press('Enter');
  await wait_for_colour(page, middle, tint(1, 2, 2));
  assert.equal(await number_of(page).inputValue(), '0');
  assert.deepEqual(complaints, []);
  await close();
});

test('goes on without end, below 0 too, where nothing repeats', async (t) => {
  const {page, complaints, close} = await open_sliced(t, 0, '?slice=1');
  await wait_for_colour(page, middle, slice_colour(1));
  assert.equal(await page.getByRole('slider', {name: 'Slice'}).count(), 0);
  await page.keyboard.press(',');
  await page.keyboard.press(',');
  await wait_for_colour(page, middle, slice_colour(-1));
  await hash_holds(page, 'slice=-1');
  assert.deepEqual(complaints, []);
  await close();
});

test('opens the slice that the address names, and no other', async (t) => {
  const {page, server, close} = await open_sliced(t, 4, '?slice=6');
  await wait_for_colour(page, middle, slice_colour(2));
  await page.evaluate(() => (location.hash = '#tints/1/1024/1024?slice=3'));
  await wait_for_colour(page, middle, slice_colour(3));
  assert.ok(!server.requests.some((url) => url.includes('slice=6')));
  await close();
});

test('offers no slices where a scene is flat', async () => {
  const {page, complaints, close} = await open_page(stage.browser, `${stage.server.origin}/#board/1/1024/1024?slice=3`);
  await all_pages_shown(page);
  assert.equal(await page.locator('.slices').isVisible(), false);
  await page.keyboard.press('.');
  await page.getByText('it has one slice').waitFor();
  assert.ok(!new URL(page.url()).hash.includes('slice='));
  assert.deepEqual(complaints, []);
  await close();
});

test('keeps its bars apart at every width', async (t) => {
  const {page, close} = await open_sliced(t, 16);
  for (const width of [1600, 1181, 1180, 901, 900, 640, 360]) {
    await page.setViewportSize({width, height: 800});
    await wait_for_room(page, ['.place', '.tools', '.slices', '.level-rail'], width);
  }
  await close();
});
