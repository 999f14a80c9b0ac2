// SPDX-License-Identifier: Apache-2.0
/** The stretch of the axis that the scene shows, in mm: the reach of the visitor's hand, and that of the scripted tap. */
export const first_mm = -6;
export const last_mm = 19;

export interface Scale {
  readonly pixelsPerMillimetre: number;
  x(position_mm: number): number;
}

export function scaleFor(width: number): Scale {
  const pixelsPerMillimetre = width / (last_mm - first_mm);
  return { pixelsPerMillimetre, x: (position_mm) => (position_mm - first_mm) * pixelsPerMillimetre };
}
