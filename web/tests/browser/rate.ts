import type { Page } from 'playwright-core';
import { expect } from 'vitest';

/** What the page costs while everything moves. */
export interface Rate {
  readonly medianInterval_ms: number;
  readonly picturesPerSecond: number;
  /** Time of the page's own thread for one picture: scripts, style, layout and drawing commands. */
  readonly work_ms: number;
}

/** Watches the pictures of a page for some seconds. */
export async function measureRate(page: Page, seconds: number): Promise<Rate> {
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const taskTime = async (): Promise<number> => {
    const { metrics } = await session.send('Performance.getMetrics');
    return metrics.find(({ name }) => name === 'TaskDuration')!.value;
  };
  const before_s = await taskTime();
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
  const work_ms = (1000 * ((await taskTime()) - before_s)) / intervals.length;
  const sorted = [...intervals].sort((a, b) => a - b);
  return {
    medianInterval_ms: sorted[Math.floor(sorted.length / 2)]!,
    picturesPerSecond: intervals.length / seconds,
    work_ms,
  };
}

export function expectSixtyHertz(rate: Rate): void {
  console.log(
    `${rate.picturesPerSecond.toFixed(1)} pictures a second, median interval ${rate.medianInterval_ms.toFixed(1)} ms, ` +
      `${rate.work_ms.toFixed(1)} ms of work each`,
  );
  expect(rate.medianInterval_ms).toBeLessThan(17.5);
  expect(rate.work_ms).toBeLessThan(1000 / 60);
}
