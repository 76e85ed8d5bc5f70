// Sprites placed and moved by hand: drawn at once, seen once, undone as one; refusals are told in words.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {all_pages_shown, colours_at, open_page, set_the_stage, until, wait_for_colour, web_folder} from './harness.mjs';
import {ground, pattern_colours, start_sprite_server} from './sprite_server.mjs';

const stage = set_the_stage({with_server: false});
// The middle of the view, pixel (640, 400), is texel (1152, 640): in page (4, 2)
const view = '#tints/0/1152/640';
const pixel = (x, y) => [x - 1152 + 640, y - 640 + 400];
const [square, small] = pattern_colours;

async function open_editor(t, options = {}, at = view) {
  const server = await start_sprite_server({web: web_folder, ...options});
  t.after(server.stop);
  const opened = await open_page(stage.browser, `${server.origin}/${at}`);
  t.after(opened.close);
  await all_pages_shown(opened.page);
  await server.connected();
  await opened.page.keyboard.press('e');
  await opened.page.getByRole('complementary', {name: 'Editor'}).waitFor();
  await opened.page.waitForFunction(() => document.querySelectorAll('.pattern canvas').length === 2);
  const {page} = opened;
  // The list of sprites comes by itself, some time after the panel
  if (options.sprites?.some(({x, y}) => x === one.x && y === one.y)) {
    await page.mouse.move(...pixel(one.x, one.y));
    await page.locator('[data-cursor=move]').waitFor();
  }
  const drag = async (from, to, {is_down = false} = {}) => {
    if (!is_down) await page.mouse.move(...from);
    if (!is_down) await page.mouse.down();
    for (let i = 1; i <= 8; ++i) {
      await page.mouse.move(from[0] + ((to[0] - from[0]) * i) / 8, from[1] + ((to[1] - from[1]) * i) / 8);
      await page.waitForTimeout(16);
    }
  };
  return {...opened, server, drag};
}

const one = {id: 1, pattern: 0, x: 1152, y: 640};

/** In each frame from now on: what lies over the map at places of the view, pages and sprites together. */
async function sample_frames(page, places) {
  await page.evaluate((places) => {
    const frames = (window.frames_seen = []);
    const look = () => {
      frames.push(places.map(([x, y]) => {
        let shown = [0, 0, 0];
        for (const name of ['pages', 'sprites']) {
          const canvas = document.querySelector(`canvas.${name}`);
          const [red, green, blue, alpha] = canvas.getContext('2d').getImageData(x, y, 1, 1).data;
          shown = [red, green, blue].map((code, i) => Math.round((code * alpha + shown[i] * (255 - alpha)) / 255));
        }
        return shown.join(' ');
      }).join(' | '));
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  }, places);
  return async () => {
    const frames = await page.evaluate(() => window.frames_seen);
    return frames.filter((frame, i) => frame !== frames[i - 1]);
  };
}
const quiet = (complaints) => complaints.filter((text) => !text.includes('willReadFrequently'));

test('a pattern is placed where one clicks, at once, and stays when its page comes', async (t) => {
  const {page, complaints, server} = await open_editor(t, {page_delay: 250});
  await page.getByRole('radio', {name: 'small square'}).click();
  await page.mouse.move(...pixel(1152, 640));
  await page.waitForTimeout(50);
  const frames = await sample_frames(page, [pixel(1152, 640)]);
  await page.mouse.click(...pixel(1152, 640));
  await until(() => server.here.size === 1);
  await page.keyboard.press('Escape');
  await page.mouse.move(200, 700);
  await page.waitForTimeout(900);
  const [placed] = server.here.values();
  assert.deepEqual([placed.pattern, placed.x, placed.y], [1, 1152, 640]);
  await wait_for_colour(page, pixel(1152, 640), small);
  const seen = await frames();
  const last = seen.slice(seen.indexOf(small.join(' ')));
  assert.deepEqual(last, [small.join(' ')], 'once it is there it never leaves');
  assert.deepEqual(quiet(complaints), []);
});

test('a drag is seen once in every frame, is one edit, and undo takes it back', async (t) => {
  const {page, complaints, server, drag} = await open_editor(t, {sprites: [one], page_delay: 120});
  const [from, to] = [pixel(1152, 640), pixel(1352, 700)];
  await wait_for_colour(page, from, square);
  // Held for a moment, as a hand does: the page without it is here when it moves
  await page.mouse.move(...from);
  const lifted = page.waitForResponse((response) => response.url().includes('/without-1/'));
  await page.mouse.down();
  await (await lifted).finished();
  await page.waitForTimeout(400);
  const frames = await sample_frames(page, [from, to]);
  await drag(from, to, {is_down: true});
  await page.mouse.up();
  await until(() => server.here.get(1n).x === 1352);
  await page.waitForTimeout(900);
  assert.equal(server.here.get(1n).y, 700);
  assert.equal(server.scene.revision, 1, 'one gesture is one edit');
  const at_start = `${square.join(' ')} | ${ground.join(' ')}`, between = `${ground.join(' ')} | ${ground.join(' ')}`, at_end = `${ground.join(' ')} | ${square.join(' ')}`;
  const outlines = (frame) => ![at_start, between, at_end].includes(frame);
  const seen = (await frames()).filter((frame) => !outlines(frame));
  assert.ok(seen.includes(at_end));
  assert.ok(!seen.slice(seen.indexOf(at_end)).some((frame) => frame !== at_end), `after it arrived nothing flashes: ${seen}`);
  const both = (await frames()).filter((frame) => frame === `${square.join(' ')} | ${square.join(' ')}`);
  assert.deepEqual(both, [], 'never in two places');
  assert.match(server.lifted_asked[0], /\/without-1\//);

  await page.keyboard.press('Control+z');
  await until(() => server.here.get(1n).x === 1152);
  await page.keyboard.press('Escape');
  await page.mouse.move(200, 700);
  await wait_for_colour(page, from, square);
  await wait_for_colour(page, to, ground);
  await page.keyboard.press('Control+Shift+z');
  await until(() => server.here.get(1n).x === 1352);
  await wait_for_colour(page, to, square);
  assert.deepEqual(quiet(complaints), []);
});

test('an animated sprite in the hand shows the frame of the step that is shown', async (t) => {
  const clock = {animated: true, steps_per_second: 10, loop_steps: '4'};
  const {page, complaints, drag} = await open_editor(t, {sprites: [{...one, animation: 0}], page_delay: 120, clock}, `${view}?step=2`);
  const [from, to] = [pixel(1152, 640), pixel(1352, 700)];
  await wait_for_colour(page, from, small);
  await drag(from, to);
  await wait_for_colour(page, to, small);
  const frames = await sample_frames(page, [to]);
  await page.mouse.up();
  await page.waitForTimeout(900);
  assert.deepEqual(await frames(), [small.join(' ')], 'in the hand and on the pages, in every frame');
  assert.deepEqual(quiet(complaints), []);
});

test('Escape in a drag leaves the sprite where it was', async (t) => {
  const {page, server, drag} = await open_editor(t, {sprites: [one]});
  await drag(pixel(1152, 640), pixel(1400, 700));
  await page.keyboard.press('Escape');
  await page.mouse.up();
  await page.keyboard.press('Escape');
  await page.mouse.move(200, 700);
  await wait_for_colour(page, pixel(1152, 640), square);
  assert.equal(server.scene.revision, 0);
});

test('handles scale and turn, numbers do too, and Delete removes', async (t) => {
  const {page, server, drag} = await open_editor(t, {sprites: [one]});
  await page.mouse.click(...pixel(1140, 630));
  await page.getByRole('toolbar', {name: 'Selection'}).getByText('square').waitFor();
  // The corner stands a little outside of the sprite's own, 32 texels from the middle
  await drag(pixel(1152 + 34, 640 + 34), pixel(1152 + 68, 640 + 68));
  await page.mouse.up();
  await until(() => Math.abs(server.here.get(1n).scale - 2) < 0.05);
  // The knob above: a quarter of a turn to the right
  await page.waitForTimeout(200);
  const reach = 64 + 2.2 + 26;
  await drag(pixel(1152, 640 - reach), pixel(1152 + reach, 640));
  await page.mouse.up();
  await until(() => Math.abs(server.here.get(1n).turn - 0.25) < 0.02);
  await page.getByRole('textbox', {name: 'Scale'}).fill('50');
  await page.keyboard.press('Enter');
  await until(() => server.here.get(1n).scale === 0.5);
  await page.locator('.map').focus();
  await page.keyboard.press('Delete');
  await until(() => server.here.size === 0);
  await wait_for_colour(page, pixel(1152, 640), ground);
});

test('a frame takes hold of several: they move together, in one edit', async (t) => {
  const sprites = [one, {id: 2, pattern: 1, x: 1300, y: 640}, {id: 3, pattern: 0, x: 1600, y: 640}];
  const {page, server, drag} = await open_editor(t, {sprites});
  await page.keyboard.down('Shift');
  await drag(pixel(1060, 560), pixel(1380, 740));
  await page.mouse.up();
  await page.keyboard.up('Shift');
  await page.getByRole('toolbar', {name: 'Selection'}).getByText('2 sprites').waitFor();
  await drag(pixel(1152, 640), pixel(1152, 740));
  await page.mouse.up();
  await until(() => server.here.get(1n).y === 740 && server.here.get(2n).y === 740);
  assert.equal(server.here.get(3n).y, 640);
  assert.equal(server.scene.revision, 1);
});

test('what the server refuses is told in its words, and is as it was', async (t) => {
  const {page, server, drag} = await open_editor(t, {sprites: [one]});
  server.state.refuse = {why: 0, detail: 'changes[0].move_sprite: the cell at (4, 2) is full'};
  await drag(pixel(1152, 640), pixel(1352, 700));
  await page.mouse.up();
  await page.getByText('the cell at (4, 2) is full').waitFor();
  await page.keyboard.press('Escape');
  await page.mouse.move(200, 700);
  await wait_for_colour(page, pixel(1152, 640), square);
  await wait_for_colour(page, pixel(1352, 700), ground);
});

test('an edit whose answer a break swallowed is sent again, with its own id', async (t) => {
  const {page, server} = await open_editor(t, {sprites: [one]});
  await page.mouse.click(...pixel(1140, 630));
  server.scene.swallow = 1;
  await page.keyboard.press('Delete');
  await until(() => server.edit_ids.length === 1);
  server.break_streams();
  await until(() => server.here.size === 0);
  assert.equal(new Set(server.edit_ids).size, 1);
  assert.equal(server.edit_ids.length, 2);
});

test("what another holds is seen in that hand only, then where it was put, or back where it was", async (t) => {
  const server = await start_sprite_server({web: web_folder, sprites: [one]});
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(close);
  await all_pages_shown(page);
  await server.connected();
  const [from, to, beyond] = [[1152, 640], [1352, 700], [1000, 500]];
  const shown_at = async (place) => {
    for (const other of [from, to, beyond]) await wait_for_colour(page, pixel(...other), other === place ? square : ground);
  };
  const hold = (place) => server.tell_all('present', {people: [{
    session: 7n, name: 'Anna', mayEdit: true,
    presence: {x: 1000, y: 900, level: 0, ...(place && {held: {id: 1n, pattern: 0, x: place[0], y: place[1], scale: 1, turn: 0}})},
  }]});
  await shown_at(from);
  hold(to);
  await shown_at(to);
  hold(null);
  await shown_at(from);

  hold(to);
  await shown_at(to);
  hold(null);
  server.move_by(7n, 1n, {x: to[0], y: to[1]});
  await shown_at(to);
  hold(beyond);
  await shown_at(beyond);
});

test('who may not edit is told why, and looks on', async (t) => {
  const server = await start_sprite_server({web: web_folder, sprites: [one], hello: {mayEdit: false, whyNot: 'Edits from afar need a token: ask who runs the server.'}});
  t.after(server.stop);
  const {page, close} = await open_page(stage.browser, `${server.origin}/${view}`);
  t.after(close);
  await all_pages_shown(page);
  await server.connected();
  await page.getByRole('button', {name: 'Edit (E)'}).click();
  await page.getByRole('status').getByText('Edits from afar need a token').waitFor();
  assert.equal(await page.getByRole('complementary', {name: 'Editor'}).isVisible(), false);
  await page.getByRole('button', {name: /^People/}).click();
  await page.getByLabel('Token').fill('secret');
  await page.keyboard.press('Enter');
  await until(() => [...server.clients].some(({heard}) => heard.some(({kind, value}) => kind === 'hello' && value.token === 'secret')), 'a hello with the token');
});
