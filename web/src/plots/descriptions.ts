// SPDX-License-Identifier: Apache-2.0
import type { PlotDescription } from './plot';
import type { SignalName } from '../protocol/messages';
import { after_s, before_s } from '../state/contact';
import { window_s } from '../state/loop';

/** Which signals the plots of one loop show, in the order of their lines. */
export const positionSignals: readonly SignalName[] = [
  'slave_position_m',
  'master_position_m',
  'intended_motion_m',
  'induced_motion_m',
];
export const forceSignals: readonly SignalName[] = ['slave_force_n', 'displayed_force_n', 'hand_force_n'];

function ago(value: number): string {
  return value === 0 ? 'now' : value.toFixed(1).replace('-', '−');
}

const overTime = { xLabel: 'seconds ago', xText: ago, xStep: 0.5, reach: [-window_s, 0] } as const;

export const positions: PlotDescription = {
  ...overTime,
  title: 'Positions',
  note: 'Induced: what the force alone did to the handle. Intended: what is left, your own motion.',
  yLabel: 'mm',
  base: [-2, 18],
  height: 190,
  lines: [
    { label: 'robot', colour: 'slave' },
    { label: 'your handle', colour: 'master' },
    { label: 'intended', colour: 'intended' },
    { label: 'induced', colour: 'induced' },
  ],
};

export const forces: PlotDescription = {
  ...overTime,
  title: 'Forces',
  note: 'What the robot feels at the wall, what the motor gives you, what reaches your hand.',
  yLabel: 'N',
  base: [-0.5, 1.5],
  height: 160,
  lines: [
    { label: 'at the wall', colour: 'slave' },
    { label: 'motor', colour: 'master' },
    { label: 'your hand', colour: 'force' },
  ],
};

const loops = [
  { label: 'left', colour: 'master', width: 1.5 },
  { label: 'right', colour: 'induced', width: 1.5 },
] as const;

export const closeUp: PlotDescription = {
  title: 'The last contact, close up',
  note: 'Force on your hand, every tick, from 20 ms before the first touch.',
  xLabel: 'ms after the first touch',
  yLabel: 'N',
  xStep: 50,
  reach: [-1e3 * before_s, 1e3 * after_s],
  base: [-0.5, 1.5],
  height: 190,
  lines: loops,
};

export const energy: PlotDescription = {
  ...overTime,
  title: 'Vibration energy put into your handle',
  note: 'By the motor, above 15 Hz, since the contact began. A crisp contact levels off; a loop that rings generates more and more.',
  yLabel: 'mJ',
  base: [-1, 5],
  height: 190,
  lines: loops,
};
