// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { findEnvelope, makeEnvelope, type Envelope } from '../../src/plots/envelope';
import { Raster, rgb } from '../../src/plots/raster';

function envelopeOf(time: number[], values: number[], from: number, to: number, columns: number): [number, number][] {
  const envelope = makeEnvelope(columns);
  findEnvelope(Float64Array.from(time), Float32Array.from(values), from, to, envelope);
  return [...envelope.low.keys()].map((column) => [envelope.low[column]!, envelope.high[column]!]);
}

/** An envelope of given columns, as of a line that crosses each once. */
function once(...columns: [number, number][]): Envelope {
  const low = Float32Array.from(columns, ([value]) => value);
  const high = Float32Array.from(columns, ([, value]) => value);
  return { low, high, travel: high.map((value, i) => Math.max(0, value - low[i]!)) };
}

const empty = [Infinity, -Infinity];

describe('the envelope of a line', () => {
  test('keeps the one spike among many points of a column', () => {
    const time = Array.from({ length: 1000 }, (_, i) => i / 1000);
    const values = time.map((_, i) => (i === 437 ? 5 : i === 912 ? -3 : 0));
    const columns = envelopeOf(time, values, 0, 1, 10);
    columns.forEach(([low, high], column) => {
      expect([low, high]).toEqual([column === 9 ? -3 : 0, column === 4 ? 5 : 0]);
    });
  });

  test('is a connected line where points are far apart', () => {
    expect(envelopeOf([0, 4], [0, 8], 0, 4, 4)).toEqual([
      [0, 2],
      [2, 4],
      [4, 6],
      [6, 8],
    ]);
  });

  test('begins and ends at the edges when the line goes on beyond them', () => {
    expect(envelopeOf([-1, 1, 3], [0, 2, 4], 0, 2, 2)).toEqual([
      [1, 2],
      [2, 3],
    ]);
  });

  test('is empty where there are no points and does not cross what is not a number', () => {
    expect(envelopeOf([], [], 0, 1, 2)).toEqual([empty, empty]);
    const [first, second, third] = envelopeOf([0, 0.5, 1.5, 2.2, 2.9], [1, 1, NaN, 2, 2], 0, 3, 3);
    expect([first, second, third]).toEqual([[1, 1], empty, [2, 2]]);
  });

  test('agrees with a line that is followed in small steps, whatever its points', () => {
    let seed = 7;
    const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647;
    let farthestOutside = 0;
    for (let round = 0; round < 50; ++round) {
      const time = Array.from({ length: 2 + Math.floor(40 * random()) }, () => 4 * random() - 1).sort((a, b) => a - b);
      const values = time.map(() => Math.fround(random()));
      const found = envelopeOf(time, values, 0, 2, 20);
      for (let i = 1; i < time.length; ++i) {
        for (let step = 0; step <= 100; ++step) {
          const at = time[i - 1]! + (step / 100) * (time[i]! - time[i - 1]!);
          const value = values[i - 1]! + (step / 100) * (values[i]! - values[i - 1]!);
          if (at < 0 || at >= 2) continue;
          const [low, high] = found[Math.floor(10 * at + 1e-12)]!;
          farthestOutside = Math.max(farthestOutside, low - value, value - high);
        }
      }
    }
    expect(farthestOutside).toBeLessThan(1e-3);
  });
});

describe('pixels', () => {
  const red = rgb('#c22f2f');
  const alphas = (raster: Raster, x: number): number[] =>
    Array.from({ length: raster.height }, (_, y) => raster.bytes[4 * (y * raster.width + x) + 3]!);

  function drawn(low: number, high: number): number[] {
    const raster = new Raster(1, 10);
    raster.draw(once([low, high]), 0, 10, 1, red);
    return alphas(raster, 0);
  }

  test('are full where a line covers them and in part at its ends', () => {
    expect(drawn(4.5, 6.5)).toEqual([0, 0, 0, 255, 255, 255, 0, 0, 0, 0]);
    expect(drawn(5, 5)).toEqual([0, 0, 0, 0, 127, 127, 0, 0, 0, 0].map((value) => value && 128));
    expect(drawn(5.25, 5.25)).toEqual([0, 0, 0, 0, 191, 64, 0, 0, 0, 0]);
  });

  test('have the colour of the line, and none where it is not', () => {
    expect(red).toEqual([0xc2, 0x2f, 0x2f]);
    const raster = new Raster(2, 1);
    raster.draw(once([0, 1], [Infinity, -Infinity]), 0, 1, 1, red);
    expect([...raster.bytes]).toEqual([...red, 255, 0, 0, 0, 0]);
    raster.clear();
    expect([...raster.bytes].every((byte) => byte === 0)).toBe(true);
  });

  test('stay within the picture when a line leaves it', () => {
    expect(drawn(-5, 20)).toEqual(new Array(10).fill(255));
    expect(drawn(12, 20)).toEqual(new Array(10).fill(0));
    expect(drawn(-1.7, -1.3)).toEqual(new Array(10).fill(0));
    expect(drawn(-9, -5)).toEqual(new Array(10).fill(0));
  });

  test('are fainter where a line goes up and down many times, and show what is beneath', () => {
    const raster = new Raster(1, 10);
    const often = makeEnvelope(1);
    findEnvelope(Float64Array.of(0, 0.2, 0.4, 0.6, 0.8), Float32Array.of(2, 8, 2, 8, 2), 0, 1, often);
    expect([often.low[0], often.high[0], often.travel[0]]).toEqual([2, 8, 24]);
    raster.draw(once([5, 5]), 0, 10, 2, [0, 0, 0]);
    raster.draw(often, 0, 10, 2, [255, 0, 0]);
    expect(alphas(raster, 0)).toEqual([0, 102, 102, 102, 255, 255, 102, 102, 102, 0]);
    expect([...raster.bytes.slice(16, 20)]).toEqual([102, 0, 0, 255]);
  });

  test('are as many beside a steep line as above a flat one', () => {
    const raster = new Raster(5, 10);
    raster.draw(once([0, 0], [0, 0], [0, 10], [10, 10], [10, 10]), 0, 10, 3, red);
    expect([0, 1, 2, 3, 4].map((x) => alphas(raster, x)[4])).toEqual([0, 255, 255, 255, 0]);
  });

  test('show through the end of a line above', () => {
    const raster = new Raster(1, 1);
    raster.draw(once([0.5, 0.5]), 0, 1, 1, [0, 0, 0]);
    raster.draw(once([0, 0]), 0, 1, 1, [200, 100, 0]);
    expect([...raster.bytes]).toEqual([100, 50, 0, 255]);
  });
});
