// SPDX-License-Identifier: Apache-2.0
import type { Session, Side } from '../state/session';
import { sides } from '../state/session';
import workletUrl from './worklet.ts?worker&url';

/**
 * The force at the hand as sound, each loop in a voice of its own: with two loops the left one is heard on the left, the
 * right one on the right. Silent until the visitor turns it on; browsers want a gesture for it, and so do people.
 */
export class Sound {
  private context: AudioContext | undefined;
  private volumeNode: GainNode | undefined;
  private readonly voices = new Map<Side, { node: AudioWorkletNode; panner: StereoPannerNode }>();
  private volume = 0.5;
  private on = false;

  constructor(private readonly session: Session) {
    session.on('handForce', ({ side, force_N, period_s }) => {
      if (!this.on || (side === 'right' && !session.sideBySide)) return;
      const copy = Float32Array.from(force_N);
      this.voices.get(side)?.node.port.postMessage({ force_N: copy, period_s }, [copy.buffer]);
    });
    session.on('parameters', () => this.pan());
  }

  /** Whether the browser can do it. Outside a secure context (https, or this machine itself) there are no worklets. */
  static get available(): boolean {
    return 'AudioWorkletNode' in globalThis;
  }

  /** Turns the sound on or off; call it from a gesture. Throws what the browser throws when it has no sound. */
  async turn(on: boolean): Promise<void> {
    this.on = on;
    if (!on) {
      await this.context?.suspend();
      return;
    }
    if (this.context === undefined) await this.build();
    await this.context?.resume();
  }

  /** From 0 to 1. */
  setVolume(volume: number): void {
    this.volume = volume;
    if (this.volumeNode) this.volumeNode.gain.value = volume ** 2;
  }

  private async build(): Promise<void> {
    const context = new AudioContext();
    await context.audioWorklet.addModule(workletUrl);
    const volume = new GainNode(context, { gain: this.volume ** 2 });
    volume.connect(context.destination);
    for (const side of sides) {
      const node = new AudioWorkletNode(context, 'hand-force', { numberOfInputs: 0, outputChannelCount: [1] });
      const panner = new StereoPannerNode(context);
      node.connect(panner).connect(volume);
      this.voices.set(side, { node, panner });
    }
    this.context = context;
    this.volumeNode = volume;
    this.pan();
  }

  private pan(): void {
    const spread = this.session.sideBySide ? 0.9 : 0;
    for (const [side, { panner }] of this.voices) panner.pan.value = side === 'left' ? -spread : spread;
  }
}
