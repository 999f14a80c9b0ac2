// SPDX-License-Identifier: Apache-2.0
import { mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { launch } from '../browser/browser';
import { StaticSite } from './static_site';

/** The built site, as a reader sees it. Links and anchors are checked by site/check.py. */

let site: StaticSite;
let browser: Browser;
let page: Page;
const complaints: string[] = [];

beforeAll(async () => {
  site = await StaticSite.serve(resolve('../build/site'), 'make site');
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => {
    if (!request.url().startsWith(site.url)) complaints.push(`asks for ${request.url()}`);
  });
  page.on('response', (response) => {
    if (response.status() >= 400) complaints.push(`${response.status()}: ${response.url()}`);
  });
});
afterAll(async () => {
  await browser?.close();
  site?.close();
});

async function picture(name: string): Promise<void> {
  if (!process.env.PICTURES) return;
  mkdirSync(process.env.PICTURES, { recursive: true });
  await page.screenshot({ path: join(process.env.PICTURES, `site-${name}.png`) });
}

describe('the site, from a sub-path', () => {
  it('leads from its front page to the explainer', async () => {
    await page.goto(site.url);
    await picture('front');
    await page.getByRole('link', { name: 'Feel it in your browser' }).click();
    await page.waitForSelector('tactus-figure[kind="problem"][data-state="ready"]');
    expect(complaints).toEqual([]);
  });

  it('finds a page by a question and opens it', async () => {
    await page.goto(`${site.url}search.html?q=my+arm+buzzes`);
    const first = page.locator('ul.search li a').first();
    await first.waitFor();
    await picture('search');
    expect(await first.textContent()).toMatch(/buzzes/i);
    await first.click();
    await page.waitForSelector('h1');
    expect(complaints).toEqual([]);
  });

  it('sets formulas, and follows a dark browser', async () => {
    await page.emulateMedia({ colorScheme: 'dark' });
    await page.goto(`${site.url}theory/induced-master-motion.html`);
    await page.waitForSelector('.math .katex');
    await picture('formulas');
    expect(await page.locator('.katex-error').count()).toBe(0);
    const bright = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    expect(Math.max(...bright.match(/\d+/g)!.slice(0, 3).map(Number))).toBeLessThan(80);
    expect(complaints).toEqual([]);
  });
});
