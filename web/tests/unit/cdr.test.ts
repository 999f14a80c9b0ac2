// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { cdrDecoder, CdrError } from '../../src/protocol/cdr';
import { parseRos2msg } from '../../src/protocol/ros2msg';
import { blockMessage, schemas, stateMessage } from '../mock/messages';
import { MockLoop } from '../mock/loop';
import { toBlock, toLoopState } from '../../src/protocol/messages';

function decode(definition: string, bytes: number[]) {
  return cdrDecoder(parseRos2msg('a/B', definition))(new DataView(Uint8Array.from(bytes).buffer));
}

const little = [0, 1, 0, 0];

describe('CDR by hand, from the specification', () => {
  test('aligns each value to its size, counted after the header', () => {
    const bytes = [...little, 1, 0, 0, 0, 0x78, 0x56, 0x34, 0x12, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f];
    expect(decode('bool a\nuint32 b\nfloat64 c', bytes)).toEqual({ a: true, b: 0x12345678, c: 1 });
  });

  test('reads a string with its closing zero and goes on at the right place', () => {
    const bytes = [...little, 3, 0, 0, 0, 0x68, 0x69, 0, 0xff, 0xfe, 0xff];
    expect(decode('string a\nuint8 b\nint16 c', bytes)).toEqual({ a: 'hi', b: 255, c: -2 });
  });

  test('reads big-endian messages', () => {
    expect(decode('int32 a', [0, 0, 0, 0, 0xff, 0xff, 0xff, 0xfe])).toEqual({ a: -2 });
  });

  test('reads sequences of numbers as typed arrays, and empty ones without any alignment', () => {
    const bytes = [...little, 2, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0, 9];
    const message = decode('float32[] a\nfloat64[] b\nuint8 c', bytes);
    expect(message.a).toEqual(Float32Array.of(1, -2));
    expect(message).toMatchObject({ b: new Float64Array(0), c: 9 });
  });

  test('reads arrays of messages', () => {
    const bytes = [...little, 2, 0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0];
    const text = 'P[] p\n===\nMSG: a/P\nuint16 x\nuint16 y\n';
    expect(decode(text, bytes)).toEqual({ p: [{ x: 1, y: 2 }, { x: 3, y: 4 }] });
  });

  test('refuses a length that the message cannot hold, without allocating it', () => {
    expect(() => decode('float64[] a', [...little, 0xff, 0xff, 0xff, 0xff])).toThrow(CdrError);
    expect(() => decode('string[] a', [...little, 0xff, 0xff, 0xff, 0x7f])).toThrow(CdrError);
  });

  test('refuses what is not plain CDR', () => {
    expect(() => decode('bool a', [0, 7, 0, 0, 1])).toThrow(CdrError);
    expect(() => decode('bool a', [0, 1])).toThrow(CdrError);
  });
});

describe('the messages of a loop', () => {
  const loop = new MockLoop({ method: 'none', forceGain: 10 });
  const rows = Array.from({ length: 40 }, () => loop.tick(0.011));

  test('come back as they were written', () => {
    const { name, text } = schemas.block;
    const block = toBlock(cdrDecoder(parseRos2msg(name, text))(new DataView(blockMessage(1.5, 10, rows).buffer)));
    expect(block).toMatchObject({ start_s: 1.5, columns: 4 });
    expect(block.column_s).toBeCloseTo(0.002, 12);
    const second = rows.slice(10, 20).map((row) => row.slaveForce_N);
    expect(block.low.slave_force_n[1]).toBeCloseTo(Math.min(...second), 5);
    expect(block.high.slave_force_n[1]).toBeCloseTo(Math.max(...second), 5);
  });

  test('cut at any byte are refused by name, never misread', () => {
    const { name, text } = schemas.state;
    const decodeState = cdrDecoder(parseRos2msg(name, text));
    const whole = stateMessage(2, 0.001, loop, rows[0]!, 5);
    for (let size = 0; size < whole.length; ++size) {
      expect(() => decodeState(new DataView(whole.slice(0, size).buffer))).toThrow(CdrError);
    }
    expect(toLoopState(decodeState(new DataView(whole.buffer)))).toMatchObject({ time_s: 2, dropped: 5 });
  });
});
