// SPDX-License-Identifier: Apache-2.0
import type { LoopState, Verdict } from '../protocol/messages';

/** What the page says about a loop: a word, a sentence, and the shape of an icon, so that colour is not needed. */
export interface Judgement {
  readonly verdict: Told;
  readonly word: string;
  readonly sentence: string;
  /** What was measured and what to try. It changes with every picture, so it is shown and not read aloud. */
  readonly measured: string;
}

/** A verdict of the server, or what the page itself must add to it. */
export type Told = Verdict | 'moving' | 'unknown';

/** From here on a person feels a force, so that the page does not call the handle free, in N. */
export const felt_N = 0.2;
/** From here on the wall is touched. */
const touched_N = 0.02;

const words: Readonly<Record<Told, readonly [string, string]>> = {
  free: ['Free', 'The robot touches nothing.'],
  moving: ['Moving', 'The robot touches nothing: what you feel is handle and robot being moved.'],
  contact: ['Touching', 'The robot is on the wall; will it come to rest?'],
  settled: ['Settled', 'A crisp contact: it came to rest on the wall.'],
  rings: ['Rings', 'The force moves your hand, the robot follows that motion and hits the wall again.'],
  stopped: ['Stopped', 'The safety gate has let the motors go.'],
  unknown: ['Unknown', 'Nothing is heard of the robot.'],
};

type Seen = Pick<LoopState, 'verdict' | 'cause' | 'advice'>;

/** The greatest forces of the last moments, as the page shows them beside the verdict. */
export interface Forces {
  readonly atWall_N: number;
  readonly onHand_N: number;
}

/** Forces and verdict come in messages of their own, so one may know of a contact before the other. */
function told(verdict: Verdict, { atWall_N, onHand_N }: Forces): Told {
  if (verdict !== 'free') return verdict;
  if (atWall_N >= touched_N) return 'contact';
  return onHand_N >= felt_N ? 'moving' : 'free';
}

/** The verdict on what is shown beside it. */
export function judgement(state: Seen, forces: Forces, connected: boolean): Judgement {
  const verdict = connected ? told(state.verdict, forces) : 'unknown';
  const [word, sentence] = words[verdict];
  if (verdict === 'stopped') return { verdict, word, sentence: `${sentence} ${sentenceCase(state.cause)}`, measured: '' };
  const isContact = verdict === 'settled' || verdict === 'rings';
  return { verdict, word, sentence, measured: isContact ? `${state.advice} ${sentenceCase(state.cause)}` : '' };
}

/** Whether the motor shows as much as it may: more force at the wall is not felt. */
export function clips(displayed_N: number, limit_N: number): boolean {
  return limit_N > 0 && displayed_N > 0.99 * limit_N;
}

function sentenceCase(text: string): string {
  if (text === '') return '';
  const first = text[0]!.toUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
