// SPDX-License-Identifier: Apache-2.0
import type { Message, NumberArray, Value } from './cdr';

/** What the page reads from the messages of a loop, checked once here. Names as in the schema, in lower case. */

export const signalNames = [
  'master_position_m',
  'slave_position_m',
  'intended_motion_m',
  'induced_motion_m',
  'command_m',
  'slave_force_n',
  'displayed_force_n',
  'hand_force_n',
] as const;
export type SignalName = (typeof signalNames)[number];

/** Least and greatest value of each signal in columns of equal duration. */
export interface Block {
  readonly start_s: number;
  readonly column_s: number;
  readonly columns: number;
  readonly low: Readonly<Record<SignalName, NumberArray>>;
  readonly high: Readonly<Record<SignalName, NumberArray>>;
}

export const verdicts = ['free', 'contact', 'settled', 'rings', 'stopped'] as const;
export type Verdict = (typeof verdicts)[number];

export interface LoopState {
  readonly time_s: number;
  readonly hand_position_m: number;
  readonly master_position_m: number;
  readonly slave_position_m: number;
  readonly wall_position_m: number;
  readonly slave_force_N: number;
  readonly displayed_force_N: number;
  readonly vibrationEnergy_J: number;
  readonly inContact: boolean;
  readonly verdict: Verdict;
  readonly cause: string;
  /** What the verdict says of the loop, and what to try. */
  readonly advice: string;
  /** The most that the master's motor displays. */
  readonly forceLimit_N: number;
  readonly realTimeRatio: number;
  readonly dropped: number;
  /** How firmly the hand holds, over the controller's model of it, and how sure that is: 0 where nothing is estimated. */
  readonly estimatedGrip: number;
  readonly gripDeviation: number;
}

export interface HandForce {
  readonly start_s: number;
  readonly period_s: number;
  readonly force_N: NumberArray;
}

/** What the arms of a loop are about; vectors along the axes of the base. */
export interface ArmsState {
  readonly leader_rad: NumberArray;
  readonly follower_rad: NumberArray;
  readonly hand_m: NumberArray;
  readonly displayed_N: NumberArray;
  readonly contact_N: NumberArray;
  readonly induced_m: NumberArray;
}

function number(value: Value | undefined): number {
  return typeof value === 'number' && Number.isFinite(value) ? value : 0;
}

function text(value: Value | undefined): string {
  return typeof value === 'string' ? value : '';
}

function numbers(value: Value | undefined): NumberArray {
  return value instanceof Float32Array || value instanceof Float64Array ? value : new Float32Array(0);
}

export function toBlock(message: Message): Block {
  const low = {} as Record<SignalName, NumberArray>;
  const high = {} as Record<SignalName, NumberArray>;
  let columns = Infinity;
  for (const name of signalNames) {
    low[name] = numbers(message[`${name}_min`]);
    high[name] = numbers(message[`${name}_max`]);
    columns = Math.min(columns, low[name].length, high[name].length);
  }
  return { start_s: number(message.start_s), column_s: number(message.column_s), columns, low, high };
}

export function toLoopState(message: Message): LoopState {
  const verdict = verdicts.find((word) => word === message.verdict);
  return {
    time_s: number(message.time_s),
    hand_position_m: number(message.hand_position_m),
    master_position_m: number(message.master_position_m),
    slave_position_m: number(message.slave_position_m),
    wall_position_m: number(message.wall_position_m),
    slave_force_N: number(message.slave_force_n),
    displayed_force_N: number(message.displayed_force_n),
    vibrationEnergy_J: number(message.vibration_energy_j),
    inContact: message.in_contact === true,
    verdict: verdict ?? 'free',
    cause: text(message.cause),
    advice: text(message.advice),
    forceLimit_N: number(message.force_limit_n),
    realTimeRatio: number(message.real_time_ratio),
    dropped: number(message.dropped),
    estimatedGrip: number(message.estimated_grip),
    gripDeviation: number(message.estimated_grip_deviation),
  };
}

/** Undefined where a vector is none. */
export function toArms(message: Message): ArmsState | undefined {
  const arms = {
    leader_rad: numbers(message.leader_rad),
    follower_rad: numbers(message.follower_rad),
    hand_m: numbers(message.hand_m),
    displayed_N: numbers(message.displayed_force_n),
    contact_N: numbers(message.contact_force_n),
    induced_m: numbers(message.induced_m),
  };
  const { hand_m, displayed_N, contact_N, induced_m } = arms;
  return [hand_m, displayed_N, contact_N, induced_m].every(({ length }) => length === 3) ? arms : undefined;
}

export function toHandForce(message: Message): HandForce {
  return {
    start_s: number(message.start_s),
    period_s: number(message.period_s),
    force_N: numbers(message.force_n),
  };
}
