// SPDX-License-Identifier: Apache-2.0
import { cpus, loadavg } from 'node:os';
import type { Page } from 'playwright-core';
import { expect, type TestContext } from 'vitest';

/** What the page costs while everything moves. */
export interface Rate {
  readonly medianInterval_ms: number;
  readonly picturesPerSecond: number;
  /** Processor time of the page's process for one picture: scripts, style, layout, drawing. */
  readonly work_ms: number;
}

/** Watches the pictures of a page for some seconds. */
export async function measureRate(page: Page, seconds: number): Promise<Rate> {
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const processorTime = async (): Promise<number> => {
    const { metrics } = await session.send('Performance.getMetrics');
    return metrics.find(({ name }) => name === 'ProcessTime')!.value;
  };
  const before_s = await processorTime();
  const intervals = await page.evaluate(
    (length_ms) =>
      new Promise<number[]>((resolve) => {
        const seen: number[] = [];
        const begin = performance.now();
        let last = begin;
        const frame = (now: number): void => {
          seen.push(now - last);
          last = now;
          if (now - begin < length_ms) requestAnimationFrame(frame);
          else resolve(seen.slice(1));
        };
        requestAnimationFrame(frame);
      }),
    1000 * seconds,
  );
  const work_ms = (1000 * ((await processorTime()) - before_s)) / intervals.length;
  const sorted = [...intervals].sort((a, b) => a - b);
  return {
    medianInterval_ms: sorted[Math.floor(sorted.length / 2)]!,
    picturesPerSecond: intervals.length / seconds,
    work_ms,
  };
}

/** Why times say nothing of the page here and now, or an empty text where they do. */
export function excuse(): string {
  if (!process.env.TACTUS_JUDGE_TIMES) return 'TACTUS_JUDGE_TIMES=1 does not say that this machine has nothing else to do';
  const [load, cores] = [loadavg()[0]!, cpus().length];
  return load > cores ? `the load is ${load.toFixed(1)} on ${cores} cores` : '';
}

/**
 * Judges what was measured against its bound. What is within counts, whatever else runs. What is beyond fails the test,
 * but where the machine is not said to be quiet, or is not, the test is skipped and says why.
 */
export function judge(context: TestContext, what: string, measured: number, bound: number): void {
  const finding = `${what}: ${measured.toFixed(1)}, bound ${bound.toFixed(1)}`;
  console.log(finding);
  const why = excuse();
  if (measured >= bound && why !== '') context.skip(`not judged, as ${why}; ${finding}`);
  expect(measured, finding).toBeLessThan(bound);
}

export function judgeSixtyHertz(context: TestContext, rate: Rate): void {
  console.log(`${rate.picturesPerSecond.toFixed(1)} pictures a second`);
  judge(context, 'median ms between pictures', rate.medianInterval_ms, 17.5);
  judge(context, 'ms of work for a picture', rate.work_ms, 1000 / 60);
}
