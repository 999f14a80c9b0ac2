// SPDX-License-Identifier: Apache-2.0
/**
 * Turns the force at the hand, one value a servo tick, into sound. The ticks wait in a buffer that evens out how they
 * arrive; they are interpolated (Catmull-Rom) to the rate of the sound card, freed of what is slower than hearing by two
 * high-passes of first order, and bounded by a hyperbolic tangent.
 */

const capacity = 1 << 14;
const targetDelay_s = 0.08;
const longestDelay_s = 0.25;
const highPass_Hz = 30;
/** Amplitude of a sudden newton before the limiter. */
const gainPerNewton = 0.9;
const fade_s = 0.01;

export class ForceVoice {
  private readonly ticks = new Float32Array(capacity);
  private written = 0;
  private place = 0;
  private period_s = 2e-4;
  private playing = false;
  private envelope = 0;
  private readonly retain: number;
  private readonly fadeStep: number;
  private readonly memory = [0, 0, 0, 0];

  constructor(private readonly sampleRate_Hz: number) {
    this.retain = 1 / (1 + (2 * Math.PI * highPass_Hz) / sampleRate_Hz);
    this.fadeStep = 1 / (fade_s * sampleRate_Hz);
  }

  /** Seconds of force that wait to be heard. */
  get delay_s(): number {
    return (this.written - this.place) * this.period_s;
  }

  push(force_N: ArrayLike<number>, period_s: number): void {
    if (!(period_s > 0) || force_N.length > capacity / 2) return;
    this.period_s = period_s;
    for (let i = 0; i < force_N.length; ++i) {
      const force = force_N[i]!;
      this.ticks[this.written++ % capacity] = Number.isFinite(force) ? force : 0;
    }
    if (this.delay_s > longestDelay_s) this.place = this.written - targetDelay_s / period_s;
  }

  /** Fills a block of samples, each within -1 and 1. */
  process(samples: Float32Array): void {
    // A little faster or slower, so that the delay stays near its target although two clocks never agree.
    const correction = 1 + Math.max(-0.01, Math.min(0.01, 0.1 * (this.delay_s - targetDelay_s)));
    const step = correction / (this.sampleRate_Hz * this.period_s);
    for (let i = 0; i < samples.length; ++i) {
      if (!this.playing && this.delay_s >= targetDelay_s) this.playing = true;
      if (this.playing && this.written - this.place < 4) this.playing = false;
      this.envelope = Math.max(0, Math.min(1, this.envelope + (this.playing ? this.fadeStep : -this.fadeStep)));
      const force = this.written < 4 ? 0 : this.interpolated();
      if (this.playing) this.place += step;
      samples[i] = this.envelope * Math.tanh(gainPerNewton * this.highPassed(force));
    }
  }

  private interpolated(): number {
    // Between the second and the third of four ticks; at the end of what is there it stays where it is.
    const first = Math.min(Math.floor(this.place), this.written - 4);
    const t = Math.min(1, this.place - first);
    const a = this.ticks[first % capacity]!;
    const b = this.ticks[(first + 1) % capacity]!;
    const c = this.ticks[(first + 2) % capacity]!;
    const d = this.ticks[(first + 3) % capacity]!;
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
  }

  private highPassed(value: number): number {
    let signal = value;
    for (let stage = 0; stage < 4; stage += 2) {
      const output = this.retain * (this.memory[stage + 1]! + signal - this.memory[stage]!);
      this.memory[stage] = signal;
      this.memory[stage + 1] = output;
      signal = output;
    }
    return signal;
  }
}
