// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera, Vector3 } from 'three';
import type { HandPoint } from '../operator/hand';
import type { ArmsState } from '../protocol/messages';
import type { ArmPair } from '../state/arms';
import { ArmModel, type Capsule } from './arm_model';
import { palette } from './palette';
import { arrow, label, type Context } from './strokes';

/** What beside the arms is drawn. Forces are the greatest of the last moments, in N. */
export interface ArmContent {
  readonly arms: ArmsState | undefined;
  readonly engaged: boolean;
  readonly displayed_N: number;
  readonly contact_N: number;
  readonly rings: boolean;
  /** Whether to tell the visitor that the hand can be dragged. */
  readonly hint: boolean;
}

/** How many times its size the induced motion is drawn. */
export const magnified = 20;
/** What would read 0.0 N has no arrow. */
const leastForce_N = 0.05;
const metresPerNewton = 0.014;
const shortestArrow_m = 0.04;
const longestArrow_m = 0.22;
const wallHalf_m = 0.13;
const margin_m = 0.06;
const fieldOfView_deg = 30;
const baseUp = new Vector3(0, 0, 1);

type Pixel = readonly [x: number, y: number];
type Shape = { readonly depth: number; draw(): void };

function vector(values: ArrayLike<number>): Vector3 {
  return new Vector3(values[0], values[1], values[2]);
}

/**
 * Both arms of a loop in 3-D, leader and follower beside each other. Scene and camera are three's; what they show is
 * painted on a plain canvas, for a capsule's picture is a stroke with round ends: that needs no graphics card.
 */
export class ArmScene {
  private readonly camera = new PerspectiveCamera(fieldOfView_deg, 1, 0.05, 20);
  private readonly leader: ArmModel;
  private readonly follower: ArmModel;
  private readonly directions: readonly [Vector3, Vector3, Vector3];
  private readonly wall: readonly Vector3[];
  private readonly centre: Vector3;
  private readonly view: Vector3;
  /** Half of the room that all takes, in the picture and toward who looks, in m. */
  private readonly half: { readonly right: number; readonly up: number; readonly near: number };
  private width = 1;
  private height = 1;

  constructor(pair: ArmPair) {
    this.leader = new ArmModel(pair.leader);
    this.follower = new ArmModel(pair.follower);
    const [toward, up, side] = pair.directions;
    this.directions = [vector(toward), vector(up), vector(side)];
    this.leader.place();
    this.follower.place();
    const ahead = this.follower.tool.clone().setZ(0);
    if (ahead.length() < 0.05) ahead.set(1, 0, 0);
    ahead.normalize();
    const across = new Vector3().crossVectors(baseUp, ahead);
    this.view = new Vector3().addScaledVector(across, -0.85).addScaledVector(ahead, 0.8).addScaledVector(baseUp, 0.5).normalize();
    const right = new Vector3().crossVectors(baseUp, this.view).normalize();
    const ends = [...this.leader.capsules, ...this.follower.capsules].map(({ to }) => to.length());
    const reach_m = Math.max(0.2, ...ends);
    const apart = 0.72 * reach_m;
    this.leader.root.position.copy(right).multiplyScalar(-0.5 * apart);
    this.follower.root.position.copy(right).multiplyScalar(0.5 * apart);
    this.leader.place();
    this.follower.place();
    const middle = this.follower.tool.clone().addScaledVector(this.directions[0], pair.wall_m);
    this.wall = [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
    ].map(([u, v]) =>
      middle.clone().addScaledVector(this.directions[1], u! * wallHalf_m).addScaledVector(this.directions[2], v! * wallHalf_m),
    );

    const above = new Vector3().crossVectors(this.view, right);
    const seen = [...this.leader.capsules, ...this.follower.capsules].flatMap(({ from, to }) => [from, to]).concat(this.wall);
    const extent = (along: Vector3): readonly [middle: number, half: number] => {
      const all = seen.map((one) => one.dot(along));
      const [low, high] = [Math.min(...all), Math.max(...all)];
      return [0.5 * (low + high), 0.5 * (high - low)];
    };
    const [middleRight, halfRight] = extent(right);
    const [middleUp, halfUp] = extent(above);
    const [middleNear, halfNear] = extent(this.view);
    this.centre = new Vector3()
      .addScaledVector(right, middleRight)
      .addScaledVector(above, middleUp)
      .addScaledVector(this.view, middleNear);
    this.half = { right: halfRight + margin_m, up: halfUp + margin_m, near: halfNear };
  }

  /** How far a drag in the plane of the picture moves the hand, along its directions. */
  dragged_m(right: number, down: number): HandPoint {
    const perPixel = 1 / this.pixelsPerMetre(this.leader.tool);
    const x = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const y = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const moved = x.multiplyScalar(right * perPixel).addScaledVector(y, -down * perPixel);
    const [toward, up, side] = this.directions;
    return [moved.dot(toward), moved.dot(up), moved.dot(side)];
  }

  /** Draws all of it, and returns where the leader's tool is in the picture. */
  draw(context: Context, width: number, height: number, content: ArmContent): Pixel {
    this.fit(width, height);
    const { arms } = content;
    this.leader.place(arms?.leader_rad);
    this.follower.place(arms?.follower_rad);
    context.clearRect(0, 0, width, height);
    context.lineCap = 'round';
    context.lineJoin = 'round';
    context.textBaseline = 'middle';
    const shapes = [
      this.surface(context),
      ...this.leader.capsules.map((link) => this.link(context, link, content.rings ? palette.bad : palette.master)),
      ...this.follower.capsules.map((link) => this.link(context, link, content.rings ? palette.bad : palette.slave)),
    ];
    for (const { draw } of shapes.sort((a, b) => b.depth - a.depth)) draw();
    const tool = this.pixel(this.leader.tool);
    if (arms && content.engaged) this.drawTarget(context, vector(arms.hand_m));
    if (arms) this.drawInduced(context, tool, vector(arms.induced_m));
    const away = this.directions[0].clone().negate();
    const back = arms && vector(arms.displayed_N).length() > leastForce_N ? vector(arms.displayed_N).normalize() : away;
    this.drawForce(context, this.leader.tool, back, content.displayed_N);
    this.drawForce(context, this.follower.tool, away, content.contact_N);
    label(context, content.hint ? 'drag the hand of this arm' : 'your hand on the leader', 8, 12, palette.muted, 'left');
    label(context, 'robot (follower)', width - 8, 12, palette.muted, 'right');
    return tool;
  }

  /** Both arms in the picture, however wide it is. */
  private fit(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    const half = Math.tan((fieldOfView_deg * Math.PI) / 360);
    this.camera.aspect = this.width / this.height;
    const room = Math.max(this.half.up, this.half.right / this.camera.aspect);
    this.camera.up.copy(baseUp);
    this.camera.position.copy(this.centre).addScaledVector(this.view, this.half.near + room / half);
    this.camera.lookAt(this.centre);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld(true);
  }

  private depth(place: Vector3): number {
    return -place.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
  }

  private pixelsPerMetre(place: Vector3): number {
    return this.height / (2 * this.depth(place) * Math.tan((fieldOfView_deg * Math.PI) / 360));
  }

  private pixel(place: Vector3): Pixel {
    const at = place.clone().project(this.camera);
    return [0.5 * (1 + at.x) * this.width, 0.5 * (1 - at.y) * this.height];
  }

  private surface(context: Context): Shape {
    const corners = this.wall.map((corner) => this.pixel(corner));
    const depth = Math.max(...this.wall.map((corner) => this.depth(corner)));
    const draw = (): void => {
      context.beginPath();
      corners.forEach(([x, y], index) => (index === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
      context.closePath();
      context.globalAlpha = 0.25;
      context.fillStyle = palette.wall;
      context.fill();
      context.globalAlpha = 1;
      context.strokeStyle = palette.wall;
      context.lineWidth = 1.5;
      context.stroke();
    };
    return { depth, draw };
  }

  /** A capsule: its outline, itself, and light from above. */
  private link(context: Context, { from, to, radius_m }: Capsule, colour: string): Shape {
    const [x1, y1] = this.pixel(from);
    const [x2, y2] = this.pixel(to);
    const middle = from.clone().add(to).multiplyScalar(0.5);
    const wide = 2 * radius_m * this.pixelsPerMetre(middle);
    const stroke = (style: string, width: number, up: number): void => {
      context.strokeStyle = style;
      context.lineWidth = width;
      context.beginPath();
      context.moveTo(x1, y1 - up);
      context.lineTo(x2 + 1e-3, y2 - up);
      context.stroke();
    };
    const draw = (): void => {
      stroke(palette.surface, wide + 3, 0);
      stroke(colour, wide, 0);
      context.globalAlpha = 0.3;
      stroke('#ffffff', 0.3 * wide, 0.2 * wide);
      context.globalAlpha = 1;
    };
    return { depth: this.depth(middle), draw };
  }

  private drawTarget(context: Context, hand_m: Vector3): void {
    const at = this.leader.root.position.clone().add(hand_m);
    const [x, y] = this.pixel(at);
    context.strokeStyle = palette.intended;
    context.lineWidth = 2.5;
    context.beginPath();
    context.arc(x, y, 0.03 * this.pixelsPerMetre(at), 0, 2 * Math.PI);
    context.stroke();
  }

  private drawInduced(context: Context, [x, y]: Pixel, induced_m: Vector3): void {
    const end = this.leader.tool.clone().addScaledVector(induced_m, magnified);
    const [toX, toY] = this.pixel(end);
    if (Math.hypot(toX - x, toY - y) < 6) return;
    context.strokeStyle = palette.induced;
    context.lineWidth = 3;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(toX, toY);
    context.stroke();
    label(context, `induced × ${magnified}`, x - 8, y + 20, palette.induced, 'right');
  }

  private drawForce(context: Context, at: Vector3, direction: Vector3, force_N: number): void {
    if (force_N < leastForce_N) return;
    const length = Math.min(longestArrow_m, shortestArrow_m + metresPerNewton * force_N);
    const [x, y] = this.pixel(at);
    const [toX, toY] = this.pixel(at.clone().addScaledVector(direction, length));
    arrow(context, x, y, toX, toY, palette.force);
    label(context, `${force_N.toFixed(1)} N`, toX + 10, toY, palette.force, 'left');
  }
}
