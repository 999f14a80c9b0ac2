// SPDX-License-Identifier: Apache-2.0
import type { Page } from 'playwright-core';

/** What a visitor does with the handle, as the browser sees it: drags of different length and speed, and every key. */

export interface Drag {
  readonly length_mm: number;
  readonly duration_ms: number;
}

export const drags: readonly Drag[] = [
  { length_mm: 17, duration_ms: 800 },
  { length_mm: 13, duration_ms: 1500 },
  { length_mm: 19, duration_ms: 60 },
  { length_mm: 12, duration_ms: 300 },
  { length_mm: 14, duration_ms: 150 },
  { length_mm: 15, duration_ms: 250 },
  { length_mm: 13, duration_ms: 100 },
  { length_mm: 18, duration_ms: 2500 },
];

/** Keys on the handle that bring the robot to the wall from rest: each list is pressed one after the other. */
export const presses: Readonly<Record<string, readonly string[]>> = {
  End: ['End'],
  'Page Up': Array<string>(7).fill('PageUp'),
  'arrow right': Array<string>(26).fill('ArrowRight'),
  'arrow up': Array<string>(26).fill('ArrowUp'),
  Space: ['Space'],
  Enter: ['Enter'],
};

/** How long the hand rests at the end of a move, longer than any verdict takes. */
const holds_ms = 900;

/** The middle of the left handle in the window. */
export async function placeOfHandle(page: Page): Promise<readonly [number, number]> {
  const box = (await page.locator('#handle-left').boundingBox())!;
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/**
 * The same once it stays there. It may still be on its way back from the move before, or what stands above it may not
 * be laid out yet: a pointer that is pressed beside it drags nothing.
 */
export async function handleAtRest(page: Page): Promise<readonly [number, number]> {
  for (let before = await placeOfHandle(page); ; ) {
    await page.waitForTimeout(50);
    const now = await placeOfHandle(page);
    if (Math.hypot(now[0] - before[0], now[1] - before[1]) < 0.5) return now;
    before = now;
  }
}

/** A finger where the page has touch, else the mouse. */
export class Pointer {
  private constructor(
    private readonly page: Page,
    private readonly touch: ((type: string, x: number, y: number) => Promise<void>) | undefined,
  ) {}

  static async on(page: Page, byTouch: boolean): Promise<Pointer> {
    if (!byTouch) return new Pointer(page, undefined);
    const session = await page.context().newCDPSession(page);
    return new Pointer(page, async (type, x, y) => {
      const touchPoints = type === 'touchEnd' ? [] : [{ x, y }];
      await session.send('Input.dispatchTouchEvent', { type: type as 'touchStart', touchPoints });
    });
  }

  /** Drags the left handle, as evenly as the browser takes it, waits, and lets go. */
  async drag({ length_mm, duration_ms }: Drag): Promise<void> {
    const handle = this.page.locator('#handle-left');
    await handle.scrollIntoViewIfNeeded();
    const [x, y] = await handleAtRest(this.page);
    const width = (await this.page.locator('.loop[data-side=left] canvas').boundingBox())!.width;
    const length = (length_mm * width) / 25;
    await this.put('down', x, y);
    const begin = performance.now();
    for (let share = 0; share < 1; ) {
      await this.page.waitForTimeout(8);
      share = Math.min(1, (performance.now() - begin) / duration_ms);
      await this.put('move', x + share * length, y);
    }
    await this.page.waitForTimeout(holds_ms);
    await this.put('up', x + length, y);
  }

  private async put(what: 'down' | 'move' | 'up', x: number, y: number): Promise<void> {
    if (this.touch) return this.touch({ down: 'touchStart', move: 'touchMove', up: 'touchEnd' }[what], x, y);
    await this.page.mouse.move(x, y);
    if (what === 'down') await this.page.mouse.down();
    if (what === 'up') await this.page.mouse.up();
  }
}

/** Presses keys on the handle, six a second, waits, and lets go. */
export async function press(page: Page, keys: readonly string[]): Promise<void> {
  await page.focus('#handle-left');
  for (const key of keys) {
    await page.keyboard.press(key);
    await page.waitForTimeout(keys.length > 1 ? 60 : 0);
  }
  await page.waitForTimeout(holds_ms);
  await page.keyboard.press('Escape');
}
