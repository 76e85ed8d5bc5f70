// The report of a preparation, opened as a user opens it: from the disk, with nobody to ask.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {mkdtemp, readFile, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {after, before, test} from 'node:test';
import {pathToFileURL} from 'node:url';
import {promisify} from 'node:util';

import {open_browser} from './harness.mjs';
import {grey_picture} from './png.mjs';

let folder, browser, report, figures;
before(async () => {
  folder = await mkdtemp(path.join(tmpdir(), 'tessera-report-'));
  // Speckles over slow waves: nothing repeats
  let state = 1;
  const noise = () => (state = (state * 48271) % 0x7fffffff) / 0x7fffffff;
  await writeFile(path.join(folder, 'sand.png'), grey_picture(192, 192, (x, y) =>
    Math.round(110 + 20 * Math.sin(x / 17 + Math.sin(y / 23) * 2) + 60 * noise())));
  const file = path.join(folder, 'sand.html');
  await promisify(execFile)(process.env.TESSERA_BINARY, ['prepare', path.join(folder, 'sand.png'), '-o', path.join(folder, 'sand'),
    '--tile', '64', '--contents', '6', '--report', file, '--quiet']);
  report = pathToFileURL(file).href;
  figures = JSON.parse(await readFile(path.join(folder, 'sand.json'), 'utf8'));
  browser = await open_browser();
});
after(async () => {
  await browser?.close();
  if (folder) await rm(folder, {recursive: true, force: true});
});

/** The report in a window, with whatever went wrong on it. @param {{colorScheme?: 'light' | 'dark', offline?: boolean}} [options] */
async function open_report(options = {}) {
  const context = await browser.newContext({viewport: {width: 1280, height: 900}, offline: true, ...options});
  const page = await context.newPage();
  /** @type {string[]} */
  const complaints = [];
  page.on('console', (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => complaints.push(`exception: ${error.message}`));
  page.on('request', (request) => {
    if (!request.url().startsWith('data:') && request.url() !== report) complaints.push(`asked ${request.url().slice(0, 200)}`);
  });
  await page.goto(report);
  return {page, complaints, close: () => context.close()};
}

test('opens without a network, asks for nothing, and complains of nothing', async () => {
  const {page, complaints, close} = await open_report();
  assert.equal(await page.title(), 'sand · Tessera');
  await page.waitForTimeout(300);
  assert.deepEqual(complaints, []);
  await close();
});

test('shows every gate with its figure, as the figures for programs say', async () => {
  const {page, close} = await open_report();
  const rows = await page.locator('[data-gates] tbody tr').allInnerTexts();
  assert.equal(rows.length, 5);
  assert.equal(figures.gates.length, 5);
  for (const [i, gate] of figures.gates.entries()) {
    const [name, value, limit] = rows[i].split('\t');
    assert.equal(name, gate.name);
    assert.ok(Math.abs(Number(value) - gate.value) <= 0.00051, `${value} for ${gate.value}`);
    assert.ok(Math.abs(Number(limit) - gate.limit) <= 0.00051, `${limit} for ${gate.limit}`);
    assert.ok(rows[i].includes(gate.passed ? 'passed' : 'failed'));
  }
  assert.equal((await page.locator('[data-verdict]').innerText()).includes('All'), figures.passed);
  await close();
});

test('holds pictures that can be decoded, each as large as it says', async () => {
  const {page, close} = await open_report();
  const sizes = await page.evaluate(async () => {
    const sizes = [];
    for (const picture of document.querySelectorAll('.picture:not([data-period])')) {
      const image = new Image();
      image.src = getComputedStyle(picture).backgroundImage.slice(5, -2);
      await image.decode();
      sizes.push([`${image.naturalWidth} ${image.naturalHeight}`, picture.dataset.zoom]);
    }
    return sizes;
  });
  assert.equal(sizes.length, 3 + 3 + 3, 'previews; tile, patch map, seams; what repeats where');
  for (const [is, said] of sizes) assert.equal(is, said);
  assert.equal(await page.locator('.content').count(), figures.contents);
  const sheets = await page.evaluate(() => [...document.querySelectorAll('.content i')].filter(
    (part) => !getComputedStyle(part).backgroundImage.startsWith('url("data:image/jpeg')).length);
  assert.equal(sheets, 0, 'contents without a picture');
  await close();
});

test('enlarges a picture by click, zooms by key, and closes by Escape', async () => {
  const {page, complaints, close} = await open_report();
  await page.getByRole('button', {name: 'The texture at level 0'}).click();
  const stage = page.locator('dialog .stage');
  await stage.waitFor();
  assert.match(await page.locator('dialog [data-words]').innerText(), /level 0/);
  const before = await stage.boundingBox();
  assert.equal(Math.round(before.width), 2048);
  await page.keyboard.press('+');
  assert.equal(Math.round((await stage.boundingBox()).width), 2560);
  await page.keyboard.press('Escape');
  await stage.waitFor({state: 'hidden'});
  await page.locator('.content').first().click();
  assert.match(await page.locator('dialog [data-words]').innerText(), /^0:1, \d+ texels from/);
  assert.deepEqual(complaints, []);
  await close();
});

test('shows one level at a time, and says what contents are when pointed at', async () => {
  const {page, close} = await open_report();
  await page.getByRole('button', {name: 'Level 6', exact: true}).click();
  assert.equal(await page.getByRole('button', {name: 'The texture at level 6'}).isVisible(), true);
  assert.equal(await page.getByRole('button', {name: 'The texture at level 0'}).isVisible(), false);
  assert.match(await page.locator('.content').first().getAttribute('title'), /seam \d+\.\d\d times the photograph’s steps/);
  await close();
});

test('is light or dark as the reader’s system is', async () => {
  const grounds = [];
  for (const colorScheme of ['light', 'dark']) {
    const {page, close} = await open_report({colorScheme});
    grounds.push(await page.evaluate(() => getComputedStyle(document.body).backgroundColor));
    await close();
  }
  assert.notEqual(grounds[0], grounds[1]);
});
