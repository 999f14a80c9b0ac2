/** Where the visitor may put the hand; the server has the last word. */
export const lowest_m = -0.005;
export const highest_m = 0.015;

const keepAlive_s = 0.1;

export interface HandMessage {
  readonly position_m: number;
  readonly engaged: boolean;
}

/**
 * The visitor's hand: where it wants to be, and whether it holds the handle. How fast an arm goes there is the server's
 * affair, the same for pointer, keys and gamepad.
 */
export class Hand {
  position_m = 0;
  engaged = false;
  private sent: HandMessage = { position_m: 0, engaged: false };
  private sentAt_s = -Infinity;

  /** Takes hold of the handle where it is. */
  grasp(at_m: number): void {
    this.engaged = true;
    this.moveTo(at_m);
  }

  moveTo(position_m: number): void {
    this.position_m = Math.min(highest_m, Math.max(lowest_m, position_m));
  }

  release(): void {
    this.engaged = false;
  }

  /** What is to be told to the server at this time: a change at once, an unchanged hold ten times a second. */
  message(now_s: number): HandMessage | undefined {
    const { position_m, engaged } = this;
    const changed = engaged !== this.sent.engaged || (engaged && position_m !== this.sent.position_m);
    if (!changed && !(engaged && now_s - this.sentAt_s >= keepAlive_s)) return undefined;
    this.sent = { position_m, engaged };
    this.sentAt_s = now_s;
    return this.sent;
  }
}
