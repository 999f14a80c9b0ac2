// SPDX-License-Identifier: Apache-2.0
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, test, vi } from 'vitest';
import { launch, open, parameter, switchMethod, type Watched } from './browser';
import { judge, judgeSixtyHertz, measureRate } from './rate';
import { demandProgram, leftOut, TactusServer } from './tactus';

/** What the live page promises, with the real loops behind it; read from the page itself. */
describe.skipIf(leftOut)('the page before tactus serve', () => {
  let browser: Browser | undefined;
  let server: TactusServer;
  let watched: Watched | undefined;
  let page: Page;

  const until = (check: () => Promise<void>) => vi.waitFor(check, { timeout: 20_000, interval: 25 });
  const verdict = (side: string) => page.getAttribute(`.loop[data-side=${side}]`, 'data-verdict');

  /** Chooses as a visitor does, and waits until the server has confirmed it. */
  async function choose(name: string, value: string): Promise<void> {
    await page.selectOption(`${parameter(name)} select`, value);
    await page.waitForSelector(`${parameter(name)}[data-value="${value}"]`);
  }

  /** Taps, and returns the first verdict on the contact. */
  async function tapped(side: string): Promise<string | null> {
    await until(async () => expect(await verdict(side)).toBe('free'));
    await page.click('#tap');
    let seen: string | null = null;
    await until(async () => {
      seen = await verdict(side);
      expect(['settled', 'rings', 'stopped']).toContain(seen);
    });
    return seen;
  }

  beforeAll(async () => {
    demandProgram();
    browser = await launch();
  });
  afterAll(() => browser?.close());
  beforeEach(async () => {
    server = await TactusServer.start('--set', 'control.force_gain=10');
    watched = await open(browser!, server.url);
    page = watched.page;
  });
  afterEach(async () => {
    await watched?.close();
    await server.stop();
    expect(watched?.complaints).toEqual([]);
    expect(watched?.foreign).toEqual([]);
  });

  test('a scripted tap at gain 10 rings without cancellation and settles with it', async () => {
    expect(await page.getAttribute(parameter('control.force_gain'), 'data-value')).toBe('10');
    await choose('left.method', 'none');
    expect(await tapped('left')).toBe('rings');
    expect(await page.textContent('.loop[data-side=left] .verdict')).toContain('Rings');
    await choose('left.method', 'cancellation');
    expect(await tapped('left')).toBe('settled');
    expect(await page.textContent('.loop[data-side=left] .verdict')).toContain('Settled');
  });

  test('side by side, the same tap rings on one side and settles on the other', async () => {
    await page.setChecked(`${parameter('side_by_side')} input`, true);
    await choose('left.method', 'cancellation');
    await choose('right.method', 'none');
    await page.click('#dismiss');
    await page.click('#tap');
    await until(async () => expect([await verdict('left'), await verdict('right')]).toEqual(['settled', 'rings']));
    if (process.env.PICTURE) await page.screenshot({ path: process.env.PICTURE });
    expect(await page.textContent('.loop[data-side=left] .verdict')).toMatch(/Left\s+Settled/);
    expect(await page.textContent('.loop[data-side=right] .verdict')).toMatch(/Right\s+Rings/);
  });

  test('of 390 px it shows both loops in one look, without scrolling sideways', async () => {
    await page.setViewportSize({ width: 390, height: 844 });
    await page.setChecked(`${parameter('side_by_side')} input`, true);
    await page.waitForSelector('.loop[data-side=right]:not([hidden])');
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
    expect((await page.locator('#loops').boundingBox())!.height).toBeLessThanOrEqual(844);
    if (process.env.PHONE_PICTURE) {
      await page.click('#dismiss');
      await page.click('#tap');
      await until(async () => expect(await verdict('right')).toBe('rings'));
      await page.locator('#loops').scrollIntoViewIfNeeded();
      await page.screenshot({ path: process.env.PHONE_PICTURE });
    }
  });

  test('a verdict ends with the method that it was of, and with the connection', async () => {
    await choose('left.method', 'none');
    expect(await tapped('left')).toBe('rings');
    await choose('left.method', 'cancellation');
    await until(async () => expect(await verdict('left')).toBe('settled'));
    expect(await page.textContent('.loop[data-side=left] .measured')).toContain('before the change');
    await server.stop();
    await until(async () => expect(await verdict('left')).toBe('unknown'));
    expect(await page.textContent('.loop[data-side=left] .meter-text')).toBe('0.00 N');
    await watched!.close();
    // That nobody answers is what was wanted.
    watched!.complaints.length = 0;
  });

  test('the link holds what was chosen, and a visitor without one finds the defaults', async () => {
    const value = (name: string) => page.getAttribute(parameter(name), 'data-value');
    await choose('left.method', 'energy-tank');
    await page.setChecked(`${parameter('side_by_side')} input`, false);
    await until(async () => expect(new URL(page.url()).hash).toBe('#left.method=energy-tank&side_by_side=false'));
    const link = page.url();
    await page.reload();
    await until(async () => expect([await value('left.method'), await value('side_by_side')]).toEqual(['energy-tank', 'false']));
    await page.goto('about:blank');
    await page.waitForTimeout(300);
    await page.goto(server.url);
    await until(async () => expect([await value('left.method'), await value('side_by_side')]).toEqual(['cancellation', 'true']));
    expect(await page.isDisabled('#restore')).toBe(true);
    await page.goto(link);
    await until(async () => expect(await value('left.method')).toBe('energy-tank'));
    await page.click('#restore');
    await until(async () => expect([await value('left.method'), await value('side_by_side')]).toEqual(['cancellation', 'true']));
    expect(new URL(page.url()).hash).toBe('');
  });

  test('each method is explained where it is chosen', async () => {
    const choices = await page.$$eval(`${parameter('left.method')} option`, (all) => all.map((one) => (one as HTMLOptionElement).value));
    const seen = new Set<string | null>();
    for (const choice of choices) {
      await choose('left.method', choice);
      seen.add(await page.textContent(`${parameter('left.method')} .explanation`));
    }
    expect(seen.size).toBe(choices.length);
  });

  test('the limit of the motor is told where it clips', async () => {
    await choose('left.method', 'cancellation');
    await page.click('#tap');
    await until(async () => expect(await page.textContent('.loop[data-side=left] .limit')).toBe('The motor is at its limit of 1 N.'));
    await until(async () => expect(await page.textContent('.loop[data-side=left] .limit')).toBe('The motor’s limit is 1 N.'));
  });

  test('a visitor who presses into the wall by keys feels it, and everything goes on', async () => {
    await choose('left.method', 'cancellation');
    await page.focus('#handle-left');
    await page.keyboard.press('End');
    await until(async () => expect(await verdict('left')).toBe('settled'));
    await until(async () => {
      const force_N = Number(await page.getAttribute('.loop[data-side=left] .meter', 'aria-valuenow'));
      expect(force_N).toBeGreaterThan(0.2);
    });
    await page.keyboard.press('Escape');
    await until(async () => expect(await verdict('left')).toBe('free'));
  });

  describe('while everything moves', { retry: 2 }, () => {
    test('a switch takes effect within 200 ms', async (context) => {
      await choose('left.method', 'none');
      await page.click('#tap');
      await until(async () => expect(await verdict('left')).toBe('rings'));
      const took_ms = await page.evaluate(switchMethod, ['left.method', 'cancellation'] as const);
      judge(context, 'ms until confirmed', took_ms, 200);
    });

    test('the page draws sixty pictures a second', async (context) => {
      await page.setChecked(`${parameter('side_by_side')} input`, true);
      await choose('right.method', 'none');
      await page.waitForTimeout(1500);
      await page.click('#tap');
      judgeSixtyHertz(context, await measureRate(page, 3));
    });
  });
});
