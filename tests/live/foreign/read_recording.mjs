// SPDX-License-Identifier: Apache-2.0
// node read_recording.mjs RECORDED LOGGED: what mcap-record wrote of `tactus serve` against our own log of the same run,
// both read by the reader of the MCAP project and decoded by that of Foxglove.
import assert from "node:assert/strict";
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

async function contents(path) {
  const file = await open(path);
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
  const topics = new Map();
  const decoders = new Map();
  for await (const message of log.readMessages()) {
    const channel = log.channelsById.get(message.channelId);
    if (!decoders.has(channel.id)) {
      const schema = log.schemasById.get(channel.schemaId);
      assert.equal(schema.encoding, "ros2msg");
      assert.equal(channel.messageEncoding, "cdr");
      decoders.set(channel.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
    }
    if (!topics.has(channel.topic)) topics.set(channel.topic, []);
    topics.get(channel.topic).push(decoders.get(channel.id).readMessage(message.data));
  }
  await file.close();
  return topics;
}

const [recorded, logged] = [await contents(process.argv[2]), await contents(process.argv[3])];
let compared = 0;
for (const side of ["left", "right"]) {
  const records = new Map(logged.get(`/${side}/teleoperator`).map((record) => [record.time_s, record]));
  const seen = recorded.get(`/${side}/teleoperator`);
  assert.ok(seen.length > 500, `only ${seen.length} records of ${side}`);
  for (const record of seen) {
    assert.deepEqual({ ...record }, { ...records.get(record.time_s) });
    ++compared;
  }
  // Every tick from the first that was recorded to the last: none is missing.
  const period = seen[1].time_s - seen[0].time_s;
  const span = Math.round((seen.at(-1).time_s - seen[0].time_s) / period) + 1;
  assert.equal(seen.length, span);

  const blocks = recorded.get(`/${side}/block`);
  assert.ok(blocks.length > 5);
  for (const block of blocks) {
    const columns = block.master_position_m_min.length;
    const ticks = Math.round(block.column_s / period);
    const times = [...records.keys()];
    const first = times.findIndex((time) => Math.abs(time - block.start_s) < 0.5 * period);
    for (let column = 0; column < columns; ++column) {
      const forces = times
        .slice(first + column * ticks, first + (column + 1) * ticks)
        .map((time) => records.get(time).contact_force_n);
      if (forces.length < ticks) continue;
      assert.equal(block.slave_force_n_min[column], Math.fround(Math.min(...forces)));
      assert.equal(block.slave_force_n_max[column], Math.fround(Math.max(...forces)));
    }
  }
  const states = recorded.get(`/${side}/state`);
  assert.ok(states.length > 5);
  for (const state of states) {
    assert.ok(["free", "contact", "settled", "rings", "stopped"].includes(state.verdict));
    assert.equal(records.get(state.time_s).master_position_m, state.master_position_m);
  }
}
console.log(`${compared} records, equal to our log`);
