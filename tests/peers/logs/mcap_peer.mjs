// Foxglove's @mcap/core on the command line: what test_mcap.py has it read and write.
//   node mcap_peer.mjs TREE indexed FILE   all of it, found through the summary
//   node mcap_peer.mjs TREE streamed FILE  from the beginning, as far as it goes
//   node mcap_peer.mjs TREE write FILE     messages from stdin, [channel, time, text] each; {chunked, indented}
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const [tree, verb, path] = process.argv.slice(2);
const { McapIndexedReader, McapStreamReader, McapWriter } = createRequire(tree + "/")("@mcap/core");
const print = (value) =>
  console.log(JSON.stringify(value, (_, part) => (typeof part === "bigint" ? String(part)
    : part instanceof Map ? Object.fromEntries(part) : part)));
const text = (bytes) => new TextDecoder("utf-8", { fatal: true }).decode(bytes);
const shown = (message) =>
  [message.channelId, message.logTime, message.publishTime, message.sequence, text(message.data)];

async function indexed() {
  const bytes = readFileSync(path);
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
    },
  });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(shown(message));
  const metadata = [];
  for await (const record of reader.readMetadata()) metadata.push([record.name, record.metadata]);
  print({
    header: reader.header, statistics: reader.statistics, chunks: reader.chunkIndexes.length, metadata, messages,
    channels: [...reader.channelsById.values()],
    schemas: [...reader.schemasById.values()].map(({ id, name, encoding, data }) => ({ id, name, encoding, data: text(data) })),
  });
}

function streamed() {
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(readFileSync(path));
  const messages = [];
  for (let record; (record = reader.nextRecord()); ) if (record.type === "Message") messages.push(shown(record));
  print({ messages, done: reader.done() });
}

async function write() {
  const { chunked, indented, messages } = JSON.parse(readFileSync(0, "utf8"));
  const pieces = [];
  let size = 0n;
  const writer = new McapWriter({
    writable: { position: () => size, write: async (piece) => { pieces.push(Buffer.from(piece)); size += BigInt(piece.length); } },
    useChunks: chunked, chunkSize: 500,
  });
  await writer.start({ profile: "", library: "test" });
  const encode = (value) => new TextEncoder().encode(value);
  const schemaId = await writer.registerSchema({ name: "ocm.CanFrame", encoding: "jsonschema", data: encode("{}") });
  const channels = new Map();
  for (const [topic, time, message] of messages) {
    if (!channels.has(topic))
      channels.set(topic, await writer.registerChannel({ schemaId, topic, messageEncoding: "json", metadata: new Map() }));
    await writer.addMessage({
      channelId: channels.get(topic), sequence: 0, logTime: BigInt(time), publishTime: BigInt(time),
      data: encode(indented ? JSON.stringify(message, null, 2) : JSON.stringify(message)),
    });
  }
  await writer.addAttachment({ name: "a", logTime: 0n, createTime: 0n, mediaType: "", data: encode("x".repeat(100)) });
  await writer.end();
  writeFileSync(path, Buffer.concat(pieces));
}

await { indexed, streamed, write }[verb]();
