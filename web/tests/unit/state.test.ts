// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { signalNames, type Block } from '../../src/protocol/messages';
import { before_s, closeUpTime_ms, ContactCapture } from '../../src/state/contact';
import { Loop, signalIndex } from '../../src/state/loop';
import { SlidingSeries } from '../../src/state/series';
import { linkOf, valuesOf } from '../../src/state/link';
import { describedParameters } from '../../src/state/parameters';
import { gripSentence } from '../../src/state/grip';
import { clips, judgement } from '../../src/state/verdict';

describe('a sliding series', () => {
  test('holds the last rows in order, whatever their number', () => {
    const series = new SlidingSeries(7, 2);
    for (let i = 0; i < 100; ++i) {
      series.add(i);
      series.set(0, 2 * i);
      series.set(1, -i);
      const kept = Array.from({ length: Math.min(7, i + 1) }, (_, k) => i - Math.min(6, i) + k);
      const [time, first, second] = series.views();
      expect([...time]).toEqual(kept);
      expect([...first!]).toEqual(kept.map((value) => 2 * value));
      expect([...second!]).toEqual(kept.map((value) => -value));
    }
  });

  test('tells extremes since a time, and an empty range where there is nothing', () => {
    const series = new SlidingSeries(10, 1);
    [5, -3, NaN, 2, 1].forEach((value, i) => {
      series.add(i);
      series.set(0, value);
    });
    expect(series.extremes(0, 2)).toEqual([1, 2]); // what is not a number does not count
    expect(series.extremes(0, 0)).toEqual([-3, 5]);
    expect(series.extremes(0, 9)).toEqual([Infinity, -Infinity]);
  });
});

function block(start_s: number, value: number, columns = 10): Block {
  const low = Object.fromEntries(signalNames.map((name) => [name, new Float32Array(columns).fill(value)]));
  const high = Object.fromEntries(signalNames.map((name) => [name, new Float32Array(columns).fill(value + 1)]));
  return { start_s, column_s: 0.002, columns, low, high } as unknown as Block;
}

describe('a loop', () => {
  test('keeps least and greatest value of each column as two rows in order of time, lengths in mm', () => {
    const loop = new Loop();
    loop.addBlock(block(1, 0.5));
    const [time, ...signals] = loop.trace.views();
    expect(time.length).toBe(20);
    expect([...time]).toEqual([...time].sort((a, b) => a - b));
    expect(signals[signalIndex('slave_force_n')]!.slice(0, 2)).toEqual(Float32Array.of(0.5, 1.5));
    expect(signals[signalIndex('master_position_m')]![0]).toBeCloseTo(500, 3);
  });

  test('notes where blocks are missing, and how much', () => {
    const loop = new Loop();
    loop.addBlock(block(0, 0));
    loop.addBlock(block(0.02, 0));
    expect(loop.missingPieces).toBe(0);
    loop.addBlock(block(0.1, 0));
    const [time, first] = loop.trace.views();
    expect(time.length).toBe(61);
    expect(time[40]).toBeCloseTo(0.04, 12);
    expect([...first!.keys()].filter((row) => Number.isNaN(first![row]))).toEqual([40]);
    expect(loop.missing_s).toBeCloseTo(0.06, 12);
    expect(loop.missingPieces).toBe(1);
  });

  test('begins anew when its time does', () => {
    const loop = new Loop();
    loop.addBlock(block(5, 0));
    loop.addBlock(block(0, 0));
    expect(loop.trace.length).toBe(20);
    expect(loop.missingPieces).toBe(0);
  });
});

describe('the close-up of a contact', () => {
  function force(from_s: number, to_s: number, value: (time_s: number) => number): SlidingSeries {
    const series = new SlidingSeries(8192, 1);
    for (let time_s = from_s; time_s < to_s; time_s += 2e-4) {
      series.add(time_s);
      series.set(0, value(time_s));
    }
    return series;
  }

  test('begins before the first touch and ends a quarter of a second after it', () => {
    const capture = new ContactCapture();
    capture.watch(10, 0.5);
    capture.collect(force(9.5, 10.6, (time_s) => time_s));
    expect(capture.force_N[0]).toBeCloseTo(10 - before_s, 3);
    const touch = closeUpTime_ms.findIndex((time) => Math.abs(time) < 1e-6);
    expect(capture.force_N[touch]).toBeCloseTo(10, 3);
    expect(capture.force_N.at(-1)).toBeCloseTo(10.25, 2);
  });

  test('grows with the pieces that arrive, and equals what one piece gives', () => {
    const whole = new ContactCapture();
    const pieces = new ContactCapture();
    const value = (time_s: number) => Math.sin(300 * time_s);
    whole.watch(3, 1);
    pieces.watch(3, 1);
    whole.collect(force(2, 3.5, value));
    for (let until_s = 2.9; until_s < 3.5; until_s += 0.017) pieces.collect(force(2, until_s, value));
    expect(pieces.force_N).toEqual(whole.force_N);
  });

  test('counts bounces as one contact and a touch after a pause as the next', () => {
    const capture = new ContactCapture();
    const force = new SlidingSeries(10, 1);
    force.add(0);
    force.set(0, 1);
    capture.watch(0, 1);
    capture.collect(force);
    const kept = [0.1, 0.25, 1].map((time_s) => {
      capture.watch(time_s, 1);
      return !Number.isNaN(capture.force_N[0]);
    });
    expect(kept).toEqual([true, true, false]);
  });
});

describe('the verdict', () => {
  type Word = 'free' | 'contact' | 'settled' | 'rings' | 'stopped';
  const say = (verdict: Word, onHand_N = 0, connected = true, atWall_N = 0) =>
    judgement(
      { verdict, cause: 'the command was not finite', advice: 'Tap faster.' },
      { onHand_N, atWall_N },
      connected,
    );

  test('never calls a handle free that pushes the hand', () => {
    expect(say('free', 0.05).verdict).toBe('free');
    expect(say('free', 1.4).verdict).toBe('moving');
    expect(say('free', 1.4, true, 0.3).verdict).toBe('contact');
    expect(say('settled', 1.4).verdict).toBe('settled');
  });

  test('ends with the connection', () => {
    for (const word of ['free', 'contact', 'settled', 'rings', 'stopped'] as const) {
      expect(say(word, 0, false)).toMatchObject({ verdict: 'unknown', measured: '' });
    }
  });

  test('says why, and what to try', () => {
    expect(say('stopped').sentence).toContain('The command was not finite.');
    expect(say('settled').measured).toContain('Tap faster.');
    expect(say('free').measured).toBe('');
  });

  test('knows when the motor displays all that it may', () => {
    expect([clips(1, 1), clips(0.9, 1), clips(5, 0)]).toEqual([true, false, false]);
  });
});

describe('a link', () => {
  const described = describedParameters({
    name: '',
    capabilities: [],
    metadata: {
      'tactus.parameters': JSON.stringify([
        { name: 'control.force_gain', kind: 'number', minimum: 0, maximum: 30, initial: 10 },
        { name: 'left.method', kind: 'choice', choices: ['none', 'cancellation'], initial: 'cancellation' },
        { name: 'side_by_side', kind: 'flag', initial: true },
      ]),
    },
  });

  test('says what differs from what the server began with, and gives it back', () => {
    const values = new Map<string, number | string | boolean>([
      ['control.force_gain', 3.5],
      ['left.method', 'none'],
      ['side_by_side', true],
    ]);
    expect(linkOf(described, values)).toBe('#control.force_gain=3.5&left.method=none');
    values.delete('side_by_side');
    expect(valuesOf(linkOf(described, values), described)).toEqual(values);
  });

  test('is empty where nothing differs, and nonsense in it asks for nothing', () => {
    const initial = new Map(described.map(({ name, initial }) => [name, initial!]));
    expect(linkOf(described, initial)).toBe('');
    expect(valuesOf('#control.force_gain=much&side_by_side=7&nothing=1&left.method=&%', described).size).toBe(0);
  });
});

describe('the grip', () => {
  test('is told with how sure it is', () => {
    expect(gripSentence(0.52, 0.094)).toBe('Your grip: ×0.5 ± 0.09 as firm as identified.');
    expect(gripSentence(4.13, 0.31)).toBe('Your grip: ×4.1 ± 0.3 as firm as identified.');
  });
  test('is not told before it is known, nor where nothing estimates it', () => {
    expect(gripSentence(1, 2)).toBe('Your grip: not known yet; it shows when the wall pushes back.');
    expect(gripSentence(1, 0)).toBe('');
    expect(gripSentence(0, 0)).toBe('');
  });
});
