// SPDX-License-Identifier: Apache-2.0
import { column, ofSide, rowLength, verdicts, type Side, type Verdict } from '../kernel/kernel';

/** How long of a contact is kept, and in what steps. */
export const window_s = 0.25;
export const step_s = 0.001;
const steps = Math.round(window_s / step_s);

/** The newest contact of one side: what it was at its wall, and what was judged. It is kept until the next one begins. */
export class Contact {
  /** The largest force of each millisecond since the touch, in N. */
  readonly force_N = new Float64Array(steps);
  readonly leader_mm = new Float64Array(steps);
  readonly intended_mm = new Float64Array(steps);
  filled = 0;
  verdict: Verdict = 'free';
  settling_s = 0;
  /** The newest row. */
  readonly now = { hand_mm: 0, leader_mm: 0, intended_mm: 0, tip_mm: 0, displayed_N: 0, stopped: false };
  /** Counts contacts. */
  number = 0;
  private touched_s = NaN;
  private before: Verdict = 'free';

  constructor(private readonly side: Side) {}

  take(rows: Float64Array): void {
    const first = column(this.side, 'leader_m');
    const at = (name: (typeof ofSide)[number]): number => ofSide.indexOf(name);
    for (let row = 0; row < rows.length; row += rowLength) {
      const value = (name: (typeof ofSide)[number]): number => rows[row + first + at(name)]!;
      const verdict = verdicts[value('verdict')] ?? 'free';
      const time_s = rows[row]!;
      if (verdict !== 'free' && this.before === 'free') this.begin(time_s);
      this.before = verdict;
      const leader_mm = 1000 * value('leader_m');
      const intended_mm = leader_mm - 1000 * value('induced_m');
      if (verdict !== 'free') {
        this.judge(verdict, value('settling_s'));
        const step = Math.floor((time_s - this.touched_s) / step_s);
        if (step >= 0 && step < steps) {
          this.force_N[step] = Math.max(this.force_N[step]!, value('contact_N'));
          this.leader_mm[step] = leader_mm;
          this.intended_mm[step] = intended_mm;
          this.filled = step + 1;
        }
      }
      Object.assign(this.now, {
        hand_mm: 1000 * rows[row + 1]!,
        leader_mm,
        intended_mm,
        tip_mm: 1000 * value('tip_m'),
        displayed_N: value('displayed_N'),
        stopped: value('stopped') > 0,
      });
    }
  }

  /** The loop has started again: what touches next is a new contact. */
  restart(): void {
    this.before = 'free';
  }

  /** What was decided stays: a contact that rang is not settled because it is calm at last, nor undecided because the hand leaves. */
  private judge(verdict: Verdict, settling_s: number): void {
    if (this.verdict === 'rings' || (this.verdict === 'settled' && verdict !== 'rings')) return;
    this.verdict = verdict;
    this.settling_s = settling_s;
  }

  private begin(time_s: number): void {
    this.touched_s = time_s;
    this.verdict = 'contact';
    this.filled = 0;
    this.force_N.fill(0);
    this.number += 1;
  }
}

/** What happened, in one sentence. */
export function sentence(contact: Contact): string {
  if (contact.now.stopped) return 'Stopped: the safety gate took the force away.';
  const time = `${Math.round(1000 * contact.settling_s)} ms`;
  switch (contact.verdict) {
    case 'free':
      return 'Not touched yet.';
    case 'contact':
      return 'Touching …';
    case 'settled':
      return `Settles ${time} after the touch.`;
    case 'rings':
      return 'Rings: the force on the wall does not die away.';
  }
}
