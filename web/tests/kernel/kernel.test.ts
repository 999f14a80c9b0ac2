// SPDX-License-Identifier: Apache-2.0
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { column, Kernel, results, rowLength, signals, verdicts, type Side } from '../../kernel/kernel';
import { settingsOf, type Setting } from '../../kernel/settings';

const code = resolve('../build/web-kernel/tactus.wasm');
const native = resolve(process.env.TACTUS_TRACES ?? '../build/release/bin/web_kernel_traces');
const experiment = settingsOf(readFileSync('../experiments/tapping.toml', 'utf8'));

async function load(settings: readonly Setting[]): Promise<Kernel> {
  const kernel = await Kernel.load(readFileSync(code));
  for (const side of [0, 1] as const) for (const [key, value] of settings) kernel.set(side, key, value);
  return kernel;
}

beforeAll(() => {
  if (!existsSync(code)) throw new Error(`${code} is missing: web/kernel/build makes it`);
});

/** How the verdict on the scripted tap ends, and whether it rang before. */
function tap(kernel: Kernel, side: Side): { rang: boolean; settled: boolean } {
  kernel.tap();
  const seen = new Set<string>();
  for (let i = 0; i < 5; ++i) {
    const rows = kernel.step(1000);
    for (let row = 0; row < rows.length; row += rowLength) seen.add(verdicts[rows[row + column(side, 'verdict')]!]!);
  }
  return { rang: seen.has('rings'), settled: seen.has('settled') };
}

describe('the loops in WebAssembly', () => {
  it('ring at a high force gain without cancellation, and settle with it', async () => {
    const kernel = await load([...experiment, ['control.force_gain', 8]]);
    kernel.set(0, 'control.cancellation', 'off');
    kernel.apply();
    expect(tap(kernel, 0)).toEqual({ rang: true, settled: false });
    expect(tap(kernel, 1)).toEqual({ rang: false, settled: true });
  });

  it('continue where they are when a key changes', async () => {
    const kernel = await load(experiment);
    kernel.restart();
    kernel.aim(0.002);
    const before = kernel.step(1000).at(-rowLength + column(0, 'leader_m'))!;
    expect(before).toBeGreaterThan(0.0005);
    kernel.set(0, 'control.force_gain', 3);
    kernel.apply();
    const after = kernel.step(1)[column(0, 'leader_m')]!;
    expect(Math.abs(after - before)).toBeLessThan(5e-5);
  });

  it('give the same bits for the same keys', async () => {
    const [one, other] = await Promise.all([load(experiment), load(experiment)]);
    for (const kernel of [one, other]) kernel.tap();
    expect(one.step(1000)).toEqual(other.step(1000));
  });

  it.each([
    ['control.force_gian', 3, /force_gain/],
    ['control.force_gain', -1, /force_gain/],
    ['control.cancellation', 'perhaps', /cancellation/],
  ] as const)('refuse %s = %s with a sentence that names the key', async (key, value, message) => {
    const kernel = await load(experiment);
    expect(() => kernel.set(0, key, value)).toThrow(message);
  });
});

/** A whole run of the native build. */
function runNatively(settings: readonly Setting[]): Float64Array {
  const folder = mkdtempSync(join(tmpdir(), 'tactus-'));
  try {
    writeFileSync(join(folder, 'settings'), settings.map(([key, value]) => `${key}=${value}\n`).join(''));
    const run = spawnSync(native, [join(folder, 'settings'), join(folder, 'traces')], { encoding: 'utf8' });
    if (run.status !== 0) throw new Error(`${native} failed: ${run.error?.message ?? run.stderr}`);
    const bytes = readFileSync(join(folder, 'traces'));
    return new Float64Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Shown at the end: what a reader of this test wants to know. */
const summary: string[] = [];
afterAll(() => console.log(summary.join('\n')));

describe('a whole run of experiments/tapping.toml', () => {
  it('agrees with the native build', { timeout: 120_000 }, async () => {
    if (!existsSync(native)) throw new Error(`${native} is missing: cmake --build --preset release --target web_kernel_traces`);
    const expected = runNatively(experiment);
    const kernel = await load(experiment);
    const taps = kernel.taps();
    expect(taps).toBe(expected[0]);
    const largest = new Float64Array(signals.length);
    let equal = 0;
    let all = 0;
    let at = 1;
    for (let tap = 0; tap < taps; ++tap) {
      const { result, trace } = kernel.runTap(tap);
      const rows = expected[at]!;
      expect(trace.length / signals.length).toBe(rows);
      const nativeResult = expected.subarray(at + 1, at + 1 + results.length);
      const nativeTrace = expected.subarray(at + 1 + results.length, at + 1 + results.length + rows * signals.length);
      at += 1 + results.length + rows * signals.length;
      for (const name of ['contacts', 'settled', 'settling_s'] as const) {
        expect(result[results.indexOf(name)], `${name} of tap ${tap}`).toBe(nativeResult[results.indexOf(name)]);
      }
      for (let i = 0; i < trace.length; ++i) {
        const difference = Math.abs(trace[i]! - nativeTrace[i]!);
        if (difference === 0) ++equal;
        ++all;
        const signal = i % signals.length;
        if (!(difference <= largest[signal]!)) largest[signal] = difference;
      }
    }
    summary.push(`${taps} taps, ${all} numbers, ${((100 * equal) / all).toFixed(2)} % equal bit for bit; the largest differences:`);
    signals.forEach((name, i) => summary.push(`  ${name}: ${largest[i]!.toExponential(2)}`));
    // The C libraries' sine, cosine, tangent and their like differ in the last bit. Measured: 2e-13 m and 1.1e-8 N.
    for (const [i, name] of signals.entries()) {
      expect(largest[i], name).toBeLessThanOrEqual(name.endsWith('_m') ? 1e-12 : 1e-7);
    }
  });
});
