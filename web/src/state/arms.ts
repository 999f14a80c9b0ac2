// SPDX-License-Identifier: Apache-2.0
import type { ServerInfo } from '../protocol/foxglove';

/** What the server tells of a pair of arms (`tactus.arms` in its metadata): enough to draw them from their joints. */

export type Vector = readonly [number, number, number];

export interface ArmJoint {
  readonly name: string;
  /** Of its frame in that of the joint before, at position 0; the rotation row after row. */
  readonly origin_m: Vector;
  readonly rotation: readonly number[];
  /** In its own frame. */
  readonly axis: Vector;
  readonly slides: boolean;
}

export interface Arm {
  readonly joints: readonly ArmJoint[];
  /** The tool's point in the frame of the last joint. */
  readonly tool_m: Vector;
  readonly start_rad: readonly number[];
}

export interface ArmPair {
  readonly leader: Arm;
  readonly follower: Arm;
  /** From where the follower's tool begins. */
  readonly wall_m: number;
  /** Of the hand, and so of the wall, along the axes of the bases: toward it, and two across. */
  readonly directions: readonly [Vector, Vector, Vector];
}

const mostJoints = 8;

/** Undefined where no arms are served, or what is told of them cannot be drawn. */
export function describedArms(info: ServerInfo): ArmPair | undefined {
  let told: unknown;
  try {
    told = JSON.parse(info.metadata['tactus.arms'] ?? 'null');
  } catch {
    return undefined;
  }
  return isPair(told) ? told : undefined;
}

function isPair(told: unknown): told is ArmPair {
  const pair = told as Partial<ArmPair> | null;
  return (
    typeof pair === 'object' &&
    pair !== null &&
    isArm(pair.leader) &&
    isArm(pair.follower) &&
    typeof pair.wall_m === 'number' &&
    Array.isArray(pair.directions) &&
    pair.directions.length === 3 &&
    pair.directions.every((one) => isNumbers(one, 3))
  );
}

function isArm(told: unknown): told is Arm {
  const arm = told as Partial<Arm> | null | undefined;
  if (typeof arm !== 'object' || arm === null || !isNumbers(arm.tool_m, 3)) return false;
  const { joints } = arm;
  if (!Array.isArray(joints) || joints.length === 0 || joints.length > mostJoints) return false;
  return joints.every(isJoint) && isNumbers(arm.start_rad, joints.length);
}

function isJoint(told: Partial<ArmJoint> | null): boolean {
  return told !== null && isNumbers(told.origin_m, 3) && isNumbers(told.rotation, 9) && isNumbers(told.axis, 3);
}

function isNumbers(told: unknown, length: number): boolean {
  return Array.isArray(told) && told.length === length && told.every((one) => Number.isFinite(one));
}
