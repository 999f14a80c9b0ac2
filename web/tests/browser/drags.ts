// SPDX-License-Identifier: Apache-2.0
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { launch, open, parameter, type Watched } from './browser';
import { drags, Pointer, press, presses } from './moves';
import { demandProgram, leftOut, TactusServer } from './tactus';
import { Witness } from './witness';

/**
 * Whatever a visitor does at force gain 10 rings without cancellation and settles with it, or the page says why not; and
 * verdict, meter and plots agree in every picture of it. A file for each screen, for they run side by side.
 */
export const describeDrags = ({ phone }: { phone: boolean }) =>
  describe.skipIf(leftOut)(phone ? 'on a phone of 390 px' : 'on a screen of 1280 px', () => {
    let browser: Browser | undefined;
    let server: TactusServer;
    let visit: Watched;
    let page: Page;
    let pointer: Pointer;

    beforeAll(async () => {
      demandProgram();
      browser = await launch();
      server = await TactusServer.start('--set', 'control.force_gain=10');
      const small = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
      visit = await open(browser, server.url, phone ? small : {});
      page = visit.page;
      await page.click('#dismiss');
      await page.uncheck(`${parameter('side_by_side')} input`);
      pointer = await Pointer.on(page, phone);
    });
    afterAll(async () => {
      await visit.close();
      await server.stop();
      await browser?.close();
      expect(visit.complaints).toEqual([]);
    });

    const moves = [
      ...drags.map((drag) => ({
        move: `a drag of ${drag.length_mm} mm in ${drag.duration_ms} ms`,
        make: () => pointer.drag(drag),
      })),
      ...Object.entries(presses).map(([name, keys]) => ({ move: `the key ${name}`, make: () => press(page, keys) })),
    ];

    describe.each(['none', 'cancellation'])('with the method %s', (method) => {
      beforeAll(async () => {
        await page.selectOption(`${parameter('left.method')} select`, method);
        await page.waitForSelector(`${parameter('left.method')}[data-value="${method}"]`);
      });

      test.each(moves)('$move', async ({ move, make }) => {
        const witness = await Witness.of(page);
        await make();
        const { verdicts, measured, disagreements } = await witness.untilFree();
        console.log(`${phone ? 390 : 1280} px, ${method}, ${move}: ${verdicts.join(' ')}; ${measured}`);
        expect(disagreements).toEqual([]);
        const rang = verdicts.includes('rings');
        expect(rang || verdicts.includes('settled')).toBe(true);
        if (method === 'cancellation') expect(rang).toBe(false);
        else if (!rang) expect(measured).toMatch(/Tap faster|tap again/);
      });
    });
  });
