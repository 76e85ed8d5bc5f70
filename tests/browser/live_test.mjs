// The page and the real server, live: what another client edits is seen, a restart is gone on from, and what a hand does in
// the page is in the journal.
import assert from 'node:assert/strict';
import {mkdtemp, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {test} from 'node:test';

import {all_pages_shown, open_page, set_the_stage, start_tessera, wait_for_colour, wait_for_reading} from './harness.mjs';
import {join_stream} from './messages.mjs';

const stage = set_the_stage({with_server: false, with_sprites: true});
const view = '#signs/0/1024/1024'; // texel (1024, 1024) in the middle, pixel (640, 400)
const middle = [640, 400];
const amber = [222, 164, 66], meadow = [52, 84, 70];
const id = () => crypto.randomUUID();

async function serve(t, port = 0) {
  const journal = await mkdtemp(path.join(tmpdir(), 'tessera-journal-'));
  t.after(() => rm(journal, {recursive: true, force: true}));
  const options = ['--edits', journal];
  return {start: (at = port) => start_tessera(stage.scenes.folder, at, options)};
}

test('an edit over another connection is seen, and so is one made while the server was away', async (t) => {
  const {start} = await serve(t);
  let server = await start();
  t.after(() => server.stop());
  const {page, close} = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(close);
  await all_pages_shown(page);
  await wait_for_colour(page, middle, meadow);
  let anna = await join_stream(server.origin, 'signs');
  const done = anna.next('editDone');
  anna.send('edit', {id: id(), author: 'Anna', changes: [{change: {case: 'placeSprite', value: {id: 7n, pattern: 0, x: 1024, y: 1024}}}]});
  assert.equal((await done).answer.revision, 1n);
  await wait_for_colour(page, middle, amber);
  await wait_for_reading(page, 'deed', 'Anna placed a sprite');
  await wait_for_reading(page, 'revision', '1');
  anna.close();

  await server.stop();
  await page.waitForSelector('.live-sign[data-state="waiting"]');
  server = await start(server.port);
  await page.waitForSelector('.live-sign[data-state="open"]', {timeout: 30000});
  anna = await join_stream(server.origin, 'signs');
  anna.send('edit', {id: id(), author: 'Anna', changes: [{change: {case: 'removeSprite', value: {id: 7n}}}]});
  await wait_for_colour(page, middle, meadow);
  await wait_for_reading(page, 'revision', '2');
  anna.close();
});

test('what a hand places and drags is told to others, and undo is an edit, too', async (t) => {
  const {start} = await serve(t);
  const server = await start();
  t.after(server.stop);
  const {page, complaints, close} = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(close);
  await all_pages_shown(page);
  await page.waitForSelector('.live-sign[data-state="open"]');
  const anna = await join_stream(server.origin, 'signs');
  await page.keyboard.press('e');
  await page.getByRole('radio').first().click();
  const placed = anna.next('editDone');
  await page.mouse.click(...middle);
  const {changes: [{change}]} = await placed;
  assert.equal(change.case, 'placeSprite');
  assert.deepEqual([change.value.x, change.value.y], [1024, 1024]);
  await page.keyboard.press('Escape');
  await wait_for_colour(page, middle, amber);

  const moved = anna.next('editDone');
  await page.mouse.move(...middle);
  await page.locator('[data-cursor=move]').waitFor();  // the page has heard of its own edit
  await page.mouse.down();
  for (let i = 1; i <= 10; ++i) await page.mouse.move(640 + 20 * i, 400);
  await page.mouse.up();
  assert.equal((await moved).changes[0].change.value.x, 1224);
  await wait_for_colour(page, [840, 400], amber);
  await wait_for_colour(page, middle, meadow);
  const undone = anna.next('editDone');
  await page.keyboard.press('Control+z');
  assert.equal((await undone).changes[0].change.value.x, 1024);
  await page.keyboard.press('Escape');
  await page.mouse.move(200, 700);
  await wait_for_colour(page, middle, amber);
  assert.deepEqual(complaints, []);
  anna.close();
});
