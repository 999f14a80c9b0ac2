// SPDX-License-Identifier: Apache-2.0
import type { Side } from '../kernel/kernel';

export interface Setting {
  readonly side: Side;
  readonly key: string;
  readonly value: number | string | boolean;
}

/** From a figure to the thread that runs its loops; done in this order. */
export interface Order {
  readonly settings?: readonly Setting[];
  /** Both loops start again after `settings`. */
  readonly fresh?: boolean;
  readonly aim_m?: number;
  readonly tap?: boolean;
  /** Of the time in the loops to that of the clock. */
  readonly speed?: number;
  readonly run?: boolean;
}

/** Back: one of these. */
export interface Report {
  readonly ready?: { readonly cycle_s: number; readonly tapStart_m: number };
  readonly rows?: Float64Array<ArrayBuffer>;
  readonly failed?: string;
}
