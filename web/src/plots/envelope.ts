// SPDX-License-Identifier: Apache-2.0
/** What a line covers in each column of pixels: nothing is lost between two columns, and nothing is drawn twice. */
export interface Envelope {
  /** Least and greatest value of the line in each column; a column that it does not cross has low above high. */
  readonly low: Float32Array;
  readonly high: Float32Array;
  /** How far the line goes up and down in each column: high above low times as often as it crosses the column. */
  readonly travel: Float32Array;
}

export function makeEnvelope(columns: number): Envelope {
  return {
    low: new Float32Array(columns).fill(Infinity),
    high: new Float32Array(columns).fill(-Infinity),
    travel: new Float32Array(columns),
  };
}

/**
 * Finds the envelope of the line through points in order of time, from `from` to `to` over its columns. A point that is
 * not a number breaks the line.
 */
export function findEnvelope(
  time: Float64Array,
  values: Float32Array,
  from: number,
  to: number,
  { low, high, travel }: Envelope,
): void {
  const columns = low.length;
  const columnsPerUnit = columns / (to - from);
  low.fill(Infinity);
  high.fill(-Infinity);
  travel.fill(0);
  const cover = (column: number, a: number, b: number): void => {
    if (Math.min(a, b) < low[column]!) low[column] = Math.min(a, b);
    if (Math.max(a, b) > high[column]!) high[column] = Math.max(a, b);
    travel[column]! += Math.abs(a - b);
  };
  const first = Math.max(1, firstSince(time, from));
  for (let i = first; i < time.length; ++i) {
    const y1 = values[i - 1]!;
    const y2 = values[i]!;
    if (Number.isNaN(y1) || Number.isNaN(y2)) continue;
    const x1 = (time[i - 1]! - from) * columnsPerUnit;
    const x2 = (time[i]! - from) * columnsPerUnit;
    const begin = Math.max(0, Math.floor(x1));
    const end = Math.min(columns - 1, Math.floor(x2));
    if (begin === end && x1 >= 0 && x2 < columns) {
      cover(begin, y1, y2);
      continue;
    }
    const slope = (y2 - y1) / (x2 - x1);
    for (let column = begin; column <= end; ++column) {
      cover(column, y1 + slope * (Math.max(x1, column) - x1), y1 + slope * (Math.min(x2, column + 1) - x1));
    }
  }
}

/** Index of the first time that is not before `since`. */
function firstSince(time: Float64Array, since: number): number {
  let [begin, end] = [0, time.length];
  while (begin < end) {
    const middle = (begin + end) >> 1;
    if (time[middle]! < since) begin = middle + 1;
    else end = middle;
  }
  return begin;
}
