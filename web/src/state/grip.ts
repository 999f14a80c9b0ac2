// SPDX-License-Identifier: Apache-2.0
/** What the controller believes of the hand, in a sentence; empty where it estimates nothing. */
export function gripSentence(grip: number, deviation: number): string {
  if (!(deviation > 0) || !(grip > 0)) return '';
  // A standard deviation of half of the value leaves a quarter open, and twice.
  if (deviation > 0.5 * grip) return 'Your grip: not known yet; it shows when the wall pushes back.';
  return `Your grip: ×${told(grip)} ± ${told(deviation)} as firm as identified.`;
}

function told(factor: number): string {
  return factor < 0.095 ? factor.toFixed(2) : factor.toPrecision(factor < 1 ? 1 : 2);
}
