// SPDX-License-Identifier: Apache-2.0
/** The loops of the live page, compiled to WebAssembly (kernel.hpp says what each function does). */

interface Exports {
  readonly memory: WebAssembly.Memory;
  _initialize(): void;
  tactus_text(): number;
  tactus_set(side: number): number;
  tactus_apply(side: number): number;
  tactus_restart(start_m: number): number;
  tactus_aim(position_m: number): void;
  tactus_tap(): void;
  tactus_tap_start_m(): number;
  tactus_cycle_s(): number;
  tactus_row(): number;
  tactus_most_rows(): number;
  tactus_step(cycles: number): number;
  tactus_taps(): number;
  tactus_run_tap(tap: number): number;
  tactus_trace(): number;
  tactus_result(): number;
}

export type Side = 0 | 1;
export const sides: readonly Side[] = [0, 1];

/** A row of `step`: what both sides share, and then the numbers of each side, in this order. */
export const shared = ['time_s', 'hand_m'] as const;
export const ofSide = ['leader_m', 'induced_m', 'command_m', 'tip_m', 'displayed_N', 'contact_N', 'peak_N', 'verdict', 'settling_s', 'stopped'] as const;
export const rowLength = shared.length + sides.length * ofSide.length;

export function column(side: Side, name: (typeof ofSide)[number]): number {
  return shared.length + side * ofSide.length + ofSide.indexOf(name);
}

/** The numbers of `verdict`. */
export const verdicts = ['free', 'contact', 'settled', 'rings'] as const;
export type Verdict = (typeof verdicts)[number];

/** The signals of a row of `trace`, as `simulation::TeleoperatorRecord` names them. */
export const signals = [
  'time_s',
  'master_position_m',
  'induced_position_m',
  'command_m',
  'slave_position_m',
  'tip_position_m',
  'displayed_force_N',
  'handle_force_N',
  'hand_force_N',
  'sent_force_N',
  'contact_force_N',
  'peak_contact_force_N',
  'touched',
  'touched_at_s',
  'estimated_grip',
  'estimated_grip_deviation',
] as const;
export const results = ['contacts', 'settled', 'settling_s', 'peak_N', 'residual_N'] as const;

export class Kernel {
  private constructor(private readonly kernel: Exports) {
    kernel._initialize();
  }

  static async load(code: BufferSource): Promise<Kernel> {
    const module = await WebAssembly.compile(code);
    // The C library can write to files, which there are none of: every call fails.
    const imports: WebAssembly.Imports = {};
    const notSupported = 58;
    for (const { module: from, name } of WebAssembly.Module.imports(module)) (imports[from] ??= {})[name] = () => notSupported;
    const instance = await WebAssembly.instantiate(module, imports);
    return new Kernel(instance.exports as unknown as Exports);
  }

  /** Sets a key of an experiment of the kind `tapping`, for one side. Throws what the kernel says of a wrong key or value. */
  set(side: Side, key: string, value: number | string | boolean): void {
    const bytes = new TextEncoder().encode(`${key}=${value}\0`);
    // Any call may let the memory grow, which replaces its buffer.
    const address = this.kernel.tactus_text();
    new Uint8Array(this.kernel.memory.buffer, address, bytes.length).set(bytes);
    this.demand(this.kernel.tactus_set(side));
  }

  /** What was set takes effect; a loop that runs continues with it. */
  apply(): void {
    for (const side of sides) this.demand(this.kernel.tactus_apply(side));
  }

  restart(start_m = 0): void {
    this.demand(this.kernel.tactus_restart(start_m));
  }

  /** The tap of the live page, from rest. */
  tap(): void {
    this.restart(this.kernel.tactus_tap_start_m());
    this.kernel.tactus_tap();
  }
  get tapStart_m(): number {
    return this.kernel.tactus_tap_start_m();
  }

  aim(position_m: number): void {
    this.kernel.tactus_aim(position_m);
  }

  get cycle_s(): number {
    return this.kernel.tactus_cycle_s();
  }

  /** The rows of the next cycles, a copy. */
  step(cycles: number): Float64Array<ArrayBuffer> {
    const some = Math.min(cycles, this.kernel.tactus_most_rows());
    return this.numbers(this.kernel.tactus_step(some), some * rowLength);
  }

  /** Draws the taps of the experiment that side 0 has, and returns how many. */
  taps(): number {
    const taps = this.kernel.tactus_taps();
    this.demand(taps);
    return taps;
  }

  runTap(tap: number): { result: Float64Array; trace: Float64Array } {
    const rows = this.kernel.tactus_run_tap(tap);
    this.demand(rows);
    return {
      result: this.numbers(this.kernel.tactus_result(), results.length),
      trace: this.numbers(this.kernel.tactus_trace(), rows * signals.length),
    };
  }

  private numbers(address: number, count: number): Float64Array<ArrayBuffer> {
    return new Float64Array(new Float64Array(this.kernel.memory.buffer, address, count));
  }

  private demand(answer: number): void {
    if (answer >= 0) return;
    const address = this.kernel.tactus_text();
    const bytes = new Uint8Array(this.kernel.memory.buffer, address, 4096);
    throw new Error(new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))));
  }
}
