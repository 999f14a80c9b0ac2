// SPDX-License-Identifier: Apache-2.0
import type { Envelope } from './envelope';

/** A colour as the bytes of a pixel. */
export type Rgb = readonly [red: number, green: number, blue: number];

/** A line that goes up and down often within a column is fainter there, down to this, so that others show through. */
const faintest = 0.4;

/**
 * Pixels that lines are drawn into, column by column: a stroke of thousands of points costs a browser without a
 * graphics card many times what it costs to fill the pixels that they cover.
 */
export class Raster {
  readonly bytes: Uint8ClampedArray<ArrayBuffer>;
  private readonly pixels: Uint32Array;

  constructor(
    readonly width: number,
    readonly height: number,
  ) {
    this.bytes = new Uint8ClampedArray(4 * width * height);
    this.pixels = new Uint32Array(this.bytes.buffer);
  }

  clear(): void {
    this.pixels.fill(0);
  }

  /** Draws a line of some thickness, given by its envelope; `low` is the value at the bottom, `high` that at the top. */
  draw(envelope: Envelope, low: number, high: number, thickness: number, colour: Rgb): void {
    const pixelsPerUnit = this.height / (high - low);
    // A steep stretch is as thick to either side as a flat one is above and below.
    const beside = Math.floor(thickness / 2);
    for (let x = 0; x < this.width; ++x) {
      if (envelope.low[x]! > envelope.high[x]!) continue;
      let greatest = envelope.high[x]!;
      let least = envelope.low[x]!;
      for (let near = Math.max(0, x - beside); near <= Math.min(this.width - 1, x + beside); ++near) {
        greatest = Math.max(greatest, envelope.high[near]!);
        least = Math.min(least, envelope.low[near]!);
      }
      const top = (high - greatest) * pixelsPerUnit - thickness / 2;
      const bottom = (high - least) * pixelsPerUnit + thickness / 2;
      const strength = (bottom - top) / (thickness + envelope.travel[x]! * pixelsPerUnit);
      this.fillColumn(x, Math.max(0, top), Math.min(this.height, bottom), colour, Math.max(faintest, Math.min(1, strength)));
    }
  }

  /** A pixel that is covered in part, at either end, gets a part of the colour. */
  private fillColumn(x: number, top: number, bottom: number, colour: Rgb, strength: number): void {
    if (bottom <= top) return;
    const full = Math.ceil(top);
    const end = Math.floor(bottom);
    if (full > top) this.blend(x, full - 1, strength * (Math.min(full, bottom) - top), colour);
    if (full > end) return;
    const pixel = pixelOf(colour, strength);
    for (let y = full; y < end; ++y) {
      const at = y * this.width + x;
      if (strength === 1 || this.pixels[at] === 0) this.pixels[at] = pixel;
      else this.blend(x, y, strength, colour);
    }
    if (bottom > end) this.blend(x, end, strength * (bottom - end), colour);
  }

  private blend(x: number, y: number, share: number, colour: Rgb): void {
    const { bytes } = this;
    const at = 4 * (y * this.width + x);
    const beneath = (bytes[at + 3]! / 255) * (1 - share);
    const alpha = share + beneath;
    for (let i = 0; i < 3; ++i) bytes[at + i] = (share * colour[i]! + beneath * bytes[at + i]!) / alpha;
    bytes[at + 3] = 255 * alpha;
  }
}

const one = new Uint8ClampedArray(4);
const oneAsPixel = new Uint32Array(one.buffer);

/** The four bytes of a pixel as one number, in the order of this machine. */
function pixelOf(colour: Rgb, alpha: number): number {
  one.set(colour);
  one[3] = 255 * alpha;
  return oneAsPixel[0]!;
}

/** Reads a colour of the style sheet, `#rrggbb`. */
export function rgb(hex: string): Rgb {
  const value = Number.parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
