// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { Hand, highest_m, lowest_m } from '../../src/operator/hand';
import { GamepadInput } from '../../src/operator/inputs';
import { StableRange } from '../../src/plots/range';
import { fromSlider, sliderSteps, toSlider, valueText, type ParameterDescription } from '../../src/state/parameters';

describe('the hand', () => {
  test('tells a change at once, a hold ten times a second, and rest never', () => {
    const hand = new Hand();
    expect(hand.message(0)).toBeUndefined();
    hand.grasp(0.001);
    expect(hand.message(1)).toEqual({ position_m: 0.001, engaged: true });
    expect(hand.message(1.05)).toBeUndefined();
    expect(hand.message(1.11)).toEqual({ position_m: 0.001, engaged: true });
    hand.moveTo(0.002);
    expect(hand.message(1.12)).toEqual({ position_m: 0.002, engaged: true });
    hand.release();
    expect(hand.message(1.13)).toEqual({ position_m: 0.002, engaged: false });
    expect(hand.message(9)).toBeUndefined();
  });

  test('stays within its reach', () => {
    const hand = new Hand();
    hand.grasp(1);
    expect(hand.position_m).toBe(highest_m);
    hand.moveTo(-1);
    expect(hand.position_m).toBe(lowest_m);
  });
});

describe('a gamepad', () => {
  test('holds the handle while its stick is pushed, lets go after it, and taps once a press', () => {
    const hand = new Hand();
    let taps = 0;
    const pad = { axes: [0], buttons: [{ pressed: false }] as unknown as GamepadButton[] };
    const input = new GamepadInput(hand, () => (taps += 1), () => [null, pad]);
    input.poll();
    expect(hand.engaged).toBe(false);
    pad.axes = [1];
    input.poll();
    expect(hand).toMatchObject({ engaged: true, position_m: highest_m });
    pad.axes = [0.01];
    input.poll();
    expect(hand.engaged).toBe(false);
    pad.buttons = [{ pressed: true }] as unknown as GamepadButton[];
    input.poll();
    input.poll();
    expect(taps).toBe(1);
  });
});

function parameter(over: Partial<ParameterDescription>): ParameterDescription {
  const base = { name: 'p', label: 'P', unit: '', kind: 'number', choices: [], explanations: [], tunable: true, initial: 0 } as const;
  return { ...base, minimum: 0, maximum: 30, logarithmic: false, ...over };
}

describe('a slider', () => {
  test.each([
    parameter({}),
    parameter({ minimum: 500, maximum: 100000, logarithmic: true }),
    parameter({ maximum: 0.2, unit: 's' }),
    parameter({ minimum: 0.25, maximum: 4, logarithmic: true }),
  ])('reaches both ends and grows all the way ($minimum to $maximum)', (one) => {
    expect(fromSlider(one, 0)).toBe(one.minimum);
    expect(fromSlider(one, sliderSteps)).toBe(one.maximum);
    let before = -Infinity;
    for (let position = 0; position <= sliderSteps; ++position) {
      const value = fromSlider(one, position);
      expect(value).toBeGreaterThanOrEqual(before);
      expect(Math.abs(toSlider(one, value) - position)).toBeLessThanOrEqual(25);
      before = value;
    }
  });

  test('is halfway at the geometric mean of a logarithmic range', () => {
    expect(fromSlider(parameter({ minimum: 1, maximum: 10000, logarithmic: true }), sliderSteps / 2)).toBe(100);
  });

  test('shows values as a person would say them', () => {
    expect(valueText(parameter({ unit: 's' }), 0.05)).toBe('50 ms');
    expect(valueText(parameter({ unit: 'N/m' }), 40000)).toBe('40 N/mm');
    expect(valueText(parameter({}), 10)).toBe('10');
    expect(valueText(parameter({ kind: 'choice' }), 'local-damping')).toBe('local damping');
  });
});

describe('the range of an axis', () => {
  test('contains the data always, at round ends, and shrinks only after a while', () => {
    const range = new StableRange(-1, 1);
    expect(range.update(0, 0.5, 0)).toEqual([-1, 1]);
    expect(range.update(0, 3.3, 1)).toEqual([-1, 4]);
    expect(range.update(0, 0.5, 1.1)).toEqual([-1, 4]);
    expect(range.update(0, 0.5, 2)).toEqual([-1, 4]);
    expect(range.update(0, 0.5, 3.2)).toEqual([-1, 1]);
  });

  test('stays at its base when there are no data', () => {
    expect(new StableRange(-2, 12).update(Infinity, -Infinity, 0)).toEqual([-2, 12]);
  });
});
