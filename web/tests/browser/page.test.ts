// SPDX-License-Identifier: Apache-2.0
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, test, vi } from 'vitest';
import { MockServer } from '../mock/server';
import { launch, open, parameter, switchMethod, type Watched } from './browser';
import { judge, judgeSixtyHertz, measureRate } from './rate';

/** The page in a real Chromium, against the mock. */

let browser: Browser;
let server: MockServer;
let watched: Watched | undefined;
let page: Page;

const until = (check: () => void | Promise<void>) => vi.waitFor(check, { timeout: 20_000, interval: 25 });
const verdict = (side: string) => page.getAttribute(`[data-side=${side}].loop`, 'data-verdict');
const lastHand = () => server.received.filter(({ topic }) => topic === '/operator/hand').at(-1)?.content;

beforeAll(async () => {
  browser = await launch();
});
afterAll(() => browser.close());
beforeEach(async () => {
  server = await MockServer.start();
  watched = await open(browser, server.url);
  page = watched.page;
});
afterEach(async () => {
  await watched?.close();
  await server.stop();
  expect(watched?.foreign).toEqual([]);
});

describe('the page', () => {
  test('loads, taps and shows both loops with no complaint and no request off the host', async () => {
    await page.check(`${parameter('side_by_side')} input`);
    await page.selectOption(`${parameter('right.method')} select`, 'cancellation');
    await page.click('#tap');
    await until(async () => expect(await verdict('left')).toBe('rings'));
    await until(async () => expect(await verdict('right')).toBe('settled'));
    expect(await page.textContent('.loop[data-side=left] .verdict')).toContain('Rings');
    await page.click('#pause');
    await page.click('#sound');
    await until(async () => expect(await page.textContent('#sound')).toContain('on'));
    expect(watched?.complaints).toEqual([]);
  });

  test('explains itself in three sentences on the first visit only', async () => {
    expect(await page.locator('#intro li').count()).toBe(3);
    await page.click('#dismiss');
    await page.reload();
    await page.waitForSelector(parameter('control.force_gain'));
    expect(await page.isVisible('#intro')).toBe(false);
    await page.click('#help');
    expect(await page.isVisible('#intro')).toBe(true);
  });

  test('lets the mouse drag the handle into the wall, and lets go', async () => {
    const handle = (await page.locator('#handle-left').boundingBox())!;
    const [x, y] = [handle.x + handle.width / 2, handle.y + handle.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 500, y, { steps: 10 });
    await until(() => expect(lastHand()).toMatchObject({ engaged: true }));
    await until(async () => expect(await verdict('left')).toBe('rings'));
    expect(lastHand()!.position_m).toBeGreaterThan(0.01);
    await page.mouse.up();
    await until(() => expect(lastHand()).toMatchObject({ engaged: false }));
    await until(async () => expect(await verdict('left')).toBe('free'));
  });

  test('is worked by keys alone, and tells a screen reader where the handle is', async () => {
    await page.focus('#handle-left');
    await page.keyboard.press('End');
    await until(async () => expect(await verdict('left')).toBe('rings'));
    await until(async () =>
      expect(await page.getAttribute('#handle-left', 'aria-valuetext')).toContain('mm into the wall'),
    );
    await page.keyboard.press('Escape');
    await until(async () => expect(await verdict('left')).toBe('free'));
    await page.keyboard.press('ArrowRight');
    await until(() => expect(lastHand()).toMatchObject({ engaged: true }));
    await page.keyboard.press('Space');
    await until(() => expect(server.received.at(-1)).toMatchObject({ content: { command: 'tap' } }));
    await page.focus(`${parameter('control.force_gain')} input`);
    await page.keyboard.press('Home');
    await until(() => expect(server.values.get('control.force_gain')).toBe(0));
  });

  test('reaches everything with Tab, each with a name and a visible focus', async () => {
    const nameless = await page.$$eval('button, input, select, [tabindex="0"]', (all) =>
      all
        .filter((one) => (one as HTMLElement).offsetParent !== null)
        .filter((one) => {
          const labels = 'labels' in one ? ((one as HTMLInputElement).labels?.length ?? 0) : 0;
          return one.textContent === '' && labels === 0 && one.getAttribute('aria-label') === null;
        })
        .map((one) => one.outerHTML),
    );
    expect(nameless).toEqual([]);
    await page.keyboard.press('Tab');
    await page.keyboard.press('Tab');
    const outline = await page.evaluate(() => getComputedStyle(document.activeElement!).outlineStyle);
    expect(outline).toBe('solid');
  });

  test('hides a line at a press on its name, also while the plots are held', async () => {
    const drawn = () =>
      page.$eval('.plot:first-child .u-over canvas', (canvas) => {
        const { width, height } = canvas as HTMLCanvasElement;
        const { data } = (canvas as HTMLCanvasElement).getContext('2d')!.getImageData(0, 0, width, height);
        return data.some((byte) => byte !== 0);
      });
    await page.uncheck(`${parameter('side_by_side')} input`);
    await page.click('#tap');
    await until(async () => expect(await drawn()).toBe(true));
    await page.click('#pause');
    const name = page.locator('.plot:first-child .legend button:visible');
    await name.click();
    expect(await drawn()).toBe(false);
    await name.click();
    expect(await drawn()).toBe(true);
  });

  test('shows a change that another client made, and a refusal with its reason', async () => {
    server.values.set('control.force_gain', 4);
    server.sendToAll({ op: 'parameterValues', parameters: [{ name: 'control.force_gain', value: 4 }] });
    await until(async () => expect(await page.textContent(`${parameter('control.force_gain')} output`)).toBe('4'));
    server.sendToAll({ op: 'status', level: 2, message: 'control.force_gain: 99 is above 30' });
    await until(async () => expect(await page.textContent('#notices')).toContain('99 is above 30'));
  });

  test('says that the connection is lost, and goes on when it is back', async () => {
    server.cut();
    await until(async () => expect(await page.textContent('#connection')).toContain('lost'));
    await until(async () => expect(await page.textContent('#connection')).toBe('connected'));
    server.silent = true;
    await until(async () => expect(await page.textContent('#connection')).toContain('nothing comes'));
  });

  test('says what was dropped', async () => {
    server.skipBlocks = 5;
    await until(async () => expect(await page.textContent('#health')).toContain('dropped by the server'));
    await until(async () => expect(await page.textContent('#health')).toMatch(/[1-9]\d* gaps? in the plots/));
  });
});

describe('a phone', () => {
  test('of 390 px shows everything without scrolling sideways, and drags by touch', async () => {
    const phone = await open(browser, server.url, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    await phone.page.check(`${parameter('side_by_side')} input`);
    await phone.page.waitForSelector('.loop[data-side=right]:not([hidden])');
    const width = await phone.page.evaluate(() => document.documentElement.scrollWidth);
    expect(width).toBeLessThanOrEqual(390);
    const small = await phone.page.$$eval('button, select, input[type=checkbox]', (all) =>
      all.filter((one) => one.getClientRects().length > 0 && one.getBoundingClientRect().height < 22).length,
    );
    expect(small).toBe(0);
    const handle = phone.page.locator('#handle-left');
    await handle.scrollIntoViewIfNeeded();
    const box = (await handle.boundingBox())!;
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const touch = await phone.page.context().newCDPSession(phone.page);
    await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [{ x, y }] });
    for (let step = 1; step <= 10; ++step) {
      await touch.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: [{ x: x + 20 * step, y }] });
    }
    await until(() => expect(lastHand()).toMatchObject({ engaged: true }));
    expect(lastHand()!.position_m).toBeGreaterThan(0.008);
    await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await until(() => expect(lastHand()).toMatchObject({ engaged: false }));
    expect(phone.complaints).toEqual([]);
    await phone.close();
  });
});

describe('a server without tuning', () => {
  test('shows its parameters locked, and says how to unlock them', async () => {
    const locked = await MockServer.start({ tuning: false });
    const visit = await open(browser, locked.url);
    expect(await visit.page.isDisabled(`${parameter('control.force_gain')} input`)).toBe(true);
    expect(await visit.page.textContent('#locked')).toContain('--allow-tuning');
    expect(await visit.page.isVisible('#locked')).toBe(true);
    await visit.close();
    await locked.stop();
  });
});

describe('with both loops, all plots and a ringing contact', { retry: 2 }, () => {
  test('the page draws sixty pictures a second', async (context) => {
    await page.check(`${parameter('side_by_side')} input`);
    await page.waitForTimeout(1500);
    await page.click('#tap');
    judgeSixtyHertz(context, await measureRate(page, 3));
  });

  test('a switch reaches the server and comes back within 200 ms', async (context) => {
    await page.check(`${parameter('side_by_side')} input`);
    const took_ms = await page.evaluate(switchMethod, ['left.method', 'cancellation'] as const);
    judge(context, 'ms until confirmed', took_ms, 200);
  });
});
