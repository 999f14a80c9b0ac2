// SPDX-License-Identifier: Apache-2.0
import { Group, Matrix4, Vector3 } from 'three';
import type { Arm, Vector } from '../state/arms';

/** Thickness of the first link over the arm's length, and of the last one over the first. */
const thick = 0.05;
const taper = 0.55;

/** A link as a capsule, in the scene: from a joint to the next, the last to the tool. */
export interface Capsule {
  readonly from: Vector3;
  readonly to: Vector3;
  readonly radius_m: number;
}

/** An arm from the frames of its joints. */
export class ArmModel {
  readonly root = new Group();
  readonly capsules: readonly Capsule[];
  private readonly joints: readonly { readonly group: Group; readonly axis: Vector3; readonly slides: boolean }[];
  private readonly ends: readonly { readonly group: Group; readonly end: Vector3 }[];

  constructor(private readonly arm: Arm) {
    let frame = this.root;
    this.joints = arm.joints.map(({ origin_m, rotation, axis, slides }) => {
      const mounted = new Group();
      mounted.applyMatrix4(mounting(origin_m, rotation));
      const group = new Group();
      frame.add(mounted.add(group));
      frame = group;
      return { group, axis: new Vector3(...axis).normalize(), slides: slides === true };
    });
    const groups = [this.root, ...this.joints.map(({ group }) => group)];
    const locals = [...arm.joints.map(({ origin_m }) => origin_m), arm.tool_m];
    this.ends = groups.map((group, index) => ({ group, end: new Vector3(...locals[index]!) }));
    const length = this.ends.reduce((sum, { end }) => sum + end.length(), 0);
    this.capsules = this.ends.map((_end, index) => ({
      from: new Vector3(),
      to: new Vector3(),
      radius_m: 0.5 * thick * length * (1 - (1 - taper) * (index / arm.joints.length)),
    }));
  }

  /** Puts the joints where they are, in rad or m, or where they begin; what is no number stays. */
  place(values: ArrayLike<number> = this.arm.start_rad): void {
    this.joints.forEach(({ group, axis, slides }, index) => {
      const value = values[index];
      if (value === undefined || !Number.isFinite(value)) return;
      if (slides) group.position.copy(axis).multiplyScalar(value);
      else group.quaternion.setFromAxisAngle(axis, value);
    });
    this.root.updateMatrixWorld(true);
    this.capsules.forEach(({ from, to }, index) => {
      const { group, end } = this.ends[index]!;
      from.setFromMatrixPosition(group.matrixWorld);
      to.copy(end).applyMatrix4(group.matrixWorld);
    });
  }

  /** Where the tool's point is, in the scene. */
  get tool(): Vector3 {
    return this.capsules.at(-1)!.to;
  }
}

function mounting([x, y, z]: Vector, rotation: readonly number[]): Matrix4 {
  const [a, b, c, d, e, f, g, h, i] = rotation as readonly [number, number, number, number, number, number, number, number, number];
  return new Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}
