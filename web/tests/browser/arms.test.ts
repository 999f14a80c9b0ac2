// SPDX-License-Identifier: Apache-2.0
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, test, vi } from 'vitest';
import { launch, open, parameter, type Watched } from './browser';
import { handleAtRest, placeOfHandle } from './moves';
import { demandProgram, leftOut, TactusServer } from './tactus';

/** Two pairs of arms behind the page, from `tactus serve experiments/arm-tapping.toml`. */
describe.skipIf(leftOut)('the page before two arms', () => {
  let browser: Browser | undefined;
  let server: TactusServer;
  let watched: Watched | undefined;
  let page: Page;

  const until = (check: () => Promise<void>) => vi.waitFor(check, { timeout: 20_000, interval: 25 });
  const verdict = (side: string) => page.getAttribute(`.loop[data-side=${side}]`, 'data-verdict');
  /** Pixels of the picture that are not the page behind it. */
  const painted = () =>
    page.$eval('[data-kind=arms] .loop[data-side=left] canvas', (canvas) => {
      const { width, height } = canvas as HTMLCanvasElement;
      const copy = Object.assign(document.createElement('canvas'), { width, height });
      const context = copy.getContext('2d')!;
      return new Promise<number>((done) =>
        requestAnimationFrame(() => {
          context.drawImage(canvas as HTMLCanvasElement, 0, 0);
          const { data } = context.getImageData(0, 0, width, height);
          let count = 0;
          for (let i = 3; i < data.length; i += 4) count += data[i]! > 0 ? 1 : 0;
          done(count / (width * height));
        }),
      );
    });

  beforeAll(async () => {
    demandProgram();
    browser = await launch();
  });
  afterAll(() => browser?.close());
  beforeEach(async () => {
    server = await TactusServer.start('../experiments/arm-tapping.toml', '--set', 'control.force_gain=8');
    watched = await open(browser!, server.url);
    page = watched.page;
    await page.waitForSelector('[data-kind=arms] .loop[data-side=left] canvas');
  });
  afterEach(async () => {
    await watched?.close();
    await server.stop();
    expect(watched?.complaints).toEqual([]);
    expect(watched?.foreign).toEqual([]);
  });

  test('draws both arms, and the same tap settles with cancellation and rings without', async () => {
    await page.click('#dismiss');
    await until(async () => expect(await painted()).toBeGreaterThan(0.01));
    await page.click('#tap');
    await until(async () => expect([await verdict('left'), await verdict('right')]).toEqual(['settled', 'rings']));
    if (process.env.ARM_PICTURE) await page.screenshot({ path: process.env.ARM_PICTURE });
  });

  test('a drag of the hand in the picture goes to the wall and across, and home when it is let go', async () => {
    await until(async () => expect(await painted()).toBeGreaterThan(0.01));
    const [x, y] = await handleAtRest(page);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 30, y - 40, { steps: 5 });
    await until(async () => {
      const [nowX, nowY] = await placeOfHandle(page);
      expect(nowX - x).toBeGreaterThan(10);
      expect(y - nowY).toBeGreaterThan(15);
    });
    await page.mouse.move(x, y + 30, { steps: 5 });
    await until(async () => expect(['contact', 'settled', 'rings']).toContain(await verdict('left')));
    await page.mouse.up();
    await until(async () => expect(Math.abs((await placeOfHandle(page))[0] - x)).toBeLessThan(4));
  });

  test('is worked by keys alone', async () => {
    await page.focus('#handle-left');
    await page.keyboard.press('End');
    await until(async () => expect(['settled', 'rings']).toContain(await verdict('left')));
    await until(async () =>
      expect(await page.getAttribute('#handle-left', 'aria-valuetext')).toContain('mm into the wall'),
    );
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Escape');
    await until(async () => expect(['free', 'moving']).toContain(await verdict('left')));
    expect(await page.isVisible('.of-arms')).toBe(true);
    expect(await page.isVisible('.of-axis')).toBe(false);
  });

  test('of 390 px it shows both pairs in one look, without scrolling sideways', async () => {
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForSelector('.loop[data-side=right]:not([hidden])');
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
    expect((await page.locator('#loops').boundingBox())!.height).toBeLessThanOrEqual(844);
    await until(async () => expect(await painted()).toBeGreaterThan(0.01));
    if (process.env.ARM_PHONE_PICTURE) {
      await page.click('#dismiss');
      await page.click('#tap');
      await until(async () => expect(await verdict('right')).toBe('rings'));
      await page.locator('#loops').scrollIntoViewIfNeeded();
      await page.screenshot({ path: process.env.ARM_PHONE_PICTURE });
    }
  });

  test('a change of method or gain goes on with the arms where they are', async () => {
    await page.selectOption(`${parameter('left.method')} select`, 'four-channel');
    await page.waitForSelector(`${parameter('left.method')}[data-value="four-channel"]`);
    await page.focus(`${parameter('control.force_gain')} input`);
    await page.keyboard.press('Home');
    await until(async () => expect(await page.getAttribute(parameter('control.force_gain'), 'data-value')).toBe('0'));
    expect(await verdict('left')).not.toBe('stopped');
  });
});
