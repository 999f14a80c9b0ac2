// SPDX-License-Identifier: Apache-2.0
import type { ParameterValue } from '../protocol/foxglove';
import type { ParameterDescription } from './parameters';

/** The part of the page's address after `#`: the parameters that are not as the server began with them. */
export function linkOf(
  described: readonly ParameterDescription[],
  values: ReadonlyMap<string, ParameterValue>,
): string {
  const changed = new URLSearchParams();
  for (const { name, initial } of described) {
    const value = values.get(name);
    if (value !== undefined && value !== initial) changed.set(name, String(value));
  }
  const text = changed.toString();
  return text === '' ? '' : `#${text}`;
}

/** The values that a link asks for, each of the kind that its parameter has; what fits none is left out. */
export function valuesOf(link: string, described: readonly ParameterDescription[]): Map<string, ParameterValue> {
  const asked = new URLSearchParams(link.replace(/^#/, ''));
  const values = new Map<string, ParameterValue>();
  for (const { name, kind } of described) {
    const text = asked.get(name);
    if (text === null || text === '') continue;
    if (kind === 'choice') values.set(name, text);
    else if (kind === 'flag' && (text === 'true' || text === 'false')) values.set(name, text === 'true');
    else if (kind === 'number' && Number.isFinite(Number(text))) values.set(name, Number(text));
  }
  return values;
}
