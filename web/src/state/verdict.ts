import type { LoopState, Verdict } from '../protocol/messages';

/** What the page says about a loop: a word, a sentence, and the shape of an icon, so that colour is not needed. */
export interface Judgement {
  readonly verdict: Verdict;
  readonly word: string;
  readonly sentence: string;
  /** What the server measured, in its words. It changes with every picture, so it is shown and not read aloud. */
  readonly measured: string;
}

const words: Readonly<Record<Verdict, readonly [string, string]>> = {
  free: ['Free', 'The robot touches nothing.'],
  contact: ['Touching', 'The robot is on the wall; will it come to rest?'],
  settled: ['Settled', 'A crisp contact: it came to rest on the wall.'],
  rings: ['Rings', 'The force moves your hand, the robot follows that motion and hits the wall again.'],
  stopped: ['Stopped', 'The safety gate has let the motors go.'],
};

export function judgement(state: Pick<LoopState, 'verdict' | 'cause'>): Judgement {
  const [word, sentence] = words[state.verdict];
  const cause = state.cause === '' || state.verdict === 'free' ? '' : sentenceCase(state.cause);
  if (state.verdict === 'stopped') return { verdict: state.verdict, word, sentence: `${sentence} ${cause}`, measured: '' };
  return { verdict: state.verdict, word, sentence, measured: cause };
}

function sentenceCase(text: string): string {
  const first = text[0]!.toUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}

/**
 * A verdict that stays for a moment before it is told: a verdict that changes with every bounce would flicker, and a
 * screen reader would never come to its end. Ringing and a stop are told at once.
 */
export class SteadyVerdict {
  private told: Judgement = judgement({ verdict: 'free', cause: '' });
  private next: Judgement = this.told;
  private since_s = -Infinity;

  update(state: Pick<LoopState, 'verdict' | 'cause'>, now_s: number): Judgement {
    const seen = judgement(state);
    if (seen.verdict !== this.next.verdict) this.since_s = now_s;
    this.next = seen;
    const urgent = seen.verdict === 'rings' || seen.verdict === 'stopped';
    if (urgent || now_s - this.since_s >= 0.15) this.told = seen;
    return this.told;
  }
}
