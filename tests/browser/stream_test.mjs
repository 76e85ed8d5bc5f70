// The page follows a live scene: what others change is replaced where it changed and nowhere else, without a frame that
// shows nothing; a break is gone on from; a burst of edits asks for no page twice at a time.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, colours_at, open_page, read, set_the_stage, until, wait_for_colour, wait_for_reading, web_folder} from './harness.mjs';
import {colour_at, start_stream_server} from './stream_server.mjs';

const stage = set_the_stage({with_server: false});
// Level 0, page (4, 2) fills the middle of the view: its middle is at pixel (640, 400)
const view = '#tints/0/1152/640';
const middle = [640, 400];

async function open_live(t, options = {}) {
  const server = await start_stream_server({web: web_folder, ...options});
  t.after(server.stop);
  const opened = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(opened.close);
  await all_pages_shown(opened.page);
  await server.connected();
  return {...opened, server};
}

const pages_asked = (server) => server.requests.filter((request) => /\.png/.test(request));

/** From now on, in each frame of the page, the colour of the middle of the canvas that shows pages. */
async function sample_frames(page) {
  await page.evaluate(() => {
    const frames = (window.frames_seen = []);
    const look = () => {
      const canvas = document.querySelector('canvas.pages');
      const [red, green, blue, alpha] = canvas.getContext('2d').getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data;
      frames.push([red, green, blue, alpha].join(' '));
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  return () => page.evaluate(() => window.frames_seen);
}

test('an edit by another replaces exactly the touched page, and no frame shows nothing', async (t) => {
  const {page, complaints, server} = await open_live(t, {page_delay: 120});
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 0));
  const [beside] = await colours_at(page, [[900, 400]]);
  const frames = await sample_frames(page);
  const asked_before = pages_asked(server).length;
  server.change(4, 2);
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 1));
  await page.waitForTimeout(300);
  const asked = pages_asked(server).slice(asked_before);
  assert.deepEqual(asked.sort(), ['/scenes/tints/r1-abc/3/2/1.png', '/scenes/tints/r1-abc/4/4/2.png'], 'the page, and the one above it that stands by');
  const seen = await frames();
  const told_apart = seen.filter((colour, i) => colour !== seen[i - 1]);
  const opaque = (colour) => `${colour.join(' ')} 255`;
  assert.deepEqual(told_apart, [opaque(colour_at(0, 4, 2, 0)), opaque(colour_at(0, 4, 2, 1))], 'from one picture to the next, in one frame');
  assert.deepEqual((await colours_at(page, [[900, 400]]))[0], beside);
  assert.deepEqual(complaints.filter((text) => !text.includes('willReadFrequently')), []);
});

test('says the revision, who changed what, and lists the last edits', async (t) => {
  const {page, complaints, server} = await open_live(t, {revision: 1233});
  await wait_for_reading(page, 'revision', '1,233');
  server.change(4, 2, {done: {changes: [1n, 2n, 3n].map((id) => ({change: {case: 'moveSprite', value: {id, x: 5}}}))}});
  await wait_for_reading(page, 'revision', '1,234');
  await wait_for_reading(page, 'deed', 'Anna moved 3 sprites');
  await page.getByRole('button', {name: /revision/}).click();
  await page.getByRole('complementary', {name: 'Last edits'}).getByText('Anna').waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('complementary', {name: 'Last edits'}).waitFor({state: 'hidden'});
  assert.deepEqual(complaints, []);
});

test('a burst of edits asks for a page once at a time, and ends with the latest', async (t) => {
  const {page, complaints, server} = await open_live(t, {page_delay: 60});
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 0));
  const asked_before = pages_asked(server).length, begin = Date.now();
  for (let i = 0; i < 60; ++i) {
    server.change(4, 2);
    await page.waitForTimeout(8);
  }
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 60));
  for (const [key, at_once] of server.most) assert.ok(at_once <= 1, `${key} was asked for ${at_once} times at once`);
  const asked = pages_asked(server).length - asked_before;
  // Two pages, one request at a time for each, and each takes at least 60 ms
  const most = 2 * ((Date.now() - begin) / 60 + 2);
  assert.ok(asked <= most, `${asked} requests for 60 edits of two pages; at most ${most}`);
  assert.deepEqual(complaints.filter((text) => !text.includes('410')), []);
});

test('goes on after a break, with what changed meanwhile and nothing else', async (t) => {
  const {page, server} = await open_live(t);
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 0));
  server.change(4, 2);
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 1));
  const asked_before = pages_asked(server).length;
  server.scene.refuse_streams = true;
  server.break_streams();
  await page.waitForSelector('.live-sign[data-state="waiting"]');
  server.change(4, 2, {quiet: true});
  server.change(7, 7, {quiet: true});
  server.scene.refuse_streams = false;
  await page.waitForSelector('.live-sign[data-state="open"]', {timeout: 15000});
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 2));
  await wait_for_reading(page, 'revision', '3');
  const asked = new Set(pages_asked(server).slice(asked_before));
  for (const path of asked) assert.match(path, /\/(4\/4\/2|3\/2\/1|4\/7\/7|3\/3\/3)\.png/, 'only what changed is asked for');
  const [{heard}] = [...server.clients];
  const hello = heard.find(({kind}) => kind === 'hello').value;
  assert.equal(hello.seenRevision, 1n);
  assert.equal(hello.lineage, 'line');
});

test('a server that cannot go on from there is asked anew for what is shown', async (t) => {
  const {page, server} = await open_live(t);
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 0));
  server.change(4, 2, {quiet: true});
  server.scene.hello = {resumed: false};
  server.break_streams();
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 1));
});

test('an edit between the description and the stream is not missed', async (t) => {
  const server = await start_stream_server({web: web_folder});
  t.after(server.stop);
  server.scene.refuse_streams = true;
  const {page, close} = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(close);
  await all_pages_shown(page);
  server.change(4, 2, {quiet: true});
  server.scene.refuse_streams = false;
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 1));
});

test('without a stream the page works as it did, says so quietly, and follows by asking', async (t) => {
  const server = await start_stream_server({web: web_folder});
  t.after(server.stop);
  server.scene.refuse_streams = true;
  const {page, close} = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(close);
  await all_pages_shown(page);
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 0));
  await page.waitForSelector('.live-sign[data-state="absent"]', {timeout: 15000});
  assert.match(await page.getAttribute('.live-sign', 'title'), /No live stream/);
  assert.equal(await page.getByRole('alert').filter({hasText: 'not answering'}).isVisible(), false);
  server.change(4, 2, {quiet: true});
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 1));
  assert.equal(await read(page, 'revision'), '1');
});

test('shows who else is here, where they are, and that they left', async (t) => {
  const {page, complaints, server} = await open_live(t);
  server.tell_all('present', {people: [{session: 7n, name: 'Anna', mayEdit: true, presence: {x: 1152, y: 640, level: 0}}]});
  const cursor = page.locator('.cursor', {hasText: 'Anna'});
  await cursor.waitFor();
  await page.waitForFunction(() => {
    const {left, top} = document.querySelector('.cursor').getBoundingClientRect();
    return Math.abs(left - 640) < 3 && Math.abs(top - 400) < 3;
  });
  await page.getByRole('button', {name: 'People: Anna is here, too'}).click();
  await page.locator('.people-list').getByText('Anna').waitFor();
  // One's own name, and where one's own hand is
  await page.getByRole('textbox', {name: 'You', exact: true}).fill('Ben');
  await page.keyboard.press('Enter');
  await page.mouse.move(700, 450);
  let moves = 0;
  await until(async () => {
    await page.mouse.move(700 + (++moves % 2), 450);
    return [...server.clients].some(({name, heard}) => name === 'Ben' && heard.some(({kind, value}) => kind === 'presence' && value.x > 1000));
  }, 'Ben is somewhere');
  const [ben] = [...server.clients].filter(({name}) => name === 'Ben');
  const {value} = ben.heard.filter(({kind}) => kind === 'presence').pop();
  assert.ok(Math.abs(value.x - 1212) < 2 && Math.abs(value.y - 690) < 2, `told to be at ${value.x}, ${value.y}`);
  server.tell_all('present', {people: [{session: 7n, name: 'Anna', presence: {x: 1152, y: 640}}]});
  await cursor.waitFor();
  server.tell_all('present', {left: [7n]});
  await cursor.waitFor({state: 'detached'});
  assert.deepEqual(complaints, []);
});

test('rubbish on the stream is survived', async (t) => {
  const {page, server} = await open_live(t);
  for (const {socket} of server.clients) socket.send(Buffer.from([0xff, 0xff, 0xff, 0x01]));
  await page.waitForSelector('.live-sign[data-state="waiting"]');
  await page.waitForSelector('.live-sign[data-state="open"]', {timeout: 15000});
  server.change(4, 2);
  await wait_for_colour(page, middle, colour_at(0, 4, 2, 1));
});
