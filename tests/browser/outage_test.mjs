import assert from 'node:assert/strict';
import {test} from 'node:test';

import {
  all_pages_shown, clay, open_page, set_the_stage, start_tessera, wait_for_colour, wait_for_reading,
} from './harness.mjs';

const stage = set_the_stage({with_server: false});

test('a server that stops is told of, and its pages come as soon as it is back', async (t) => {
  let server = await start_tessera(stage.scenes.folder);
  t.after(() => server.stop());
  const {page, close} = await open_page(stage.browser, `${server.origin}/#clay/4/60000000/60000000`);
  await all_pages_shown(page);

  await server.stop();
  await page.keyboard.press('t');
  await page.keyboard.type('90000000 90000000');
  await page.keyboard.press('Enter');
  const banner = page.getByRole('alert').filter({hasText: 'The server is not answering'});
  await banner.waitFor();
  await page.getByRole('button', {name: 'Try now'}).waitFor();

  server = await start_tessera(stage.scenes.folder, server.port);
  await banner.waitFor({state: 'hidden'});
  await wait_for_reading(page, 'x', '90,000,000');
  await all_pages_shown(page);
  await wait_for_colour(page, [640, 400], clay);
  await close();
});

test('the list waits for a server that is away, and shows its scenes by itself when it is back', async (t) => {
  let server = await start_tessera(stage.scenes.folder);
  t.after(() => server.stop());
  const {page, close} = await open_page(stage.browser, `${server.origin}/#clay/4/60000000/60000000`);
  await all_pages_shown(page);
  await server.stop();
  await page.keyboard.press('l');
  await page.getByRole('heading', {name: 'The server is not answering'}).waitFor();
  server = await start_tessera(stage.scenes.folder, server.port);
  await page.waitForSelector('.card', {timeout: 20000});
  await close();
});

test('a scene that the server loads anew is shown anew, as soon as a page is asked for', async (t) => {
  const server = await start_tessera(stage.scenes.folder);
  t.after(() => server.stop());
  const {page, close} = await open_page(stage.browser, `${server.origin}/#clay/4/60000000/60000000`);
  await all_pages_shown(page);
  const slate = [70, 84, 92];
  await stage.scenes.paint_clay(slate);
  t.after(() => stage.scenes.paint_clay(clay));
  const fingerprint = async () => (await (await fetch(`${server.origin}/scenes/clay`)).json()).tessera.fingerprint;
  const before_reload = await fingerprint();
  // Either the stream's next hello or the first refused page makes the viewer ask again, whichever is sooner.
  const asked_again = page.waitForResponse((response) => response.url().endsWith('/scenes/clay') && response.ok());
  server.reload_scenes();
  while ((await fingerprint()) === before_reload) await page.waitForTimeout(20);

  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('Shift+ArrowRight');
  await asked_again;
  await wait_for_colour(page, [640, 400], slate);
  await close();
});
