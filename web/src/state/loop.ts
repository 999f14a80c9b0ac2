// SPDX-License-Identifier: Apache-2.0
import { signalNames, type ArmsState, type Block, type HandForce, type LoopState, type SignalName } from '../protocol/messages';
import { ContactCapture } from './contact';
import { SlidingSeries } from './series';

/** Length of the plots over time. */
export const window_s = 2.5;
/** Columns of blocks and ticks of the hand force that are kept: enough for `window_s` at 1 ms, and for a contact. */
const keptColumns = 2500;
const keptTicks = 8192;

const initial: LoopState = {
  time_s: 0,
  hand_position_m: 0,
  master_position_m: 0,
  slave_position_m: 0,
  wall_position_m: 0.01,
  slave_force_N: 0,
  displayed_force_N: 0,
  vibrationEnergy_J: 0,
  inContact: false,
  verdict: 'free',
  cause: '',
  advice: '',
  forceLimit_N: 0,
  realTimeRatio: 0,
  dropped: 0,
  estimatedGrip: 1,
  gripDeviation: 0,
};

/** What is known of one of the two loops. Positions are kept in mm and forces in N, as they are shown. */
export class Loop {
  state: LoopState = initial;
  /** Undefined of one axis, and until the first message. */
  arms: ArmsState | undefined;
  /**
   * Two rows a column: the least value, then the greatest, so that a line through them fills what lies
   * between. A row where nothing is a number stands for a stretch that no block covered.
   */
  readonly trace = new SlidingSeries(2 * keptColumns, signalNames.length);
  readonly handForce = new SlidingSeries(keptTicks, 1);
  readonly contact = new ContactCapture();
  /** Time that no block covered since the page was loaded, and its pieces. */
  missing_s = 0;
  missingPieces = 0;
  private blockEnd_s: number | undefined;

  clear(): void {
    this.state = initial;
    this.arms = undefined;
    this.trace.clear();
    this.handForce.clear();
    this.contact.clear();
    this.blockEnd_s = undefined;
  }

  addState(state: LoopState): void {
    if (state.time_s < this.state.time_s) this.clear(); // the loop began anew
    this.state = state;
  }

  addBlock(block: Block): void {
    if (block.columns === 0 || !(block.column_s > 0)) return;
    this.noteGap(block);
    for (let column = 0; column < block.columns; ++column) {
      const time = block.start_s + (column + 0.5) * block.column_s;
      this.addColumn(time - 0.25 * block.column_s, block.low, column);
      this.addColumn(time + 0.25 * block.column_s, block.high, column);
      this.contact.watch(time, block.high.slave_force_n[column]!);
    }
    this.blockEnd_s = block.start_s + block.columns * block.column_s;
  }

  addHandForce(piece: HandForce): void {
    if (piece.start_s < this.handForce.latest) this.handForce.clear();
    for (let i = 0; i < piece.force_N.length; ++i) {
      this.handForce.add(piece.start_s + i * piece.period_s);
      this.handForce.set(0, piece.force_N[i]!);
    }
    this.contact.collect(this.handForce);
  }

  private addColumn(time: number, values: Block['low'], column: number): void {
    this.trace.add(time);
    signalNames.forEach((name, signal) => this.trace.set(signal, shown(name, values[name][column]!)));
  }

  private noteGap(block: Block): void {
    if (block.start_s < this.trace.latest - block.column_s) this.trace.clear();
    const end = this.blockEnd_s;
    if (end !== undefined && block.start_s > end + 1.5 * block.column_s) {
      this.trace.add(end);
      for (let signal = 0; signal < signalNames.length; ++signal) this.trace.set(signal, NaN);
      this.missing_s += block.start_s - end;
      this.missingPieces += 1;
    }
  }
}

function shown(name: SignalName, value: number): number {
  return name.endsWith('_m') ? 1e3 * value : value;
}

export function signalIndex(name: SignalName): number {
  return signalNames.indexOf(name);
}
