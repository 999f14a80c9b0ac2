// SPDX-License-Identifier: Apache-2.0
import { ForceVoice } from './voice';

/** The side of the sound that runs on the thread of the sound card. */

declare const sampleRate: number;
declare class AudioWorkletProcessor {
  readonly port: MessagePort;
}
declare function registerProcessor(name: string, processor: new () => AudioWorkletProcessor): void;

interface Piece {
  readonly force_N: Float32Array;
  readonly period_s: number;
}

class ForceProcessor extends AudioWorkletProcessor {
  private readonly voice = new ForceVoice(sampleRate);

  constructor() {
    super();
    this.port.onmessage = (event: MessageEvent<Piece>) => this.voice.push(event.data.force_N, event.data.period_s);
  }

  process(_inputs: Float32Array[][], outputs: Float32Array[][]): boolean {
    const channel = outputs[0]?.[0];
    if (channel) this.voice.process(channel);
    return true;
  }
}

registerProcessor('hand-force', ForceProcessor);
