// SPDX-License-Identifier: Apache-2.0
/**
 * The range of an axis: it contains a base range and the data, goes beyond the base to round values, grows at once and shrinks only after
 * the data have been smaller for a while, so that the axis does not twitch.
 */
export class StableRange {
  private low: number;
  private high: number;
  private smallerSince_s: number | undefined;

  constructor(
    private readonly baseLow: number,
    private readonly baseHigh: number,
    private readonly shrinkAfter_s = 2,
  ) {
    this.low = baseLow;
    this.high = baseHigh;
  }

  update(dataLow: number, dataHigh: number, now_s: number): readonly [number, number] {
    const [roundLow, roundHigh] = rounded(Math.min(this.baseLow, dataLow), Math.max(this.baseHigh, dataHigh));
    const low = dataLow < this.baseLow ? roundLow : this.baseLow;
    const high = dataHigh > this.baseHigh ? roundHigh : this.baseHigh;
    if (low < this.low || high > this.high) {
      this.low = Math.min(low, this.low);
      this.high = Math.max(high, this.high);
      this.smallerSince_s = undefined;
    } else if (low > this.low || high < this.high) {
      this.smallerSince_s ??= now_s;
      if (now_s - this.smallerSince_s >= this.shrinkAfter_s) {
        this.low = low;
        this.high = high;
        this.smallerSince_s = undefined;
      }
    } else {
      this.smallerSince_s = undefined;
    }
    return [this.low, this.high];
  }
}

/** The range widened to multiples of a round step, about a fifth of it. */
function rounded(low: number, high: number): [number, number] {
  const span = high - low;
  if (!Number.isFinite(span) || span <= 0) return [low, high];
  const magnitude = 10 ** Math.floor(Math.log10(span / 5));
  const step = [1, 2, 5, 10].map((factor) => factor * magnitude).find((candidate) => candidate >= span / 5)!;
  return [step * Math.floor(low / step + 1e-9), step * Math.ceil(high / step - 1e-9)];
}
