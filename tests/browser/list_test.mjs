import assert from 'node:assert/strict';
import {test} from 'node:test';

import {clay, open_page, set_the_stage, wait_for_colour} from './harness.mjs';

const stage = set_the_stage();

test('lists every scene with its kind, extent and attribution, and asks no other host', async () => {
  const {page, complaints, close} = await open_page(stage.browser, stage.server.origin);
  await page.waitForSelector('.card');
  assert.equal(await page.locator('.card').count(), 3);
  const clay_card = await page.locator('.card', {hasText: 'Fired clay'}).innerText();
  assert.match(clay_card, /Constant colour/);
  assert.match(clay_card, /274,877,906,944 × 274,877,906,944 texels/);
  assert.match(clay_card, /0 to 30/);
  assert.match(clay_card, /Made for a test/);
  await page.waitForTimeout(300);
  assert.deepEqual(complaints, []);
  await close();
});

test('shows live texels of a scene on its card', async () => {
  const {page, close} = await open_page(stage.browser, stage.server.origin);
  const thumbnail = page.locator('.card', {hasText: 'Fired clay'}).locator('canvas.drawn');
  await thumbnail.waitFor();
  const {x, y, width, height} = await thumbnail.boundingBox();
  const points = [[0.2, 0.2], [0.5, 0.5], [0.8, 0.8]].map(([u, v]) => [Math.round(x + u * width), Math.round(y + v * height)]);
  for (const point of points) await wait_for_colour(page, point, clay); // it fades in
  await close();
});

test('shows a broken scene with what is wrong with it', async () => {
  const {page, close} = await open_page(stage.browser, stage.server.origin);
  const broken = page.locator('.broken li');
  await broken.waitFor();
  assert.equal(await broken.count(), 1);
  assert.match(await broken.innerText(), /torn/);
  assert.match(await broken.innerText(), /colour/, 'the problem names the field');
  await close();
});

test('opens a scene from its card by keyboard, at its opening view, and goes back to the list', async () => {
  const {page, complaints, close} = await open_page(stage.browser, stage.server.origin);
  await page.locator('.card a', {hasText: 'Draughts board'}).focus();
  await page.keyboard.press('Enter');
  await page.waitForSelector('.viewer');
  assert.equal(await page.locator('.place h1').innerText(), 'Draughts board');
  await page.waitForFunction(() => location.hash === '#board/2.5/1000000/2000000');
  await page.goBack();
  await page.waitForSelector('.card');
  assert.deepEqual(complaints, []);
  await close();
});

test('says that a scene is unknown, and leads back to the list', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#marble/3/10/10`);
  await page.getByRole('heading', {name: 'There is no scene called “marble”'}).waitFor();
  await page.getByRole('button', {name: 'All scenes'}).click();
  await page.waitForSelector('.card');
  await close();
});

test('opens a scene of no more than four pages', async () => {
  const {page, complaints, close} = await open_page(stage.browser, stage.server.origin);
  await page.locator('.card a', {hasText: 'Four pages'}).click();
  await page.waitForSelector('.viewer[data-loading="0"]');
  assert.equal(new URL(page.url()).hash, '#four-pages/1/256/256');
  assert.deepEqual(complaints, []);
  await close();
});
