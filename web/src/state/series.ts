// SPDX-License-Identifier: Apache-2.0
/**
 * The last `capacity` rows of a few signals over time, in memory that is allocated once. Rows are appended at the end of
 * arrays twice that size and moved to the front when the end is reached, so that every view is one contiguous piece.
 */
export class SlidingSeries {
  private readonly time: Float64Array;
  private readonly values: readonly Float32Array[];
  private end = 0;

  constructor(
    private readonly capacity: number,
    signals: number,
  ) {
    this.time = new Float64Array(2 * capacity);
    this.values = Array.from({ length: signals }, () => new Float32Array(2 * capacity));
  }

  get length(): number {
    return Math.min(this.end, this.capacity);
  }

  /** Time of the newest row, or negative infinity. */
  get latest(): number {
    return this.end === 0 ? -Infinity : this.time[this.end - 1]!;
  }

  clear(): void {
    this.end = 0;
  }

  /** Begins a row; its signals are set with `set`. */
  add(time: number): void {
    if (this.end === 2 * this.capacity) this.moveToFront();
    this.time[this.end] = time;
    this.end += 1;
  }

  /** Sets a signal of the newest row. */
  set(signal: number, value: number): void {
    this.values[signal]![this.end - 1] = value;
  }

  /** Time and signals of the rows that are kept, without a copy: good until the next `add`. */
  views(): [Float64Array, ...Float32Array[]] {
    const begin = this.end - this.length;
    return [this.time.subarray(begin, this.end), ...this.values.map((values) => values.subarray(begin, this.end))];
  }

  /** Least and greatest number of a signal since a time; an empty range is `[Infinity, -Infinity]`. */
  extremes(signal: number, since: number): [number, number] {
    const values = this.values[signal]!;
    let low = Infinity;
    let high = -Infinity;
    for (let i = this.end - 1; i >= this.end - this.length && this.time[i]! >= since; --i) {
      const value = values[i]!;
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return [low, high];
  }

  private moveToFront(): void {
    this.time.copyWithin(0, this.capacity);
    for (const values of this.values) values.copyWithin(0, this.capacity);
    this.end = this.capacity;
  }
}
