// The stream's messages from the server's side, by protoc's own description of proto/stream.proto.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';

const require = createRequire(path.join(process.env.TESSERA_NODE_MODULES ?? '.', 'index.js'));
const {create, createFileRegistry, fromBinary, toBinary} = require('@bufbuild/protobuf');
const {FileDescriptorSetSchema} = require('@bufbuild/protobuf/wkt');
export const {WebSocketServer, WebSocket} = require('ws');

const registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, readFileSync(process.env.TESSERA_STREAM_DESCRIPTION)));
const [client_message, server_message] = ['ClientMessage', 'ServerMessage'].map((name) => registry.getMessage(`tessera.proto.${name}`));
const writer = (schema) => (kind, value) => toBinary(schema, create(schema, {message: {case: kind, value}}));
const reader = (schema) => (bytes) => {
  const {message} = fromBinary(schema, bytes);
  return {kind: message.case, value: message.value};
};

/** What a server writes and reads, and what a client does. */
export const as_server = {write: writer(server_message), read: reader(client_message)};
export const as_client = {write: writer(client_message), read: reader(server_message)};

/** A client of the real server's stream: `next(kind)` waits for a message of a kind. */
export async function join_stream(origin, scene, hello = {}) {
  const socket = new WebSocket(`${origin.replace('http', 'ws')}/scenes/${scene}/stream`, 'tessera.stream.1');
  socket.binaryType = 'arraybuffer';
  const heard = [];
  const waiting = new Set();
  socket.on('message', (data) => {
    const message = as_client.read(new Uint8Array(data));
    heard.push(message);
    for (const wake of [...waiting]) wake(message);
  });
  await new Promise((resolve, reject) => socket.once('open', resolve).once('error', reject));
  const send = (kind, value) => socket.send(as_client.write(kind, value));
  const next = (kind, passes = () => true) =>
    new Promise((resolve) => {
      const look = (message) => {
        if (message.kind !== kind || !passes(message.value)) return;
        waiting.delete(look);
        resolve(message.value);
      };
      waiting.add(look);
    });
  const greeted = next('hello');
  send('hello', {name: 'Anna', wantsPresence: true, wantsEdits: true, ...hello});
  return {hello: await greeted, send, next, heard, close: () => socket.close()};
}
