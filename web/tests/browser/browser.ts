// SPDX-License-Identifier: Apache-2.0
import { chromium, type Browser, type BrowserContextOptions, type Page } from 'playwright-core';

/** A real Chromium, and a page that keeps what went wrong in it. */

export function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [
      '--headless',
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
      '--autoplay-policy=no-user-gesture-required',
    ],
  });
}

/** The control of a parameter. */
export function parameter(name: string): string {
  return `[data-parameter="${name}"]`;
}

export interface Watched {
  readonly page: Page;
  /** Errors and warnings of the console, and exceptions. */
  readonly complaints: string[];
  /** Addresses asked for that are not of the page's own server. */
  readonly foreign: string[];
  close(): Promise<void>;
}

export async function open(browser: Browser, url: string, options: BrowserContextOptions = {}): Promise<Watched> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  const complaints: string[] = [];
  const foreign: string[] = [];
  const host = new URL(url).host;
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => {
    if (new URL(request.url()).host !== host) foreign.push(request.url());
  });
  page.on('websocket', (socket) => {
    if (new URL(socket.url()).host !== host) foreign.push(socket.url());
  });
  await page.goto(url);
  await page.waitForSelector(parameter('control.force_gain'));
  return { page, complaints, foreign, close: () => context.close() };
}

/** Runs in the page: chooses a method and returns how long it took, in ms, until the server's confirmation was shown. */
export function switchMethod([name, method]: readonly [string, string]): Promise<number> {
  const control = document.querySelector<HTMLElement>(`[data-parameter="${name}"]`)!;
  const select = control.querySelector('select')!;
  return new Promise((resolve) => {
    const begin = performance.now();
    new MutationObserver((_changes, observer) => {
      if (control.dataset.value !== method) return;
      observer.disconnect();
      resolve(performance.now() - begin);
    }).observe(control, { attributes: true });
    select.value = method;
    select.dispatchEvent(new Event('change'));
  });
}
