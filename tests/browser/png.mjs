// As much of PNG as the tests write: a page of one colour, a picture of grey texels. (Node 18's zlib has no crc32.)
import {deflateSync} from 'node:zlib';

const table = Uint32Array.from({length: 256}, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; ++bit) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  return value;
});

/** @param {Uint8Array} bytes */
function crc32_of(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

/** @param {string} name @param {Buffer} data */
function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, 'latin1'), data]);
  const length = Buffer.alloc(4);
  const crc = Buffer.alloc(4);
  length.writeUInt32BE(data.length);
  crc.writeUInt32BE(crc32_of(body));
  return Buffer.concat([length, body, crc]);
}

/** A PNG of one colour. @param {number} side @param {number[]} rgb */
export function flat_picture(side, rgb) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(side, 0);
  header.writeUInt32BE(side, 4);
  header.set([8, 2, 0, 0, 0], 8); // 8 bits, RGB, no interlace
  const row = Buffer.concat([Buffer.from([0]), Buffer.alloc(side * 3, Buffer.from(rgb))]);
  const signature = Buffer.from('\x89PNG\r\n\x1a\n', 'latin1');
  const rows = deflateSync(Buffer.concat(Array(side).fill(row)));
  return Buffer.concat([signature, chunk('IHDR', header), chunk('IDAT', rows), chunk('IEND', Buffer.alloc(0))]);
}

/** A page of one colour. @param {number[]} rgb */
export const flat_page = (rgb) => flat_picture(256, rgb);

/** A PNG of grey texels. @param {number} width @param {number} height @param {(x: number, y: number) => number} grey_at */
export function grey_picture(width, height, grey_at) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 0, 0, 0, 0], 8); // 8 bits, grey, no interlace
  const rows = Array.from({length: height}, (_, y) =>
    Buffer.from([0, ...Array.from({length: width}, (_, x) => grey_at(x, y))]));
  const signature = Buffer.from('\x89PNG\r\n\x1a\n', 'latin1');
  return Buffer.concat([signature, chunk('IHDR', header), chunk('IDAT', deflateSync(Buffer.concat(rows))), chunk('IEND', Buffer.alloc(0))]);
}

/** A PNG of 256×256 texels with straight alpha. @param {(x: number, y: number) => number[]} rgba_at */
export function page_of_texels(rgba_at) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(256, 0);
  header.writeUInt32BE(256, 4);
  header.set([8, 6, 0, 0, 0], 8); // 8 bits, RGBA, no interlace
  const rows = Buffer.alloc(256 * 1025);
  for (let y = 0; y < 256; ++y) {
    for (let x = 0; x < 256; ++x) rows.set(rgba_at(x, y), y * 1025 + 1 + x * 4);
  }
  const signature = Buffer.from('\x89PNG\r\n\x1a\n', 'latin1');
  return Buffer.concat([signature, chunk('IHDR', header), chunk('IDAT', deflateSync(rows, {level: 1})), chunk('IEND', Buffer.alloc(0))]);
}
