// What the page reads and writes in words, without a browser.
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {format_address, parse_address} from '../../client/web/src/address.js';
import {format_bytes, round_number_below, with_separators} from '../../client/web/src/numbers.js';
import {server_timing} from '../../client/web/src/page_fetch.js';
import {slice_chosen, slice_within} from '../../client/web/src/slices.js';
import {Texture} from '../../client/web/src/texture.js';
import {parse_texel} from '../../client/web/src/texel_text.js';

test('an address survives being written and read', () => {
  const addresses = [
    {scene: 'stones', view: {level: 3.5, x: 137438953472, y: 5}, options: {}},
    {scene: 'a b/c%', view: {level: -6, x: 7.25, y: 0.5}, options: {format: 'webp', grid: '1'}},
    {scene: 'stones', view: null, options: {}},
    {scene: null, view: null, options: {}},
  ];
  for (const address of addresses) assert.deepEqual(parse_address(format_address(address)), address);
});

test('an address that is no view opens the scene as such', () => {
  for (const hash of ['#stones/1', '#stones/1/2', '#stones/a/b/c', '#stones/1/2/3/4', '#stones///']) {
    assert.deepEqual(parse_address(hash), {scene: 'stones', view: null, options: {}}, hash);
  }
  assert.equal(parse_address('#50%').scene, '50%');
});

test('texels are read however their digits are grouped', () => {
  const place = {x: 1234567, y: 89, level: null};
  for (const text of ['1234567, 89', '1234567 89', '1,234,567 89', '1,234,567; 89', ' (1234567,89) ', '1_234_567 89']) {
    assert.deepEqual(parse_texel(text), place, text);
  }
  assert.deepEqual(parse_texel('1, 2, 3'), {x: 1, y: 2, level: 3});
  for (const text of ['', '7', 'a, b', '1.5, 2', '-1, 2', '1, 2, 3, 4']) assert.equal(parse_texel(text), null, text);
});

test('numbers are short and round', () => {
  assert.equal(with_separators(2 ** 38), '274,877,906,944');
  assert.equal(format_bytes(760), '760 B');
  assert.equal(format_bytes(84123), '84.1 kB');
  assert.equal(format_bytes(2 ** 58), '288 PB');
  assert.deepEqual([0.3, 1, 1.9, 2, 49, 50, 99, 2.4e9].map(round_number_below), [1, 1, 1, 2, 20, 50, 50, 2e9]);
});

test('a page is asked for where TileJSON says', () => {
  const texture = new Texture({
    tilejson: '3.0.0',
    tiles: ['http://127.0.0.1:1/scenes/s/{z}/{x}/{y}.png'],
    tessera: {id: 's', extent_log2_pages: 20, page_url: '/scenes/s/r0-12ab/{z}/{x}/{y}'},
  });
  const page = texture.page_at({x: 2 ** 28 - 1, y: 0}, 3);
  assert.deepEqual(page, {level: 3, x: 2 ** 17 - 1, y: 0});
  assert.equal(texture.page_url(page, {format: 'webp', accuracy: 'fast'}), '/scenes/s/r0-12ab/17/131071/0.webp?accuracy=fast');
  const normals = texture.page_url(page, {format: 'png', accuracy: 'exact', channels: 'normal'});
  assert.equal(normals, '/scenes/s/r0-12ab/17/131071/0.png?accuracy=exact&channels=normal');
  assert.equal(texture.page_url(page, {format: 'png', accuracy: 'high', channels: 'height'}), '/scenes/s/r0-12ab/17/131071/0.png?channels=height');
  assert.equal(texture.page_url(page, {format: 'png', accuracy: 'high', channels: 'albedo'}), '/scenes/s/r0-12ab/17/131071/0.png');
  const slice = texture.page_url(page, {format: 'png', accuracy: 'fast', channels: 'height', slice: -7});
  assert.equal(slice, '/scenes/s/r0-12ab/17/131071/0.png?accuracy=fast&channels=height&slice=-7');
  const plain = new Texture({tiles: ['http://127.0.0.1:1/scenes/s/{z}/{x}/{y}.png'], maxzoom: 2, tessera: {id: 's'}});
  assert.equal(plain.page_url({level: 2, x: 0, y: 0}, {format: 'jpg', accuracy: 'high'}), '/scenes/s/0/0/0.jpg');
});

test('what the server says of its time is understood', () => {
  const made = 'cache;desc=miss, queue;dur=0.132, evaluate;dur=1.25, encode;dur=0.75';
  assert.deepEqual(server_timing(made), {server_cached: false, server_milliseconds: 2});
  assert.deepEqual(server_timing('cache;desc=hit'), {server_cached: true, server_milliseconds: undefined});
  assert.deepEqual(server_timing(''), {server_cached: false, server_milliseconds: undefined});
});

test('slices repeat, go on without end, or there is one', () => {
  assert.deepEqual([-1, 0, 15, 16, 33].map((slice) => slice_within(slice, 16)), [15, 0, 15, 0, 1]);
  assert.deepEqual([-1, 0, 2 ** 41, -(2 ** 41)].map((slice) => slice_within(slice, 0)), [-1, 0, 2 ** 40, -(2 ** 40)]);
  assert.deepEqual([-5, 0, 9, NaN].map((slice) => slice_within(slice, 1)), [0, 0, 0, 0]);
  for (const text of [undefined, '', '1e3', '0x10', 'NaN', '1.5', '--1']) assert.equal(slice_chosen(text, 0), 0, text);
  assert.equal(slice_chosen('-12', 0), -12);
  assert.equal(slice_chosen('19', 16), 3);
});
