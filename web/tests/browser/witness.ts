// SPDX-License-Identifier: Apache-2.0
import type { Page } from 'playwright-core';

/** What was seen of the left loop, from one rest to the next. */
export interface Testimony {
  readonly verdicts: readonly string[];
  /** What stood beside the last verdict on the contact. */
  readonly measured: string;
  /** Pictures in which verdict, meter and plots did not agree, in words. */
  readonly disagreements: readonly string[];
}

declare global {
  interface Window {
    testimony: { verdicts: string[]; measured: string; disagreements: Set<string>; over: boolean };
  }
}

/** Looks at every picture of the page, as its visitor sees it: words and numbers, nothing from inside. */
export class Witness {
  private constructor(private readonly page: Page) {}

  static async of(page: Page): Promise<Witness> {
    await page.evaluate(() => {
      const seen: Window['testimony'] = { verdicts: [], measured: '', disagreements: new Set(), over: false };
      window.testimony = seen;
      const loop = document.querySelector<HTMLElement>('.loop[data-side=left]')!;
      const plot = document.querySelectorAll<HTMLElement>('.plot[data-side=left]')[1]!;
      const newton = (element: Element | null | undefined): number => parseFloat(element?.textContent ?? '');
      let touchedAt_ms = -Infinity;
      const look = (now_ms: number): void => {
        const verdict = loop.dataset.verdict ?? '';
        const onHand_N = newton(loop.querySelector('.meter-text'));
        const [atWall_N, , drawn_N] = [...plot.querySelectorAll('.legend .value')].map(newton) as [number, number, number];
        if (seen.verdicts.at(-1) !== verdict) seen.verdicts.push(verdict);
        if (verdict === 'settled' || verdict === 'rings') seen.measured = loop.querySelector('.measured')!.textContent!;
        const nothing = verdict === 'free' || verdict === 'moving';
        if (nothing || atWall_N > 0) touchedAt_ms = now_ms;
        const problems = [
          verdict === 'free' && onHand_N >= 0.205 && `free under ${onHand_N} N`,
          verdict === 'moving' && onHand_N < 0.195 && `moving under ${onHand_N} N`,
          onHand_N !== drawn_N && `meter ${onHand_N} N, plot ${drawn_N} N`,
          nothing && atWall_N > 0.02 && `${verdict} with ${atWall_N} N at the wall`,
          // The contact lasts 0.25 s beyond the last touch, the numbers are renewed every 0.25 s.
          !nothing && now_ms - touchedAt_ms > 600 && `${verdict} with nothing at the wall for 0.6 s`,
        ];
        for (const problem of problems) if (problem) seen.disagreements.add(problem);
        if (!seen.over) requestAnimationFrame(look);
      };
      requestAnimationFrame(look);
    });
    return new Witness(page);
  }

  /** Waits for the end of the contact and a little more. */
  async untilFree(): Promise<Testimony> {
    const free = (): boolean => document.querySelector<HTMLElement>('.loop[data-side=left]')!.dataset.verdict === 'free';
    await this.page.waitForFunction(free);
    await this.page.waitForTimeout(400);
    await this.page.waitForFunction(free);
    return this.page.evaluate(() => {
      window.testimony.over = true;
      return { ...window.testimony, disagreements: [...window.testimony.disagreements] };
    });
  }
}
