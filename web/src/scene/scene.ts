// SPDX-License-Identifier: Apache-2.0
import { palette } from './palette';
import { first_mm, last_mm, scaleFor, type Scale } from './scale';
import { arrow, font, label, line, type Context } from './strokes';

/** What one scene shows; positions in mm, forces in N. A range is what was covered in the last moments. */
export interface SceneContent {
  readonly hand_mm: number;
  readonly engaged: boolean;
  readonly master_mm: readonly [number, number];
  readonly slave_mm: readonly [number, number];
  readonly wall_mm: number;
  /** Greatest force in the last moments, pushing the hand back and the slave back. */
  readonly displayed_N: number;
  /** Whether the motor displayed as much as it may. */
  readonly clips: boolean;
  readonly contact_N: number;
  readonly rings: boolean;
  /** Whether to tell the visitor that the handle can be dragged. */
  readonly hint: boolean;
}

/** Heights in pixels; `grow` is how large things are drawn. */
export interface Layout {
  readonly height: number;
  readonly master: number;
  readonly slave: number;
  readonly axis: number;
  readonly grow: number;
}
export const roomy: Layout = { height: 236, master: 72, slave: 152, axis: 200, grow: 1 };
export const compact: Layout = { height: 146, master: 40, slave: 93, axis: 119, grow: 0.6 };
const smallFont = '12px system-ui, sans-serif';
const arrowPixelsPerNewton = 46;

/** Draws hand, master, slave and wall on one axis in mm. */
export function drawScene(context: Context, width: number, layout: Layout, content: SceneContent): void {
  const scale = scaleFor(width);
  context.clearRect(0, 0, width, layout.height);
  context.lineJoin = 'round';
  context.lineCap = 'round';
  context.textBaseline = 'middle';
  drawAxis(context, width, layout, scale);
  drawWall(context, width, layout, scale, content.wall_mm);
  drawLink(context, layout, scale, content);
  drawMaster(context, width, layout, scale, content);
  drawSlave(context, width, layout, scale, content);
}

/** Fits a canvas to its width on the page and returns that width. */
export function fitCanvas(canvas: HTMLCanvasElement, context: Context, height: number): number {
  const width = canvas.clientWidth;
  const ratio = window.devicePixelRatio;
  const pixels = Math.round(width * ratio);
  if (canvas.width !== pixels || canvas.height !== Math.round(height * ratio)) {
    canvas.style.height = `${height}px`;
    canvas.width = pixels;
    canvas.height = Math.round(height * ratio);
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return width;
}

function roundRect(context: Context, x: number, y: number, width: number, height: number, radius: number): void {
  context.beginPath();
  context.roundRect(x, y, width, height, radius);
}

function drawAxis(context: Context, width: number, { axis }: Layout, scale: Scale): void {
  context.strokeStyle = palette.muted;
  context.lineWidth = 1;
  line(context, 0, axis, width, axis);
  context.font = smallFont;
  context.fillStyle = palette.muted;
  context.textAlign = 'center';
  for (let mm = Math.ceil(first_mm); mm <= last_mm; ++mm) {
    const x = Math.round(scale.x(mm)) + 0.5;
    line(context, x, axis, x, axis + (mm % 5 === 0 ? 8 : 4));
    if (mm % 5 === 0) context.fillText(mm === 0 ? '0 mm' : String(mm).replace('-', '−'), x, axis + 19);
  }
}

function drawWall(context: Context, width: number, layout: Layout, scale: Scale, wall_mm: number): void {
  const { axis, master, slave, grow } = layout;
  const x = scale.x(wall_mm);
  const top = slave - 40 * grow;
  const height = axis - top;
  context.save();
  context.beginPath();
  context.rect(x, top, width - x, height);
  context.clip();
  context.globalAlpha = 0.18;
  context.fillStyle = palette.wall;
  context.fill();
  context.globalAlpha = 0.6;
  context.strokeStyle = palette.wall;
  context.lineWidth = 1;
  for (let at = x - height; at < width; at += 9) line(context, at, axis, at + height, top);
  context.restore();
  context.strokeStyle = palette.wall;
  context.lineWidth = 3;
  line(context, x, top, x, axis);
  context.lineWidth = 1;
  context.setLineDash([3, 5]);
  line(context, x, master - 34 * grow, x, top);
  context.setLineDash([]);
  const text = 'wall';
  context.font = font;
  const wide = context.measureText(text).width + 10;
  context.fillStyle = palette.surface;
  roundRect(context, x + 8, top + 6, wide, 19, 4);
  context.fill();
  label(context, text, x + 13, top + 16, palette.text, 'left');
}

/** The dashed line says: this position goes there. */
function drawLink(context: Context, { master, slave, grow }: Layout, scale: Scale, content: SceneContent): void {
  const from = scale.x((content.master_mm[0] + content.master_mm[1]) / 2);
  const to = scale.x((content.slave_mm[0] + content.slave_mm[1]) / 2) - 16;
  context.strokeStyle = palette.grid;
  context.lineWidth = 2;
  context.setLineDash([2, 5]);
  line(context, from, master + 30 * grow, to, slave - 16 * grow);
  context.setLineDash([]);
}

function drawRail(context: Context, width: number, y: number): void {
  context.strokeStyle = palette.grid;
  context.lineWidth = 4;
  line(context, 0, y, width, y);
}

/** A force as an arrow that pushes to the left, from `x`; none for what would read 0.0 N. */
function drawForce(context: Context, x: number, y: number, force_N: number, remark = ''): void {
  if (force_N < 0.05) return;
  const length = Math.min(90, 10 + force_N * arrowPixelsPerNewton);
  arrow(context, x, y, x - length, y, palette.force);
  label(context, `${force_N.toFixed(1)} N${remark}`, x - length - 6, y, palette.force, 'right');
}

function drawMaster(context: Context, width: number, layout: Layout, scale: Scale, content: SceneContent): void {
  const { master: y, grow } = layout;
  drawRail(context, width, y);
  const [low, high] = content.master_mm;
  const x = scale.x((low + high) / 2);
  if (content.hint) label(context, '◀  drag me  ▶', x, y - 44 * grow, palette.text, 'center');
  if (!content.hint || layout === roomy) label(context, 'your hand on the master', 8, 10, palette.muted, 'left');
  drawForce(context, x - 20, y + 24 * grow, content.displayed_N, content.clips ? ', its limit' : '');
  drawBand(context, scale.x(low) - 13, scale.x(high) + 13, y, 30 * grow, content.rings ? palette.bad : palette.master);
  drawFist(context, x, y, grow);
  if (content.engaged) {
    context.strokeStyle = palette.intended;
    context.lineWidth = 2.5;
    roundRect(context, scale.x(content.hand_mm) - 18, y - 35 * grow, 36, 70 * grow, 12 * grow);
    context.stroke();
  }
  if (content.rings) drawTremble(context, scale.x(low) - 24, scale.x(high) + 24, y, grow);
}

/** The stretch that a moving thing covered in the last moments: what vibrates too fast to be seen shows as a blur. */
function drawBand(context: Context, from: number, to: number, y: number, half: number, colour: string): void {
  context.globalAlpha = 0.28;
  context.fillStyle = colour;
  roundRect(context, from, y - half, to - from, 2 * half, 8);
  context.fill();
  context.globalAlpha = 1;
}

function drawFist(context: Context, x: number, y: number, grow: number): void {
  context.fillStyle = palette.master;
  roundRect(context, x - 6, y - 32 * grow, 12, 64 * grow, 5 * grow);
  context.fill();
  context.fillStyle = palette.surface;
  context.strokeStyle = palette.master;
  context.lineWidth = 2;
  for (let finger = 0; finger < 4; ++finger) {
    roundRect(context, x - 13, y + (12 * finger - 23) * grow, 26, 11 * grow, 5 * grow);
    context.fill();
    context.stroke();
  }
}

function drawTremble(context: Context, left: number, right: number, y: number, grow: number): void {
  context.strokeStyle = palette.bad;
  context.lineWidth = 2;
  for (const [x, direction] of [
    [left, -1],
    [right, 1],
  ] as const) {
    for (const step of [0, 7]) {
      context.beginPath();
      context.moveTo(x + direction * step, y - 14 * grow);
      context.quadraticCurveTo(x + direction * (step + 7), y, x + direction * step, y + 14 * grow);
      context.stroke();
    }
  }
}

function drawSlave(context: Context, width: number, layout: Layout, scale: Scale, content: SceneContent): void {
  const { slave: y, grow } = layout;
  drawRail(context, width, y);
  label(context, 'robot (slave)', 8, y - 12 - 20 * grow, palette.muted, 'left');
  const [low, high] = content.slave_mm;
  const tip = scale.x((low + high) / 2);
  drawForce(context, tip - 44, y + 30 * grow, content.contact_N);
  drawBand(context, scale.x(low) - 10, scale.x(high), y, 20 * grow, content.rings ? palette.bad : palette.slave);
  context.fillStyle = palette.slave;
  roundRect(context, tip - 46, y - 18 * grow, 32, 36 * grow, 5 * grow);
  context.fill();
  context.beginPath();
  context.moveTo(tip - 16, y - 10 * grow);
  context.lineTo(tip, y - 4 * grow);
  context.lineTo(tip, y + 4 * grow);
  context.lineTo(tip - 16, y + 10 * grow);
  context.fill();
}
