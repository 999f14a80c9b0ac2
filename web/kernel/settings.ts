// SPDX-License-Identifier: Apache-2.0
import { parse } from 'smol-toml';

export type Setting = readonly [key: string, value: number | string | boolean];

/** The keys of an experiment file, dotted, in the order written. Runs where the page is built, or in a test. */
export function settingsOf(toml: string): Setting[] {
  const found: Setting[] = [];
  const walk = (table: object, path: string): void => {
    for (const [key, value] of Object.entries(table)) {
      const name = path ? `${path}.${key}` : key;
      if (typeof value === 'object' && value !== null) walk(value, name);
      else found.push([name, value as number | string | boolean]);
    }
  };
  walk(parse(toml), '');
  return found;
}
