// SPDX-License-Identifier: Apache-2.0
import type { ParameterValue, ServerInfo } from '../protocol/foxglove';

/** What the server tells of one parameter (`tactus.parameters` in its metadata). */
export interface ParameterDescription {
  readonly name: string;
  readonly label: string;
  readonly unit: string;
  readonly kind: 'number' | 'choice' | 'flag';
  readonly minimum: number;
  readonly maximum: number;
  readonly choices: readonly string[];
  /** One sentence for each choice. */
  readonly explanations: readonly string[];
  readonly logarithmic: boolean;
  readonly tunable: boolean;
  /** What it is until somebody changes it. */
  readonly initial: ParameterValue | undefined;
}

/** The described parameters; empty when the server describes none or its text cannot be read. */
export function describedParameters(info: ServerInfo): ParameterDescription[] {
  let list: unknown;
  try {
    list = JSON.parse(info.metadata['tactus.parameters'] ?? '[]');
  } catch {
    return [];
  }
  if (!Array.isArray(list)) return [];
  return list.filter((item) => typeof item?.name === 'string').map(complete);
}

function complete(item: Partial<ParameterDescription> & { name: string }): ParameterDescription {
  const minimum = item.minimum ?? 0;
  return {
    name: item.name,
    label: item.label ?? item.name,
    unit: item.unit ?? '',
    kind: item.kind ?? 'number',
    minimum,
    maximum: item.maximum ?? 1,
    choices: item.choices ?? [],
    explanations: item.explanations ?? [],
    logarithmic: (item.logarithmic ?? false) && minimum > 0,
    tunable: item.tunable ?? false,
    initial: item.initial,
  };
}

/** A slider has whole positions from 0 to this. */
export const sliderSteps = 1000;

export function toSlider(parameter: ParameterDescription, value: number): number {
  const { minimum, maximum, logarithmic } = parameter;
  const share = logarithmic
    ? Math.log(value / minimum) / Math.log(maximum / minimum)
    : (value - minimum) / (maximum - minimum);
  return Math.round(sliderSteps * Math.min(1, Math.max(0, share)));
}

/** The value at a position of the slider, rounded to what a person would say: three digits, or 200 steps of the range. */
export function fromSlider(parameter: ParameterDescription, position: number): number {
  const { minimum, maximum, logarithmic } = parameter;
  const share = position / sliderSteps;
  const exact = logarithmic
    ? minimum * (maximum / minimum) ** share
    : minimum + share * (maximum - minimum);
  const digits = logarithmic ? exact : maximum - minimum;
  const grain = 10 ** (Math.floor(Math.log10(digits)) - (logarithmic ? 1 : 2));
  const rounded = Number((Math.round(exact / grain) * grain).toPrecision(6));
  return Math.min(maximum, Math.max(minimum, rounded));
}

const prefixes: readonly (readonly [string, number, string])[] = [
  ['s', 1e3, 'ms'],
  ['N/m', 1e-3, 'N/mm'],
];

/** A word of a choice as a person reads it. */
export function choiceText(choice: string): string {
  return choice === 'none' ? 'none (plain)' : choice.replaceAll('-', ' ');
}

/** A value with its unit, in the size that a person would choose. */
export function valueText(parameter: ParameterDescription, value: ParameterValue): string {
  if (typeof value === 'boolean') return value ? 'on' : 'off';
  if (typeof value === 'string') return choiceText(value);
  const scaled = prefixes.find(([unit]) => unit === parameter.unit);
  const [, factor, unit] = scaled ?? ['', 1, parameter.unit];
  const text = String(Number((value * factor).toPrecision(3)));
  return unit === '' || unit === '1' ? text : `${text} ${unit}`;
}
