// SPDX-License-Identifier: Apache-2.0
import type { SlidingSeries } from './series';

/** A contact shown close up: this long before its first touch, and this long after, on a grid of equal steps. */
export const before_s = 0.02;
export const after_s = 0.25;
const grid_s = 0.2e-3;
const gridLength = Math.round((before_s + after_s) / grid_s);

/** Times of the grid in milliseconds after the first touch. */
export const closeUpTime_ms = Float64Array.from({ length: gridLength }, (_, i) => 1e3 * (i * grid_s - before_s));

const touchForce_N = 0.02;
/** A touch begins a new contact when the wall was not touched for this long before it. */
const freeBefore_s = 0.2;

/**
 * The force at the hand, tick by tick, around the first touch of the latest contact. A contact that bounces is one
 * contact: only a touch after some time without one begins another.
 */
export class ContactCapture {
  /** In N on the grid; not a number where nothing has been seen yet. */
  readonly force_N = new Float32Array(gridLength).fill(NaN);
  private filled = 0;
  private begin_s: number | undefined;
  private lastTouch_s = -Infinity;

  clear(): void {
    this.force_N.fill(NaN);
    this.filled = 0;
    this.begin_s = undefined;
    this.lastTouch_s = -Infinity;
  }

  /** The greatest force between slave and wall in a column at this time, in order of time. */
  watch(time_s: number, slaveForce_N: number): void {
    if (slaveForce_N < touchForce_N) return;
    if (time_s - this.lastTouch_s > freeBefore_s) {
      this.clear();
      this.begin_s = time_s - before_s;
    }
    this.lastTouch_s = time_s;
  }

  /** Takes what belongs to the contact from the ticks that are kept. */
  collect(handForce: SlidingSeries): void {
    if (this.begin_s === undefined || this.filled === gridLength) return;
    const [time, force] = handForce.views() as [Float64Array, Float32Array];
    const from_s = this.begin_s + this.filled * grid_s;
    let i = time.length;
    while (i > 0 && time[i - 1]! >= from_s - 0.5 * grid_s) i -= 1;
    for (; i < time.length && this.filled < gridLength; ++i) {
      const upTo = Math.min(gridLength, Math.floor((time[i]! - this.begin_s) / grid_s + 0.5) + 1);
      while (this.filled < upTo) this.force_N[this.filled++] = force[i]!;
    }
  }
}
