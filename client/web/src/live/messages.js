import {create, createFileRegistry, fromBinary, toBinary} from '@bufbuild/protobuf';
import {FileDescriptorSetSchema} from '@bufbuild/protobuf/wkt';
import description from 'stream-description';

// proto/stream.proto itself, as protoc describes it: no generated code that could be of another version
const registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, description));
const schema = (/** @type {string} */ name) => /** @type {any} */ (registry.getMessage(`tessera.proto.${name}`));
const client_message = schema('ClientMessage');
const server_message = schema('ServerMessage');

/** Of WebSockets that speak proto/stream.proto. */
export const subprotocol = 'tessera.stream.1';

/**
 * A client's message: encode('hello', {name: 'Anna'}). Fields are in camelCase, 64-bit integers are BigInts.
 * @param {string} kind @param {object} value @returns {Uint8Array}
 */
export const encode = (kind, value) => toBinary(client_message, create(client_message, {message: {case: kind, value}}));

/**
 * A server's message; `kind` is undefined for one that only newer pages know. Throws if the bytes are no message.
 * @param {Uint8Array} bytes @returns {{kind: string | undefined, value: any}}
 */
export function decode(bytes) {
  const {message} = /** @type {any} */ (fromBinary(server_message, bytes));
  return {kind: message.case, value: message.value};
}
