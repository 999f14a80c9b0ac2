// SPDX-License-Identifier: Apache-2.0
import { mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { launch } from '../browser/browser';
import { StaticSite } from './static_site';

const folder = resolve('../build/explainer');

let site: StaticSite;
let url = '';
let browser: Browser;

beforeAll(async () => {
  site = await StaticSite.serve(folder, 'npm run build:explainer');
  url = site.url;
  browser = await launch();
});
afterAll(async () => {
  await browser?.close();
  site?.close();
});

async function open(options: BrowserContextOptions = {}, hash = ''): Promise<{ page: Page; complaints: string[] }> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  const complaints: string[] = [];
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => {
    if (!request.url().startsWith(url)) complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(url + hash);
  await page.waitForSelector('tactus-figure[kind="problem"][data-state="ready"]');
  return { page, complaints };
}

const figure = (kind: string): string => `tactus-figure[kind="${kind}"]`;

/** What came out of a tap that `act` starts: a verdict for each machine. */
async function tapped(page: Page, kind: string, act: () => Promise<void>): Promise<string[]> {
  const place = page.locator(figure(kind));
  await place.scrollIntoViewIfNeeded();
  const before = Number((await place.getAttribute('data-taps')) ?? 0);
  await act();
  await page.waitForSelector(`${figure(kind)}[data-taps="${before + 1}"]`, { timeout: 30_000 });
  return place.locator('.results').evaluateAll((lists) => lists.map((list) => (list.firstElementChild as HTMLElement).dataset.verdict ?? ''));
}

async function setKnob(page: Page, kind: string, name: string, value: number): Promise<void> {
  await page.locator(`${figure(kind)} input[name="${name}"]`).fill(String(value));
}

describe('the explainer', () => {
  it('shows by button, keyboard and mouse that a higher gain rings, and asks no other host', async () => {
    const { page, complaints } = await open();
    const button = page.locator(`${figure('problem')} button`);
    expect(await tapped(page, 'problem', () => button.click())).toEqual(['settled']);
    await setKnob(page, 'problem', 'gain', 8);
    const handle = page.locator(`${figure('problem')} .touch`);
    await handle.focus();
    expect(await tapped(page, 'problem', () => page.keyboard.press('Space'))).toEqual(['rings']);
    const drag = async (): Promise<void> => {
      const place = (await handle.boundingBox())!;
      await page.mouse.move(place.x + 60, place.y + 60);
      await page.mouse.down();
      for (let x = 0; x <= 200; x += 20) await page.mouse.move(place.x + 60 + x, place.y + 60);
      await page.mouse.up();
    };
    expect(await tapped(page, 'problem', drag)).toEqual(['rings']);
    expect(complaints).toEqual([]);
    await page.context().close();
  });

  it('moves the knobs by keyboard, keeps them in the address, and restores them from it', async () => {
    const { page } = await open();
    await page.locator(`${figure('problem')} input[name="gain"]`).focus();
    for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
    expect(new URL(page.url()).hash).toBe('#problem.gain=4');
    await page.context().close();
    const { page: again } = await open({}, '#problem.gain=4');
    expect(await again.locator(`${figure('problem')} output`).textContent()).toBe('× 4');
    await again.context().close();
  });

  it('shows by touch on a phone, in the dark, what cancellation and a wrong model do', async () => {
    const { page, complaints } = await open({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark' });
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
    const tap = (kind: string) => (): Promise<void> => page.locator(`${figure(kind)} button`).tap();
    expect(await tapped(page, 'cancellation', tap('cancellation'))).toEqual(['rings', 'settled']);
    expect(await tapped(page, 'wrong-model', tap('wrong-model'))).toEqual(['settled', 'settled']);
    await setKnob(page, 'wrong-model', 'limit', 10);
    expect(await tapped(page, 'wrong-model', tap('wrong-model'))).toEqual(['settled', 'rings']);
    expect(complaints).toEqual([]);
    await page.context().close();
  });

  it('moves in steps where reduced motion is asked for', async () => {
    const changesIn = async (reducedMotion: 'reduce' | 'no-preference'): Promise<number> => {
      const { page } = await open({ reducedMotion });
      const count = await page.evaluate(
        (selector) =>
          new Promise<number>((done) => {
            const place = document.querySelector(selector)!;
            let changes = 0;
            new MutationObserver((all) => (changes += all.length)).observe(place.querySelector('.scene g')!, { attributes: true });
            place.querySelector('button')!.click();
            setTimeout(() => done(changes), 1000);
          }),
        figure('problem'),
      );
      await page.context().close();
      return count;
    };
    expect(await changesIn('reduce')).toBeLessThanOrEqual(6);
    expect(await changesIn('no-preference')).toBeGreaterThan(6);
  });

  it.runIf(process.env.PICTURES)('is photographed', { timeout: 120_000 }, async () => {
    mkdirSync(process.env.PICTURES!, { recursive: true });
    for (const width of [390, 1280]) {
      for (const colorScheme of ['light', 'dark'] as const) {
        const { page } = await open({ viewport: { width, height: 900 }, colorScheme }, '#problem.gain=8');
        for (const kind of ['problem', 'cancellation', 'wrong-model']) {
          await tapped(page, kind, () => page.locator(`${figure(kind)} button`).click());
        }
        await page.screenshot({ path: join(process.env.PICTURES!, `${width}-${colorScheme}.png`), fullPage: true });
        await page.context().close();
      }
    }
  });
});
