// Answers that the real server gives only in a bad hour, from a server that gives them on demand.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, colours_at, open_page, read, set_the_stage, until, wait_for_colour, wait_for_reading, web_folder} from './harness.mjs';
import {start_page_server, tint} from './page_server.mjs';

const stage = set_the_stage({with_server: false});

/** Answers wait at it until it opens. */
function gate() {
  let open = () => {};
  const opened = new Promise((resolve) => (open = resolve));
  return {opened, open};
}

test('a busy server is asked again, but not before it said', async (t) => {
  /** @type {Map<string, number[]>} */
  const asked_at = new Map();
  const server = await start_page_server({
    web: web_folder,
    answer_page: (_page, response, url) => {
      const times = asked_at.get(url.pathname) ?? [];
      asked_at.set(url.pathname, [...times, Date.now()]);
      if (times.length > 0) return false;
      response.writeHead(503, {'retry-after': '1', 'cache-control': 'no-store'}).end('busy');
      return true;
    },
  });
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024`);
  await all_pages_shown(page);
  await wait_for_colour(page, [640, 400], tint(1, 2, 2));
  const in_view = asked_at.get('/scenes/tints/r0-abc/3/2/2.png') ?? [];
  assert.equal(in_view.length, 2);
  assert.ok(in_view[1] - in_view[0] >= 1000, `asked again after ${in_view[1] - in_view[0]} ms`);
  await close();
});

test('pages on screen stay until those of another accuracy are there', async (t) => {
  const exact_pages = gate();
  const server = await start_page_server({
    web: web_folder,
    answer_page: async (_page, _response, url) => {
      if (url.search === '?accuracy=exact') await exact_pages.opened;
      return false;
    },
  });
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024`);
  await all_pages_shown(page);
  await page.getByRole('button', {name: 'View options'}).click();
  await page.getByRole('radio', {name: 'Exact'}).check();
  await wait_for_colour(page, [640, 400], tint(1, 2, 2));
  for (let look = 0; look < 4; ++look) {
    assert.deepEqual((await colours_at(page, [[640, 400]]))[0], tint(1, 2, 2));
    await page.waitForTimeout(100);
  }
  assert.equal(await read(page, 'state'), 'loading');
  exact_pages.open();
  await all_pages_shown(page);
  assert.ok(server.requests.some((url) => url.endsWith('?accuracy=exact')));
  await wait_for_colour(page, [640, 400], tint(1, 2, 2));
  await close();
});

test('a coarser page stands in for one that has not come', async (t) => {
  const finest_pages = gate();
  const server = await start_page_server({
    web: web_folder,
    answer_page: async ({z}) => {
      if (z === 4) await finest_pages.opened;
      return false;
    },
  });
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1024/1024`);
  await all_pages_shown(page);
  await page.keyboard.press('+');
  await page.waitForFunction(() => document.querySelector('[data-read="level"]')?.textContent === '0');
  await wait_for_reading(page, 'state', 'loading');
  await wait_for_colour(page, [640, 400], tint(1, 2, 2));
  finest_pages.open();
  await wait_for_colour(page, [640, 400], tint(0, 4, 4));
  await close();
});

test('a page that has left the view is waited for no longer', async (t) => {
  let cancelled = 0;
  const server = await start_page_server({
    web: web_folder,
    n: 12,
    answer_page: (page, response) => {
      if (page.z !== 12 || page.x > 100) return false;
      response.on('close', () => ++cancelled);
      return true; // never answered
    },
  });
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/0/5120/5120`);
  await page.waitForFunction(() => Number(document.querySelector('.viewer')?.dataset.loading) > 3);
  await page.keyboard.press('t');
  await page.keyboard.type('500000 500000');
  await page.keyboard.press('Enter');
  await all_pages_shown(page);
  await until(() => cancelled > 3, 'requests were cancelled');
  await wait_for_colour(page, [640, 400], tint(0, Math.floor(500000 / 256), Math.floor(500000 / 256)));
  await close();
});

test('a page that fails is told of, and comes when it is asked for again', async (t) => {
  let broken = true;
  const server = await start_page_server({
    web: web_folder,
    answer_page: ({z, x, y}, response) => {
      if (!broken || z !== 3 || x !== 2 || y !== 2) return false;
      response.writeHead(400, {'cache-control': 'no-store'}).end('the page is out of its mind\n');
      return true;
    },
  });
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/#tints/1/1100/1100`);
  await page.getByRole('button', {name: '1 failed: retry'}).waitFor();
  assert.equal(await read(page, 'state'), 'failed');
  assert.equal(await read(page, 'facts'), 'the page is out of its mind');
  broken = false;
  await page.getByRole('button', {name: '1 failed: retry'}).click();
  await all_pages_shown(page);
  await wait_for_colour(page, [640, 400], tint(1, 2, 2));
  await close();
});
