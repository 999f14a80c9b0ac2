// SPDX-License-Identifier: Apache-2.0
/** Writes CDR, little-endian: the counterpart of `src/protocol/cdr.ts`, written apart from it. */
export class CdrWriter {
  private bytes = new Uint8Array(4096);
  private view = new DataView(this.bytes.buffer);
  private end = 4;

  constructor() {
    this.bytes[1] = 1;
  }

  finish(): Uint8Array {
    return this.bytes.slice(0, this.end);
  }

  float64(value: number): this {
    const at = this.reserve(8, 8);
    this.view.setFloat64(at, value, true);
    return this;
  }

  uint64(value: number): this {
    const at = this.reserve(8, 8);
    this.view.setBigUint64(at, BigInt(value), true);
    return this;
  }

  uint32(value: number): this {
    const at = this.reserve(4, 4);
    this.view.setUint32(at, value, true);
    return this;
  }

  bool(value: boolean): this {
    const at = this.reserve(1, 1);
    this.view.setUint8(at, value ? 1 : 0);
    return this;
  }

  string(value: string): this {
    const text = new TextEncoder().encode(value);
    this.uint32(text.length + 1);
    const at = this.reserve(1, text.length + 1);
    this.bytes.set(text, at);
    return this;
  }

  float32s(values: ArrayLike<number>): this {
    this.uint32(values.length);
    if (values.length === 0) return this;
    const at = this.reserve(4, 4 * values.length);
    for (let i = 0; i < values.length; ++i) this.view.setFloat32(at + 4 * i, values[i]!, true);
    return this;
  }

  private reserve(alignment: number, size: number): number {
    const past = (this.end - 4) % alignment;
    const at = this.end + (past === 0 ? 0 : alignment - past);
    this.end = at + size;
    while (this.end > this.bytes.length) {
      const larger = new Uint8Array(2 * this.bytes.length);
      larger.set(this.bytes);
      this.bytes = larger;
      this.view = new DataView(larger.buffer);
    }
    return at;
  }
}
