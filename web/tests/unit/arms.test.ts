// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { armReach, Hand } from '../../src/operator/hand';
import { toArms } from '../../src/protocol/messages';
import { ArmModel } from '../../src/scene/arm_model';
import { describedArms, type Arm } from '../../src/state/arms';

const level = [1, 0, 0, 0, 1, 0, 0, 0, 1];
/** Turns y to z: a quarter about x. */
const quarter = [1, 0, 0, 0, 0, -1, 0, 1, 0];

const arm: Arm = {
  joints: [
    { name: 'a', origin_m: [0, 0, 1], rotation: level, axis: [0, 0, 2], slides: false },
    { name: 'b', origin_m: [0.5, 0, 0], rotation: quarter, axis: [0, 0, 1], slides: false },
    { name: 'c', origin_m: [0.3, 0, 0], rotation: level, axis: [1, 0, 0], slides: true },
  ],
  tool_m: [0.1, 0, 0],
  start_rad: [0, 0, 0],
};
const pair = {
  leader: arm,
  follower: arm,
  wall_m: 0.01,
  directions: [
    [0, 0, -1],
    [1, 0, 0],
    [0, -1, 0],
  ],
};

function told(text: string) {
  return describedArms({ name: '', capabilities: [], metadata: { 'tactus.arms': text } } as never);
}

describe('an arm', () => {
  test.each([
    [[0, 0, 0], [0.9, 0, 1]],
    [[Math.PI / 2, 0, 0], [0, 0.9, 1]],
    [[0, Math.PI / 2, 0], [0.5, 0, 1.4]],
    [[Math.PI / 2, Math.PI / 2, 0.2], [0, 0.5, 1.6]],
  ])('has its tool where its joints %j say', (joints, expected) => {
    const model = new ArmModel(arm);
    model.place(joints);
    model.tool.toArray().forEach((value, index) => expect(value).toBeCloseTo(expected[index]!, 12));
    expect(model.capsules.length).toBe(4);
    expect(model.capsules[0]!.to.toArray()).toEqual([0, 0, 1]);
  });

  test('stays where it is for joints that are missing or none', () => {
    const model = new ArmModel(arm);
    model.place([Math.PI / 2, 0, 0]);
    const before = model.tool.toArray();
    model.place([NaN, Infinity]);
    expect(model.tool.toArray()).toEqual(before);
    model.place();
    expect(model.tool.x).toBeCloseTo(0.9, 12);
  });

  test('is taken from what the server tells, and nothing that could not be drawn is', () => {
    expect(told(JSON.stringify(pair))).toEqual(pair);
    expect(describedArms({ metadata: {} } as never)).toBeUndefined();
    const broken = [
      '{',
      '7',
      'null',
      '[]',
      JSON.stringify({ ...pair, wall_m: 'x' }),
      JSON.stringify({ ...pair, directions: [[0, 0, 1]] }),
      JSON.stringify({ ...pair, leader: null }),
      JSON.stringify({ ...pair, follower: { ...arm, joints: [] } }),
      JSON.stringify({ ...pair, follower: { ...arm, joints: [null, null, null] } }),
      JSON.stringify({ ...pair, follower: { ...arm, start_rad: [0] } }),
      JSON.stringify({ ...pair, follower: { ...arm, joints: [{ ...arm.joints[0], rotation: [1] }], start_rad: [0] } }),
      JSON.stringify({ ...pair, follower: { ...arm, joints: Array(9).fill(arm.joints[0]), start_rad: Array(9).fill(0) } }),
    ];
    for (const text of broken) expect(told(text), text).toBeUndefined();
  });

  test('is drawn from messages whose vectors are vectors', () => {
    const vector = new Float32Array(3);
    const message = { leader_rad: vector, follower_rad: vector, hand_m: vector, displayed_force_n: vector, contact_force_n: vector, induced_m: vector };
    expect(toArms(message)?.hand_m).toBe(vector);
    expect(toArms({ ...message, contact_force_n: new Float32Array(2) })).toBeUndefined();
    expect(toArms({})).toBeUndefined();
  });
});

describe('the hand of an arm', () => {
  test('moves in three directions within its reach, and tells all three', () => {
    const hand = new Hand();
    hand.reach = armReach;
    hand.grasp([0.01, -0.02, 9]);
    expect(hand.message(0)).toEqual({ position_m: [0.01, -0.02, armReach[2][1]], engaged: true });
    expect(hand.message(0.05)).toBeUndefined();
    hand.moveTo([0.01, -0.03, 0]);
    expect(hand.message(0.06)).toEqual({ position_m: [0.01, -0.03, 0], engaged: true });
    hand.moveTo(0.02);
    expect(hand.message(0.07)).toEqual({ position_m: [0.02, 0, 0], engaged: true });
  });
});
