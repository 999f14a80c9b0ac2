// SPDX-License-Identifier: Apache-2.0
/** Where the visitor may put the hand of one axis; the server has the last word. */
export const lowest_m = -0.005;
export const highest_m = 0.015;

/** Toward the wall, and along the two directions across, in m from rest. */
export type HandPoint = readonly [toward: number, up: number, side: number];
/** Least and greatest of each. */
export type Reach = readonly [toward: readonly [number, number], up: readonly [number, number], side: readonly [number, number]];

export const axisReach: Reach = [[lowest_m, highest_m], [0, 0], [0, 0]];
export const armReach: Reach = [[-0.08, 0.04], [-0.08, 0.08], [-0.08, 0.08]];

const keepAlive_s = 0.1;

export interface HandMessage {
  /** One number of a hand that only goes to the wall and back. */
  readonly position_m: number | HandPoint;
  readonly engaged: boolean;
}

/**
 * The visitor's hand: where it wants to be, and whether it holds the handle. How fast an arm goes there is the server's
 * affair, the same for pointer, keys and gamepad.
 */
export class Hand {
  point_m: HandPoint = [0, 0, 0];
  engaged = false;
  reach: Reach = axisReach;
  private sent: { readonly point_m: HandPoint; readonly engaged: boolean } = { point_m: [0, 0, 0], engaged: false };
  private sentAt_s = -Infinity;

  /** How far toward the wall. */
  get position_m(): number {
    return this.point_m[0];
  }

  /** Takes hold of the handle where it is; a number is straight toward the wall. */
  grasp(at_m: number | HandPoint): void {
    this.engaged = true;
    this.moveTo(at_m);
  }

  moveTo(at_m: number | HandPoint): void {
    const [toward, up, side] = typeof at_m === 'number' ? [at_m, 0, 0] : at_m;
    const [first, second, third] = this.reach;
    this.point_m = [within(first, toward), within(second, up), within(third, side)];
  }

  release(): void {
    this.engaged = false;
  }

  /** What is to be told to the server at this time: a change at once, an unchanged hold ten times a second. */
  message(now_s: number): HandMessage | undefined {
    const { point_m, engaged, sent } = this;
    const moved = point_m.some((value, index) => value !== sent.point_m[index]);
    const changed = engaged !== sent.engaged || (engaged && moved);
    if (!changed && !(engaged && now_s - this.sentAt_s >= keepAlive_s)) return undefined;
    this.sent = { point_m, engaged };
    this.sentAt_s = now_s;
    return { position_m: this.reach === axisReach ? point_m[0] : point_m, engaged };
  }
}

function within([low, high]: readonly [number, number], value: number): number {
  return Math.min(high, Math.max(low, value));
}
