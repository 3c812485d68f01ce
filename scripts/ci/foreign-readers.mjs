// SPDX-License-Identifier: MIT
// foreign-readers.mjs <recording.mcap> <messages>: reads a recording with npm's @mcap/core, by its indexes and as
// a stream, and holds the number of its messages against the other readers'.
import { readFile, open } from "node:fs/promises";
import { createRequire } from "node:module";

const [, , path, messages] = process.argv;
const require = createRequire(`${process.cwd()}/`);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const fzstd = require("fzstd");
const decompressHandlers = { zstd: (packed) => fzstd.decompress(packed) };

class FileReadable {
  constructor(handle) {
    this.handle = handle;
  }
  async size() {
    return BigInt((await this.handle.stat()).size);
  }
  async read(offset, length) {
    const buffer = new Uint8Array(Number(length));
    await this.handle.read(buffer, 0, buffer.length, Number(offset));
    return buffer;
  }
}

function same(what, one, other) {
  if (one !== other) throw new Error(`${what}: ${one} and ${other}`);
}

const handle = await open(path);
const reader = await McapIndexedReader.Initialize({
  readable: new FileReadable(handle),
  decompressHandlers,
});
let indexed = 0;
let last = 0n;
for await (const message of reader.readMessages()) {
  if (message.logTime < last) throw new Error("not in the order of time");
  last = message.logTime;
  ++indexed;
}
await handle.close();
same("by the indexes", indexed, Number(messages));
same("statistics", Number(reader.statistics.messageCount), Number(messages));

const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
stream.append(await readFile(path));
let streamed = 0;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Message") ++streamed;
}
same("as a stream", streamed, Number(messages));
if (!stream.done()) throw new Error("the stream does not end");
console.log(`${path.split("/").pop()}: ${indexed} messages by @mcap/core`);
