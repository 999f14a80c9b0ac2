// SPDX-License-Identifier: Apache-2.0
/** The three figures: what each one shows, and what the reader can change. */
import type { Side } from '../kernel/kernel';
import type { Setting } from './orders';

export interface Knob {
  readonly name: string;
  readonly label: string;
  readonly least: number;
  readonly most: number;
  readonly step: number;
  readonly initial: number;
  readonly text: (value: number) => string;
  readonly settings: (value: number) => readonly Setting[];
}

export interface Kind {
  /** The sides that are shown, with their names. */
  readonly shown: readonly { readonly side: Side; readonly name: string }[];
  readonly fixed: readonly Setting[];
  readonly knobs: readonly Knob[];
}

const both = (key: string, value: Setting['value']): Setting[] => [
  { side: 0, key, value },
  { side: 1, key, value },
];

export const kinds: Readonly<Record<string, Kind>> = {
  problem: {
    shown: [{ side: 0, name: 'Without cancellation' }],
    fixed: both('control.cancellation', 'off'),
    knobs: [
      {
        name: 'gain',
        label: 'Force gain',
        least: 1,
        most: 10,
        step: 1,
        initial: 1,
        text: (value) => `× ${value}`,
        settings: (value) => both('control.force_gain', value),
      },
    ],
  },
  cancellation: {
    shown: [
      { side: 0, name: 'Without cancellation' },
      { side: 1, name: 'With cancellation' },
    ],
    fixed: [
      { side: 0, key: 'control.cancellation', value: 'off' },
      { side: 1, key: 'control.cancellation', value: 'on' },
    ],
    knobs: [
      {
        name: 'gain',
        label: 'Force gain of both',
        least: 1,
        most: 15,
        step: 1,
        initial: 10,
        text: (value) => `× ${value}`,
        settings: (value) => both('control.force_gain', value),
      },
    ],
  },
  'wrong-model': {
    shown: [
      { side: 0, name: 'Exact model' },
      { side: 1, name: 'Wrong model' },
    ],
    fixed: [...both('control.cancellation', 'on'), ...both('control.force_gain', 10)],
    knobs: [
      {
        name: 'mass',
        label: 'Masses in the right model',
        least: 0.5,
        most: 2,
        step: 0.1,
        initial: 1.5,
        text: (value) => `${Math.round(100 * value)} %`,
        settings: (value) => [{ side: 1, key: 'task.mismatch.mass', value }],
      },
      {
        name: 'limit',
        label: 'Force limit of both motors',
        least: 1,
        most: 10,
        step: 1,
        initial: 1,
        text: (value) => `${value} N`,
        settings: (value) => both('control.force_limit_N', value),
      },
    ],
  },
};
