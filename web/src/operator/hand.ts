/** Where the visitor may put the hand; the server has the last word. */
export const lowest_m = -0.005;
export const highest_m = 0.015;

/** Keys and gamepad move the hand no faster than a person would. */
const glideSpeed_m_per_s = 0.12;
const keepAlive_s = 0.1;

export interface HandMessage {
  readonly position_m: number;
  readonly engaged: boolean;
}

/**
 * The visitor's hand: where it wants to be, and whether it holds the handle. A pointer puts it somewhere at once, for the
 * person's own arm smooths its path; keys and gamepad set an aim that it glides to.
 */
export class Hand {
  position_m = 0;
  engaged = false;
  private aim_m: number | undefined;
  private sent: HandMessage = { position_m: 0, engaged: false };
  private sentAt_s = -Infinity;

  /** Takes hold of the handle where it is. */
  grasp(at_m: number): void {
    this.engaged = true;
    this.aim_m = undefined;
    this.position_m = clamp(at_m);
  }

  moveTo(position_m: number): void {
    this.aim_m = undefined;
    this.position_m = clamp(position_m);
  }

  /** Lets the hand glide to a place; takes hold where the handle is, if it has not yet. */
  glideTo(aim_m: number, from_m: number): void {
    if (!this.engaged) this.grasp(from_m);
    this.aim_m = clamp(aim_m);
  }

  /** Where the hand is going. */
  get goal_m(): number {
    return this.aim_m ?? this.position_m;
  }

  release(): void {
    this.engaged = false;
    this.aim_m = undefined;
  }

  /** Advances a glide. */
  advance(elapsed_s: number): void {
    if (this.aim_m === undefined) return;
    const step = glideSpeed_m_per_s * Math.min(elapsed_s, 0.05);
    const left = this.aim_m - this.position_m;
    this.position_m += Math.max(-step, Math.min(step, left));
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

function clamp(position_m: number): number {
  return Math.min(highest_m, Math.max(lowest_m, position_m));
}
