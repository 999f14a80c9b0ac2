// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { cdrDecoder, CdrError, type Message } from '../../src/protocol/cdr';
import { toBlock, toHandForce, toLoopState } from '../../src/protocol/messages';
import { parseRos2msg } from '../../src/protocol/ros2msg';
import { CdrWriter } from '../mock/cdr_writer';
import { MockLoop } from '../mock/loop';
import { blockMessage, handForceMessage, schemas, stateMessage } from '../mock/messages';

/** Whole numbers below a bound, the same ones each time (Numerical Recipes' generator). */
function numbersFrom(seed: number): (bound: number) => number {
  let state = seed >>> 0;
  return (bound) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * bound);
  };
}

const loop = new MockLoop({ method: 'none', forceGain: 10 });
const rows = Array.from({ length: 40 }, () => loop.tick(0.011));
const nested = 'P[] p\nstring[] s\nuint8[4] u\nint64 i\n===\nMSG: a/P\nstring name\nfloat32[] x\nbool[] b\n';
const samples: readonly (readonly [string, string, Uint8Array, (message: Message) => unknown])[] = [
  ['a block', schemas.block.text, blockMessage(1.5, 10, rows), toBlock],
  ['forces of the hand', schemas.hand_force.text, handForceMessage(1.5, rows), toHandForce],
  ['a state', schemas.state.text, stateMessage(2, 0.001, loop, rows[0]!, 5), toLoopState],
  [
    'a nested message',
    nested,
    // One P with name, x and b; two texts; four bytes as one number; one whole number.
    new CdrWriter().uint32(1).string('ab').float32s([1, 2]).uint32(0).uint32(2).string('c').string('').uint32(7).uint64(9).finish(),
    (message) => message,
  ],
];

describe('bytes that are cut, changed, doubled or strange', () => {
  test.each(samples)('of %s are decoded or refused as CDR, and never hold anything up', (_name, text, whole, use) => {
    const decode = cdrDecoder(parseRos2msg('a/B', text));
    expect(() => use(decode(new DataView(whole.slice().buffer)))).not.toThrow();
    const below = numbersFrom(7);
    let refused = 0;
    const rounds = 5_000;
    for (let round = 0; round < rounds; ++round) {
      let bytes = whole.slice(0, below(4) === 0 ? below(whole.length + 1) : whole.length);
      for (let changes = below(6); changes > 0 && bytes.length > 0; --changes) {
        const at = below(bytes.length);
        const kind = below(3);
        if (kind === 0) bytes[at] = below(256);
        else if (kind === 1) bytes.fill(255, at, at + 4);
        else bytes = Uint8Array.from([...bytes.subarray(0, at), ...bytes.subarray(at - below(at + 1))]);
      }
      try {
        use(decode(new DataView(bytes.buffer)));
      } catch (error) {
        expect(error, `round ${round}`).toBeInstanceOf(CdrError);
        expect((error as Error).message).not.toBe('');
        ++refused;
      }
    }
    // Both happen: else nothing was tried.
    expect(refused).toBeGreaterThan(0.05 * rounds);
    expect(refused).toBeLessThan(0.95 * rounds);
  });
});
