import { highest_m, lowest_m } from '../operator/hand';

/** The stretch of the axis that the scene shows, in mm: the reach of the hand and a margin. */
export const first_mm = 1e3 * lowest_m - 1;
export const last_mm = 1e3 * highest_m + 1.5;

export interface Scale {
  readonly pixelsPerMillimetre: number;
  x(position_mm: number): number;
}

export function scaleFor(width: number): Scale {
  const pixelsPerMillimetre = width / (last_mm - first_mm);
  return { pixelsPerMillimetre, x: (position_mm) => (position_mm - first_mm) * pixelsPerMillimetre };
}
