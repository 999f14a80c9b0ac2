// SPDX-License-Identifier: Apache-2.0
/**
 * What a loop of the mock does: a script, no mechanics. Pressed against the wall it rings at 70 Hz where a plain loop would
 * at this gain, and dies out within 50 ms elsewhere, so that the page has something plausible to show.
 */

export interface Settings {
  method: string;
  forceGain: number;
}

export const tick_s = 2e-4;
export const wall_m = 0.01;
const ringing_Hz = 70;
export const forceLimit_N = 1;
/** Greatest force gain at which a method settles. */
const settlesUpTo: Readonly<Record<string, number>> = { none: 2, 'force-filter': 4, 'local-damping': 6 };

export interface Tick {
  master_m: number;
  slave_m: number;
  intended_m: number;
  induced_m: number;
  command_m: number;
  slaveForce_N: number;
  displayedForce_N: number;
  handForce_N: number;
}

export class MockLoop {
  energy_J = 0;
  stopped = '';
  inContact = false;
  private touch_s = 0;
  private handForce_N = 0;
  private lastTouch_s = -Infinity;
  private time_s = 0;

  constructor(readonly settings: Settings) {}

  tick(aim_m: number): Tick {
    this.time_s += tick_s;
    const touches = aim_m > wall_m;
    if (touches && this.time_s - this.lastTouch_s > 0.25) this.touch_s = this.time_s;
    if (touches) this.lastTouch_s = this.time_s;
    this.inContact = touches;
    const since_s = this.time_s - this.touch_s;
    const wave = Math.sin(2 * Math.PI * ringing_Hz * since_s);
    const swing = !touches ? 0 : this.rings ? wave : wave * Math.exp(-since_s / 0.012);
    const pressed_N = touches ? Math.min(forceLimit_N, 150 * this.settings.forceGain * (aim_m - wall_m)) : 0;
    const displayed_N = Math.max(0, Math.min(forceLimit_N, touches ? 0.6 * pressed_N + 0.6 * swing : 0));
    this.handForce_N += (displayed_N - this.handForce_N) * 0.15;
    if (touches && this.rings) this.energy_J += 0.03 * tick_s * swing ** 2;
    const induced_m = -0.7e-3 * this.handForce_N;
    const master_m = aim_m + induced_m;
    const bounce_m = touches && this.rings ? 0.4e-3 * Math.max(0, -swing) : 0;
    return {
      master_m,
      slave_m: Math.min(wall_m, master_m) - bounce_m,
      intended_m: aim_m,
      induced_m,
      command_m: this.settings.method === 'cancellation' ? aim_m : master_m,
      slaveForce_N: touches ? Math.max(0, 0.4 + 2 * swing) : 0,
      displayedForce_N: displayed_N,
      handForce_N: this.handForce_N,
    };
  }

  get verdict(): string {
    if (this.stopped !== '') return 'stopped';
    if (this.time_s - this.lastTouch_s > 0.1) return 'free';
    if (this.time_s - this.touch_s < 0.1) return 'contact';
    return this.rings ? 'rings' : 'settled';
  }

  get cause(): string {
    if (this.verdict !== 'rings') return this.stopped;
    return `still loud ${(1000 * (this.time_s - this.touch_s)).toFixed(0)} ms after the touch`;
  }

  private get rings(): boolean {
    return this.settings.forceGain > (settlesUpTo[this.settings.method] ?? Infinity);
  }
}
