// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { ForceVoice } from '../../src/sound/voice';

const rate_Hz = 48000;
const tick_s = 2e-4;
const block = 128;

/** Plays force that arrives in pieces of a sixtieth of a second, and returns the sound. */
function play(seconds: number, force: (time_s: number) => number, arrives = (_piece: number) => true) {
  const voice = new ForceVoice(rate_Hz);
  const sound: number[] = [];
  const delays: number[] = [];
  let ticks = 0;
  for (let piece = 0; piece < seconds * 60; ++piece) {
    const until = Math.round(((piece + 1) / 60) / tick_s);
    const values = Float32Array.from({ length: until - ticks }, (_, i) => force((ticks + i) * tick_s));
    ticks = until;
    if (arrives(piece)) voice.push(values, tick_s);
    const wanted = Math.round(((piece + 1) / 60) * rate_Hz);
    while (sound.length < wanted) {
      const samples = new Float32Array(block);
      voice.process(samples);
      sound.push(...samples);
    }
    delays.push(voice.delay_s);
  }
  return { sound, delays };
}

const loudness = (sound: number[]) => Math.sqrt(sound.reduce((sum, value) => sum + value * value, 0) / sound.length);

describe('the voice of a force', () => {
  test('keeps the pitch', () => {
    const { sound } = play(2, (time_s) => 0.5 * Math.sin(2 * Math.PI * 250 * time_s));
    const steady = sound.slice(rate_Hz, 2 * rate_Hz);
    const crossings = steady.filter((value, i) => i > 0 && steady[i - 1]! < 0 && value >= 0).length;
    expect(Math.abs(crossings - 250)).toBeLessThanOrEqual(3);
    // 0.5 N by 0.9 a newton, through tanh: the amplitude of the fundamental is just below 0.45.
    expect(loudness(steady) * Math.SQRT2).toBeGreaterThan(0.38);
    expect(loudness(steady) * Math.SQRT2).toBeLessThan(0.45);
  });

  test('is silent for a constant force, whatever its size', () => {
    const { sound } = play(2, () => 20);
    expect(loudness(sound.slice(rate_Hz))).toBeLessThan(1e-3);
  });

  test('never exceeds full scale', () => {
    const { sound } = play(1, (time_s) => (Math.floor(time_s * 80) % 2 === 0 ? 100 : -100));
    expect(Math.max(...sound.map(Math.abs))).toBeLessThanOrEqual(1);
  });

  test('fades out when force stops coming, without a click, and comes back', () => {
    const pause = (piece: number) => piece < 60 || piece >= 120;
    const { sound } = play(3, (time_s) => 0.5 * Math.sin(2 * Math.PI * 200 * time_s), pause);
    expect(loudness(sound.slice(1.5 * rate_Hz, 1.9 * rate_Hz))).toBe(0);
    expect(loudness(sound.slice(2.5 * rate_Hz))).toBeGreaterThan(0.2);
    const steps = sound.slice(1).map((value, i) => Math.abs(value - sound[i]!));
    expect(Math.max(...steps.slice(rate_Hz, 2 * rate_Hz))).toBeLessThan(0.05);
  });

  test('keeps its delay small although it arrives in bursts', () => {
    const { delays } = play(5, (time_s) => Math.sin(time_s));
    expect(Math.max(...delays.slice(60))).toBeLessThan(0.15);
    expect(Math.min(...delays.slice(60))).toBeGreaterThan(0.02);
  });

  test('bears values that are no numbers', () => {
    const { sound } = play(1, (time_s) => (time_s > 0.5 ? NaN : 1));
    expect(sound.every(Number.isFinite)).toBe(true);
  });
});
