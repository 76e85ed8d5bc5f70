import assert from 'node:assert/strict';
import {test} from 'node:test';

import {
  all_pages_shown, clay, colours_at, open_page, read, set_the_stage, square_at, wait_for_colour, wait_for_reading,
} from './harness.mjs';

// In a window of 1280 × 800 the texel the address names has its top-left corner in the middle: pixel (640, 400).
const middle = [640, 400];

const stage = set_the_stage();

test('shows the texel that the address names, texel for pixel, at level 0', async () => {
  const [x, y] = [2 ** 27 + 1000 * 32 + 7, 2 ** 26 + 77 * 32 + 19];
  const {page, complaints, close} = await open_page(stage.browser, `${stage.server.origin}/#board/0/${x}/${y}`);
  await all_pages_shown(page);
  const offsets = [[0, 0], [-8, 0], [-7, 0], [24, 12], [25, 12], [24, 13], [25, 13], [-300, 140], [299, -171]];
  const colours = await colours_at(page, offsets.map(([dx, dy]) => [middle[0] + dx, middle[1] + dy]));
  offsets.forEach(([dx, dy], i) => assert.deepEqual(colours[i], square_at(x + dx, y + dy), `texel ${x + dx}, ${y + dy}`));
  assert.deepEqual(complaints, []);
  await close();
});

test('magnifies texels crisply beyond level 0, and smoothly when asked', async () => {
  const [x, y] = [2 ** 20 + 64, 2 ** 20 + 64]; // a corner of four squares; a texel is 16 pixels
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#board/-4/${x}/${y}`);
  await all_pages_shown(page);
  const beside = [[639, 404], [640, 404]];
  assert.deepEqual(await colours_at(page, beside), [square_at(x - 1, y), square_at(x, y)]);
  await page.keyboard.press('s');
  await wait_for_colour(page, beside[0], (colour) => String(colour) !== String(square_at(x - 1, y)));
  const smooth = await colours_at(page, beside);
  assert.ok(Math.abs(smooth[0][0] - smooth[1][0]) < 40, `no step between ${smooth}`);
  assert.match(page.url(), /texels=smooth/);
  await close();
});

test('zooms through every level from 0 to 30, and shows the right colour at each', async () => {
  const {page, complaints, close} = await open_page(stage.browser, `${stage.server.origin}/#clay/0/137438953472/137438953472`, {width: 640, height: 480});
  for (let level = 0; level <= 30; ++level) {
    await wait_for_reading(page, 'level', String(level));
    await all_pages_shown(page);
    assert.match(await read(page, 'page'), new RegExp(`^level ${level} · \\d+, \\d+$`));
    assert.deepEqual((await colours_at(page, [[320, 240]]))[0], clay, `level ${level}`);
    await page.keyboard.press('-');
  }
  await page.waitForTimeout(200);
  assert.equal(await read(page, 'level'), '30', 'there is nothing beyond the coarsest level');
  assert.deepEqual(complaints, []);
  await close();
});

test('reads out texel, page and what the server says of the page', async () => {
  const last = 2 ** 38 - 1;
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#clay/0/${last}/${last}`);
  await all_pages_shown(page);
  assert.equal(await read(page, 'x'), '274,877,906,943');
  assert.equal(await read(page, 'y'), '274,877,906,943');
  assert.equal(await read(page, 'page'), 'level 0 · 1073741823, 1073741823');
  assert.match(await page.locator('[data-read="page"]').getAttribute('title'), / 30\/1073741823\/1073741823,/);
  assert.match(await read(page, 'facts'), /\d B|kB/);
  assert.match(await read(page, 'facts'), /constant · exact$/);
  for (const [word, meaning] of [['constant', /One colour/], ['exact', /exact mean/]]) {
    assert.match(await page.locator('[data-read="facts"]').getByText(word, {exact: true}).getAttribute('title'), meaning);
  }
  await page.mouse.move(middle[0] + 5, middle[1]);
  await wait_for_reading(page, 'page', 'outside');
  await page.mouse.move(middle[0] - 300, middle[1] - 100);
  await wait_for_reading(page, 'x', '274,877,906,643');
  await close();
});

test('draws the borders and keys of pages when asked', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#clay/0/${256 * 1000}/${256 * 1000}`);
  await all_pages_shown(page);
  const [on_border, inside] = [[640, 500], [760, 500]];
  assert.deepEqual(await colours_at(page, [on_border, inside]), [clay, clay]);
  await page.keyboard.press('g');
  await page.waitForFunction(() => location.hash.includes('grid=1'));
  await wait_for_colour(page, on_border, ([, , blue]) => blue > clay[2] + 40); // a light line
  assert.deepEqual(await colours_at(page, [inside]), [clay]);
  assert.equal(await page.getByRole('button', {name: 'Page grid'}).getAttribute('aria-pressed'), 'true');
  await page.keyboard.press('g');
  await wait_for_colour(page, on_border, clay);
  await close();
});

test('keeps the key of a page that begins behind the top bar below the bar', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#clay/0/${256 * 1000 + 140}/${256 * 1000 + 370}?grid=1`);
  await all_pages_shown(page);
  const bar = await page.locator('.top-bar').boundingBox();
  assert.ok(bar.y + bar.height > middle[1] - 370, 'the page begins behind the bar');
  await wait_for_colour(page, [middle[0] - 133, Math.ceil(bar.y + bar.height) + 15], ([red]) => red < 80); // the label's ground
  await close();
});

test('asks for the format and accuracy that are chosen', async () => {
  const {page, complaints, close} = await open_page(stage.browser, `${stage.server.origin}/#board/3/131072/131072`);
  await all_pages_shown(page);
  await page.getByRole('button', {name: 'View options'}).click();
  await page.getByRole('radio', {name: 'WebP'}).check();
  const exact = page.waitForResponse((response) => /\/r0-[0-9a-f]+\/\d+\/\d+\/\d+\.webp\?accuracy=exact$/.test(response.url()));
  await page.getByRole('radio', {name: 'Exact'}).check();
  assert.equal((await exact).headers()['content-type'], 'image/webp');
  await page.waitForFunction(() => location.hash.includes('format=webp') && location.hash.includes('accuracy=exact'));
  await all_pages_shown(page);
  assert.deepEqual(complaints, []);
  await close();
});

test('explains its keys, and closes the help again', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#board/0/0/0`);
  await page.waitForSelector('.viewer');
  await page.keyboard.press('h');
  await page.getByRole('dialog', {name: 'Getting around'}).waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('dialog').waitFor({state: 'hidden'});
  await close();
});
