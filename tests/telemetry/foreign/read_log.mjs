// SPDX-License-Identifier: Apache-2.0
// node read_log.mjs LOG: the reader of the MCAP project and the decoder of Foxglove, neither of them ours, read every
// message of the sample log through its index and compare all with the formulas of ../sample.hpp.
import assert from "node:assert/strict";
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const file = await open(process.argv[2]);
const log = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(buffer, 0, buffer.length, Number(offset));
      assert.equal(bytesRead, buffer.length);
      return buffer;
    },
  },
  decompressHandlers: await loadDecompressHandlers(),
});
assert.equal(log.header.profile, "ros2");
assert.equal(log.statistics.messageCount, 30000n);

for await (const metadata of log.readMetadata({ name: "tactus" })) {
  assert.equal(metadata.metadata.get("configuration"), "[servo]\nrate_Hz = 5000\n");
}

const decoders = new Map();
const counts = new Map();
let before = 0n;
for await (const message of log.readMessages({ validateCrcs: true })) {
  const channel = log.channelsById.get(message.channelId);
  if (!decoders.has(channel.id)) {
    const schema = log.schemasById.get(channel.schemaId);
    assert.equal(schema.encoding, "ros2msg");
    assert.equal(schema.name, "tactus_msgs/msg/Sample");
    assert.equal(channel.messageEncoding, "cdr");
    const definition = new TextDecoder().decode(schema.data);
    decoders.set(channel.id, new MessageReader(parse(definition, { ros2: true })));
  }
  const value = decoders.get(channel.id).readMessage(message.data);
  const count = counts.get(channel.topic) ?? 0;
  counts.set(channel.topic, count + 1);
  const k = channel.topic === "/run_1/sample" ? count : 2 * count;
  assert.ok(message.logTime >= before);
  before = message.logTime;
  assert.equal(message.sequence, k);
  assert.equal(message.logTime, BigInt(k) * 1000000n);
  assert.deepEqual({ ...value }, { time_s: 0.001 * k, touched: k % 3 === 0, force_n: 0.5 * k - 100, count: BigInt(-k) });
}
assert.deepEqual(Object.fromEntries(counts), { "/run_1/sample": 20000, "/run_2/sample": 10000 });
await file.close();
console.log("@mcap/core read 30000 messages of 2 topics, all equal");
