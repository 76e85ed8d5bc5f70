// More than colour: the channel sets of a scene, one of which is shown.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, open_page, set_the_stage, wait_for_colour, wait_for_room, web_folder} from './harness.mjs';
import {set_colours, start_page_server, tint} from './page_server.mjs';

const stage = set_the_stage();
const middle = [640, 400];

/** A server of a scene with these channel sets, until the test ends. */
async function start(t, channels) {
  const server = await start_page_server({web: web_folder, channels});
  t.after(server.stop);
  return server;
}

const hash_holds = (page, text) => page.waitForFunction((text) => location.hash.includes(text), text);
const selector = (page) => page.getByRole('group', {name: 'Channels'});

test('shows the channel set that is chosen, and says so in the address', async (t) => {
  const server = await start(t, ['albedo', 'normal', 'roughness', 'height', 'moments']);
  const {page, complaints, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024`);
  await all_pages_shown(page);
  await wait_for_colour(page, middle, tint(1, 2, 2));
  assert.equal(await selector(page).getByRole('radio').count(), 5);
  assert.ok(await selector(page).getByRole('radio', {name: 'Albedo'}).isChecked());

  await selector(page).getByRole('radio', {name: 'Normal'}).check();
  await wait_for_colour(page, middle, set_colours.normal);
  await hash_holds(page, 'channels=normal');
  assert.ok(server.requests.includes('/scenes/tints/r0-abc/3/2/2.png?channels=normal'));

  await page.getByRole('button', {name: 'View options'}).click();
  await page.getByRole('radio', {name: 'Exact'}).check();
  await page.waitForFunction(() => location.hash.includes('accuracy=exact'));
  await all_pages_shown(page);
  assert.ok(server.requests.includes('/scenes/tints/r0-abc/3/2/2.png?accuracy=exact&channels=normal'));
  assert.deepEqual(complaints, []);
  await close();
});

test('goes through the sets by key, in both directions', async (t) => {
  const server = await start(t, ['albedo', 'normal', 'height']);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024`);
  await all_pages_shown(page);
  const said = page.getByText('Channels: height').waitFor();  // for a moment
  for (const [key, colour] of [
    ['m', set_colours.normal], ['m', set_colours.height], ['m', tint(1, 2, 2)], ['Shift+M', set_colours.height],
  ]) {
    await page.keyboard.press(key);
    await wait_for_colour(page, middle, colour);
  }
  await said;
  assert.ok(await selector(page).getByRole('radio', {name: 'Height'}).isChecked());
  await close();
});

test('opens the set that the address names, or the colour if the scene has no such set', async (t) => {
  const server = await start(t, ['albedo', 'roughness']);
  for (const [asked, colour] of [['roughness', set_colours.roughness], ['normal', tint(1, 2, 2)], ['%00', tint(1, 2, 2)]]) {
    const {page, complaints, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024?channels=${asked}`);
    await all_pages_shown(page);
    await wait_for_colour(page, middle, colour);
    assert.deepEqual(complaints, []);
    await close();
  }
  assert.ok(!server.requests.some((url) => url.includes('channels=normal')));
});

test('offers no choice where there is none', async () => {
  const {page, complaints, close} = await open_page(stage.browser, `${stage.server.origin}/#board/1/1024/1024`);
  await all_pages_shown(page);
  assert.equal(await page.locator('.channels').isVisible(), false);
  await page.keyboard.press('m');
  await page.getByText('its colour alone').waitFor();
  assert.ok(!new URL(page.url()).hash.includes('channels'));
  assert.deepEqual(complaints, []);
  await close();
});

test('keeps its bars apart at every width', async (t) => {
  const server = await start(t, ['albedo', 'normal', 'roughness', 'height', 'moments']);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024`);
  await all_pages_shown(page);
  for (const width of [1600, 1280, 1181, 1180, 1000, 901, 900, 640, 420, 360]) {
    await page.setViewportSize({width, height: 800});
    await wait_for_room(page, ['.place', '.tools', '.channels', '.level-rail'], width);
  }
  await close();
});
