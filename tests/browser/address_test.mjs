import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, open_page, read, set_the_stage, wait_for_reading} from './harness.mjs';

const stage = set_the_stage();

const hash_of = (page) => new URL(page.url()).hash;

test('the address follows the view, and brings it back in another window', async () => {
  const first = await open_page(stage.browser, `${stage.server.origin}/#clay/5/70000000000/90000000000?grid=1`);
  await all_pages_shown(first.page);
  await first.page.keyboard.press('Shift+ArrowRight');
  await first.page.keyboard.press('+');
  await first.page.waitForFunction(() => /^#clay\/4\/70000040960\/90000000000\?grid=1$/.test(location.hash));
  await all_pages_shown(first.page);

  const second = await open_page(stage.browser, first.page.url());
  await all_pages_shown(second.page);
  for (const name of ['level', 'x', 'y', 'page']) assert.equal(await read(second.page, name), await read(first.page, name), name);
  assert.equal(hash_of(second.page), hash_of(first.page));
  await first.close();
  await second.close();
});

test('the mouse moves and zooms, and the texel under the pointer stays where it is', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#board/2/1000000/1000000`);
  await all_pages_shown(page);
  await page.mouse.move(700, 450);
  await page.mouse.down();
  await page.mouse.move(704, 454); // tells a drag from a click
  await page.mouse.move(604, 354, {steps: 5});
  await page.waitForTimeout(300); // a drag that rests before it ends does not glide on
  await page.mouse.up();
  await page.waitForFunction(() => location.hash === '#board/2/1000400/1000400');

  await page.mouse.move(900, 300);
  await wait_for_reading(page, 'x', '1,001,440');
  await page.mouse.wheel(0, -240);
  await page.waitForFunction(() => Number(location.hash.split('/')[1]) < 1.9);
  await page.mouse.move(901, 300);
  await page.mouse.move(900, 300);
  await page.waitForTimeout(500);
  const x = Number((await read(page, 'x')).replaceAll(',', ''));
  assert.ok(Math.abs(x - 1001440) <= 4, `the pointer is at texel ${x} now`);
  await close();
});

test('"go to texel" jumps there, and back leads to where one was', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#clay/2/5000/5000`);
  await all_pages_shown(page);
  await page.keyboard.press('t');
  await page.keyboard.type('274,877,906,943 12345 0');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => location.hash === '#clay/0/274877906943/12345');
  await wait_for_reading(page, 'level', '0');
  await page.goBack();
  await page.waitForFunction(() => location.hash === '#clay/2/5000/5000');
  await wait_for_reading(page, 'x', '5,000');
  await close();
});

test('"go to texel" says what it cannot make sense of', async () => {
  const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#board/0/5000/5000`);
  await all_pages_shown(page);
  const box = page.getByRole('textbox', {name: 'Go to texel'});
  for (const [text, answer] of [['here', /whole numbers/], ['999999999999, 1', /0 to 268,435,455/], ['1, 1, 21', /0 to 20/]]) {
    await box.fill(text);
    await box.press('Enter');
    assert.match(await page.locator('.go-to .problem').innerText(), answer);
  }
  assert.equal(hash_of(page), '#board/0/5000/5000');
  await close();
});

test('an address that is hand-edited to nonsense still opens the scene', async () => {
  for (const rest of ['/99/-5/9e99', '/x/y/z', '/-40/7/7', '?accuracy=perfect&format=tiff']) {
    const {page, complaints, close} = await open_page(stage.browser, `${stage.server.origin}/#board${rest}`);
    await page.waitForFunction(() => document.querySelector('.viewer')?.dataset.loading === '0');
    assert.deepEqual(complaints, [], rest);
    await close();
  }
});

test('zero shows the whole texture between the bars', async () => {
  for (const [width, height] of [[1280, 800], [420, 800]]) {
    const {page, close} = await open_page(stage.browser, `${stage.server.origin}/#board/0/5000/5000`, {width, height});
    await all_pages_shown(page);
    await page.keyboard.press('0');
    const box = (name) => page.locator(name).boundingBox();
    /** What lies wrong. The view glides there, and the address follows it. */
    const wrong = async () => {
      const [, level, x, y] = hash_of(page).split('/').map(Number);
      const side = 2 ** 28 / 2 ** level;
      const left = width / 2 - x / 2 ** level;
      const top = height / 2 - y / 2 ** level;
      const [above, below, rail] = [await box('.top-bar'), await box('.lower'), await box('.level-rail')];
      if (above.y + above.height > top || top + side > below.y) return `${top} to ${top + side} of ${height}`;
      if (left < 0 || left + side > rail.x) return `${left} to ${left + side} of ${width}`;
      return side > 0.6 * Math.min(width, height) ? '' : `${side} of ${width} × ${height}`;
    };
    let found = await wrong();
    for (const give_up = Date.now() + 15000; found && Date.now() < give_up; found = await wrong()) await page.waitForTimeout(50);
    assert.equal(found, '');
    await close();
  }
});
