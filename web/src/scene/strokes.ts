// SPDX-License-Identifier: Apache-2.0
import { palette } from './palette';

/** What both scenes write and draw with. */

export type Context = CanvasRenderingContext2D;

export const font = '13px system-ui, sans-serif';

export function line(context: Context, x1: number, y1: number, x2: number, y2: number): void {
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
}

/** Text that stays readable on what lies under it. */
export function label(context: Context, text: string, x: number, y: number, colour: string, align: CanvasTextAlign): void {
  context.font = font;
  context.fillStyle = colour;
  context.textAlign = align;
  context.strokeStyle = palette.surface;
  context.lineWidth = 3;
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
}

/** From the first point to the second, where its head ends. */
export function arrow(context: Context, x1: number, y1: number, x2: number, y2: number, colour: string): void {
  const length = Math.hypot(x2 - x1, y2 - y1);
  if (length < 1) return;
  const [right, down] = [(x2 - x1) / length, (y2 - y1) / length];
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineWidth = 5;
  line(context, x1, y1, x2 - 8 * right, y2 - 8 * down);
  context.beginPath();
  context.moveTo(x2, y2);
  context.lineTo(x2 - 12 * right - 8 * down, y2 - 12 * down + 8 * right);
  context.lineTo(x2 - 12 * right + 8 * down, y2 - 12 * down - 8 * right);
  context.fill();
}
