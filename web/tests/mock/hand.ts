// SPDX-License-Identifier: Apache-2.0
import { tick_s, wall_m } from './loop';

/** The hand of the mock: follows what the visitor asks as an arm would, or plays a scripted tap. */
export class MockHand {
  private asked_m = 0;
  private tapAt_s: number | undefined;
  position_m = 0;

  ask(position_m: number, engaged: boolean): void {
    this.asked_m = engaged ? Math.min(0.015, Math.max(-0.005, position_m)) : 0;
    if (engaged) this.tapAt_s = undefined;
  }

  tap(now_s: number): void {
    this.tapAt_s = now_s;
    this.asked_m = 0;
  }

  tick(now_s: number): void {
    if (this.tapAt_s !== undefined) this.position_m = tapPath(now_s - this.tapAt_s);
    else this.position_m += (this.asked_m - this.position_m) * Math.min(1, tick_s / 0.02);
    if (this.tapAt_s !== undefined && now_s - this.tapAt_s > 2.6) this.tapAt_s = undefined;
  }
}

function tapPath(time_s: number): number {
  const depth = wall_m + 0.002;
  return depth * (minimumJerk(time_s / 0.15) - minimumJerk((time_s - 2) / 0.4));
}

function minimumJerk(share: number): number {
  const s = Math.min(1, Math.max(0, share));
  return s ** 3 * (10 - 15 * s + 6 * s * s);
}
