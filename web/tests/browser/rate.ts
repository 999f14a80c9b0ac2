import { cpus, loadavg } from 'node:os';
import type { Page } from 'playwright-core';
import { expect } from 'vitest';

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

/** Whether so much else runs that times say nothing of the page. */
export function machineIsBusy(): boolean {
  return loadavg()[0]! > 2.5 * cpus().length;
}

/** Not judged on a machine that is busy with other work; it says so then. */
export function expectSixtyHertz(rate: Rate): void {
  const busy = machineIsBusy();
  console.log(
    `${rate.picturesPerSecond.toFixed(1)} pictures a second, median interval ${rate.medianInterval_ms.toFixed(1)} ms, ` +
      `${rate.work_ms.toFixed(1)} ms of work each` +
      (busy ? '; the machine is busy with other work, so this is not judged' : ''),
  );
  if (busy) return;
  expect(rate.medianInterval_ms).toBeLessThan(17.5);
  expect(rate.work_ms).toBeLessThan(1000 / 60);
}
