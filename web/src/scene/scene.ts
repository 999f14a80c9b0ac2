import { palette } from './palette';
import { first_mm, last_mm, scaleFor, type Scale } from './scale';

/** What one scene shows; positions in mm, forces in N. A range is what was covered in the last moments. */
export interface SceneContent {
  readonly hand_mm: number;
  readonly engaged: boolean;
  readonly master_mm: readonly [number, number];
  readonly slave_mm: readonly [number, number];
  readonly wall_mm: number;
  /** Greatest force in the last moments, pushing the hand back and the slave back. */
  readonly displayed_N: number;
  readonly contact_N: number;
  readonly rings: boolean;
  /** Whether to tell the visitor that the handle can be dragged. */
  readonly hint: boolean;
}

export const sceneHeight = 236;
const masterLane = 72;
const slaveLane = 152;
const axisTop = 200;
const font = '13px system-ui, sans-serif';
const smallFont = '12px system-ui, sans-serif';
const arrowPixelsPerNewton = 46;

type Context = CanvasRenderingContext2D;

/** Draws hand, master, slave and wall on one axis in mm. */
export function drawScene(context: Context, width: number, content: SceneContent): void {
  const scale = scaleFor(width);
  context.clearRect(0, 0, width, sceneHeight);
  context.lineJoin = 'round';
  context.lineCap = 'round';
  context.textBaseline = 'middle';
  drawAxis(context, width, scale);
  drawWall(context, width, scale, content.wall_mm);
  drawLink(context, scale, content);
  drawMaster(context, width, scale, content);
  drawSlave(context, width, scale, content);
}

/** Fits a canvas to its width on the page and returns that width. */
export function fitCanvas(canvas: HTMLCanvasElement, context: Context): number {
  const width = canvas.clientWidth;
  const ratio = window.devicePixelRatio;
  const pixels = Math.round(width * ratio);
  if (canvas.width !== pixels || canvas.height !== Math.round(sceneHeight * ratio)) {
    canvas.width = pixels;
    canvas.height = Math.round(sceneHeight * ratio);
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return width;
}

function line(context: Context, x1: number, y1: number, x2: number, y2: number): void {
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
}

function roundRect(context: Context, x: number, y: number, width: number, height: number, radius: number): void {
  context.beginPath();
  context.roundRect(x, y, width, height, radius);
}

function label(context: Context, text: string, x: number, y: number, colour: string, align: CanvasTextAlign): void {
  context.font = font;
  context.fillStyle = colour;
  context.textAlign = align;
  context.fillText(text, x, y);
}

function drawAxis(context: Context, width: number, scale: Scale): void {
  context.strokeStyle = palette.muted;
  context.lineWidth = 1;
  line(context, 0, axisTop, width, axisTop);
  context.font = smallFont;
  context.fillStyle = palette.muted;
  context.textAlign = 'center';
  for (let mm = Math.ceil(first_mm); mm <= last_mm; ++mm) {
    const x = Math.round(scale.x(mm)) + 0.5;
    line(context, x, axisTop, x, axisTop + (mm % 5 === 0 ? 8 : 4));
    if (mm % 5 === 0) context.fillText(mm === 0 ? '0 mm' : String(mm).replace('-', '−'), x, axisTop + 19);
  }
}

function drawWall(context: Context, width: number, scale: Scale, wall_mm: number): void {
  const x = scale.x(wall_mm);
  const top = slaveLane - 40;
  const height = axisTop - top;
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
  for (let at = x - height; at < width; at += 9) line(context, at, axisTop, at + height, top);
  context.restore();
  context.strokeStyle = palette.wall;
  context.lineWidth = 3;
  line(context, x, top, x, axisTop);
  context.lineWidth = 1;
  context.setLineDash([3, 5]);
  line(context, x, masterLane - 34, x, top);
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
function drawLink(context: Context, scale: Scale, content: SceneContent): void {
  const from = scale.x((content.master_mm[0] + content.master_mm[1]) / 2);
  const to = scale.x((content.slave_mm[0] + content.slave_mm[1]) / 2) - 16;
  context.strokeStyle = palette.grid;
  context.lineWidth = 2;
  context.setLineDash([2, 5]);
  line(context, from, masterLane + 30, to, slaveLane - 16);
  context.setLineDash([]);
}

function drawRail(context: Context, width: number, y: number): void {
  context.strokeStyle = palette.grid;
  context.lineWidth = 4;
  line(context, 0, y, width, y);
}

/** A force as an arrow that pushes to the left, from `x`; none for what would read 0.0 N. */
function drawForce(context: Context, x: number, y: number, force_N: number): void {
  if (force_N < 0.05) return;
  const length = Math.min(90, 10 + force_N * arrowPixelsPerNewton);
  context.strokeStyle = palette.force;
  context.fillStyle = palette.force;
  context.lineWidth = 5;
  line(context, x, y, x - length + 8, y);
  context.beginPath();
  context.moveTo(x - length, y);
  context.lineTo(x - length + 12, y - 8);
  context.lineTo(x - length + 12, y + 8);
  context.fill();
  label(context, `${force_N.toFixed(1)} N`, x - length - 6, y, palette.force, 'right');
}

function drawMaster(context: Context, width: number, scale: Scale, content: SceneContent): void {
  drawRail(context, width, masterLane);
  label(context, 'your hand on the master', 8, 10, palette.muted, 'left');
  const [low, high] = content.master_mm;
  const x = scale.x((low + high) / 2);
  drawForce(context, x - 20, masterLane + 24, content.displayed_N);
  drawBand(context, scale.x(low) - 13, scale.x(high) + 13, masterLane, 30, content.rings ? palette.bad : palette.master);
  drawFist(context, x, masterLane, palette.master, 1);
  if (content.engaged) {
    context.strokeStyle = palette.intended;
    context.lineWidth = 2.5;
    roundRect(context, scale.x(content.hand_mm) - 18, masterLane - 35, 36, 70, 12);
    context.stroke();
  }
  if (content.rings) drawTremble(context, scale.x(low) - 24, scale.x(high) + 24, masterLane);
  if (content.hint) label(context, '◀  drag me  ▶', x, masterLane - 44, palette.text, 'center');
}

/** The stretch that a moving thing covered in the last moments: what vibrates too fast to be seen shows as a blur. */
function drawBand(context: Context, from: number, to: number, y: number, half: number, colour: string): void {
  context.globalAlpha = 0.28;
  context.fillStyle = colour;
  roundRect(context, from, y - half, to - from, 2 * half, 8);
  context.fill();
  context.globalAlpha = 1;
}

function drawFist(context: Context, x: number, y: number, colour: string, alpha: number): void {
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  roundRect(context, x - 6, y - 32, 12, 64, 5);
  context.fill();
  context.fillStyle = palette.surface;
  context.strokeStyle = colour;
  context.lineWidth = 2;
  for (let finger = 0; finger < 4; ++finger) {
    roundRect(context, x - 13, y - 23 + 12 * finger, 26, 11, 5);
    context.fill();
    context.stroke();
  }
  context.globalAlpha = 1;
}

function drawTremble(context: Context, left: number, right: number, y: number): void {
  context.strokeStyle = palette.bad;
  context.lineWidth = 2;
  for (const [x, direction] of [
    [left, -1],
    [right, 1],
  ] as const) {
    for (const step of [0, 7]) {
      context.beginPath();
      context.moveTo(x + direction * step, y - 14);
      context.quadraticCurveTo(x + direction * (step + 7), y, x + direction * step, y + 14);
      context.stroke();
    }
  }
}

function drawSlave(context: Context, width: number, scale: Scale, content: SceneContent): void {
  drawRail(context, width, slaveLane);
  label(context, 'robot (slave)', 8, slaveLane - 32, palette.muted, 'left');
  const [low, high] = content.slave_mm;
  const tip = scale.x((low + high) / 2);
  drawForce(context, tip - 44, slaveLane + 30, content.contact_N);
  drawBand(context, scale.x(low) - 10, scale.x(high), slaveLane, 20, content.rings ? palette.bad : palette.slave);
  context.fillStyle = palette.slave;
  roundRect(context, tip - 46, slaveLane - 18, 32, 36, 5);
  context.fill();
  context.beginPath();
  context.moveTo(tip - 16, slaveLane - 10);
  context.lineTo(tip, slaveLane - 4);
  context.lineTo(tip, slaveLane + 4);
  context.lineTo(tip - 16, slaveLane + 10);
  context.fill();
}
