import type { Envelope } from './envelope';

/** A colour as the bytes of a pixel. */
export type Rgb = readonly [red: number, green: number, blue: number];

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
    for (let x = 0; x < this.width; ++x) {
      if (envelope.low[x]! > envelope.high[x]!) continue;
      const top = (high - envelope.high[x]!) * pixelsPerUnit - thickness / 2;
      const bottom = (high - envelope.low[x]!) * pixelsPerUnit + thickness / 2;
      this.fillColumn(x, Math.max(0, top), Math.min(this.height, bottom), colour);
    }
  }

  /** A pixel that is covered in part, at either end, gets a part of the colour. */
  private fillColumn(x: number, top: number, bottom: number, colour: Rgb): void {
    const full = Math.ceil(top);
    const end = Math.floor(bottom);
    if (full > top) this.blend(x, full - 1, Math.min(full, bottom) - top, colour);
    if (full > end) return;
    const { pixels, bytes, width } = this;
    let at = full * width + x;
    if (full < end) {
      bytes.set(colour, 4 * at);
      bytes[4 * at + 3] = 255;
      const pixel = pixels[at]!;
      for (let y = full; y < end; ++y, at += width) pixels[at] = pixel;
    }
    if (bottom > end) this.blend(x, end, bottom - end, colour);
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

/** Reads a colour of the style sheet, `#rrggbb`. */
export function rgb(hex: string): Rgb {
  const value = Number.parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
