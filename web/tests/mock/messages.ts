// SPDX-License-Identifier: Apache-2.0
import { CdrWriter } from './cdr_writer';
import { forceLimit_N, tick_s, wall_m, type MockLoop, type Tick } from './loop';

/** The messages of the mock and their definitions, with names in lower case as ROS 2 wants them. */

const signals = [
  ['master_position_m', 'master_m'],
  ['slave_position_m', 'slave_m'],
  ['intended_motion_m', 'intended_m'],
  ['induced_motion_m', 'induced_m'],
  ['command_m', 'command_m'],
  ['slave_force_n', 'slaveForce_N'],
  ['displayed_force_n', 'displayedForce_N'],
  ['hand_force_n', 'handForce_N'],
] as const;

export const schemas = {
  block: {
    name: 'tactus_msgs/msg/LiveBlock',
    text: ['float64 start_s', 'float64 column_s']
      .concat(signals.flatMap(([name]) => [`float32[] ${name}_min`, `float32[] ${name}_max`]))
      .join('\n'),
  },
  hand_force: {
    name: 'tactus_msgs/msg/HandForce',
    text: '# The force at the hand, every tick.\nfloat64 start_s\nfloat64 period_s\nfloat32[] force_n\n',
  },
  state: {
    name: 'tactus_msgs/msg/LiveState',
    text: `float64 time_s
float64 hand_position_m
float64 master_position_m
float64 slave_position_m
float64 wall_position_m
float64 slave_force_n
float64 displayed_force_n
float64 vibration_energy_j
bool in_contact
string verdict
string cause
string advice
float64 force_limit_n
float64 real_time_ratio
uint64 dropped
float64 estimated_grip
float64 estimated_grip_deviation
`,
  },
} as const;

export function blockMessage(start_s: number, ticksPerColumn: number, rows: readonly Tick[]): Uint8Array {
  const writer = new CdrWriter().float64(start_s).float64(ticksPerColumn * tick_s);
  const columns = Math.floor(rows.length / ticksPerColumn);
  for (const [, key] of signals) {
    const low = new Float32Array(columns).fill(Infinity);
    const high = new Float32Array(columns).fill(-Infinity);
    for (let i = 0; i < columns * ticksPerColumn; ++i) {
      const column = Math.floor(i / ticksPerColumn);
      low[column] = Math.min(low[column]!, rows[i]![key]);
      high[column] = Math.max(high[column]!, rows[i]![key]);
    }
    writer.float32s(low).float32s(high);
  }
  return writer.finish();
}

export function handForceMessage(start_s: number, rows: readonly Tick[]): Uint8Array {
  return new CdrWriter()
    .float64(start_s)
    .float64(tick_s)
    .float32s(rows.map((row) => row.handForce_N))
    .finish();
}

export function stateMessage(time_s: number, hand_m: number, loop: MockLoop, last: Tick, dropped: number): Uint8Array {
  return new CdrWriter()
    .float64(time_s)
    .float64(hand_m)
    .float64(last.master_m)
    .float64(last.slave_m)
    .float64(wall_m)
    .float64(last.slaveForce_N)
    .float64(last.displayedForce_N)
    .float64(loop.energy_J)
    .bool(loop.inContact)
    .string(loop.verdict)
    .string(loop.cause)
    .string('')
    .float64(forceLimit_N)
    .float64(1)
    .uint64(dropped)
    .float64(0.5)
    .float64(0.1)
    .finish();
}
