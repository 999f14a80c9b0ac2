// SPDX-License-Identifier: Apache-2.0
/**
 * Message definitions as ROS 2 writes them in `.msg` files (schema encoding `ros2msg`): one field a line, comments after
 * `#`, further definitions after a line of `=` and `MSG: package/Name`.
 */

export type Primitive =
  | 'bool'
  | 'int8'
  | 'uint8'
  | 'int16'
  | 'uint16'
  | 'int32'
  | 'uint32'
  | 'int64'
  | 'uint64'
  | 'float32'
  | 'float64'
  | 'string';

export interface Field {
  /** In lower case, as ROS 2 wants names of fields: `slave_force_n`. */
  readonly name: string;
  readonly type: Primitive | Definition;
  /** `undefined`: a single value; `'sequence'`: any number of values; a number: exactly so many. */
  readonly array: undefined | 'sequence' | number;
}

export interface Definition {
  readonly name: string;
  readonly fields: readonly Field[];
}

const primitives: ReadonlySet<string> = new Set<Primitive>([
  'bool',
  'int8',
  'uint8',
  'int16',
  'uint16',
  'int32',
  'uint32',
  'int64',
  'uint64',
  'float32',
  'float64',
  'string',
]);

const builtin: Readonly<Record<string, string>> = {
  time: 'int32 sec\nuint32 nanosec',
  duration: 'int32 sec\nuint32 nanosec',
};

const fieldPattern = /^([\w/]+?)(?:<=\d+)?(?:\[(<=)?(\d*)\])?\s+([A-Za-z]\w*)(?:\s+[^=\s].*)?$/;

/** Thrown for a definition that cannot be understood; the message names the line. */
export class SchemaError extends Error {}

function lastPart(name: string): string {
  return name.slice(name.lastIndexOf('/') + 1);
}

/** Parses a definition with those that it carries along. Throws `SchemaError`. */
export function parseRos2msg(name: string, text: string): Definition {
  const [main, ...others] = text.split(/^=+[ \t]*$/m);
  const texts = new Map<string, string>();
  for (const other of others) {
    const head = /^\s*MSG:\s*(\S+)/.exec(other);
    if (head === null) throw new SchemaError(`${name}: a definition after a line of '=' has no 'MSG: package/Name'`);
    texts.set(lastPart(head[1]!), other.slice(head[0].length));
  }
  for (const [key, value] of Object.entries(builtin)) {
    const title = key[0]!.toUpperCase() + key.slice(1);
    if (!texts.has(title)) texts.set(title, value);
    texts.set(key, value);
  }
  return parseOne(name, main ?? '', texts, 0);
}

function parseOne(name: string, text: string, texts: ReadonlyMap<string, string>, depth: number): Definition {
  if (depth > 16) throw new SchemaError(`${name}: definitions are nested deeper than 16`);
  const fields: Field[] = [];
  for (const raw of text.split('\n')) {
    const line = raw.replace(/#.*$/, '').trim();
    if (line === '' || /^\w+(?:<=\d+)?\s+\w+\s*=/.test(line)) continue; // blank, or a constant, which has no bytes
    const found = fieldPattern.exec(line);
    if (found === null) throw new SchemaError(`${name}: cannot read the line '${line}'`);
    const [, typeName, bounded, size, fieldName] = found;
    const hasBrackets = size !== undefined;
    const array = !hasBrackets ? undefined : bounded === '<=' || size === '' ? 'sequence' : Number(size);
    fields.push({ name: fieldName!.toLowerCase(), type: typeOf(typeName!, name, texts, depth), array });
  }
  return { name, fields };
}

function typeOf(type: string, within: string, texts: ReadonlyMap<string, string>, depth: number): Field['type'] {
  if (primitives.has(type)) return type as Primitive;
  if (type === 'byte' || type === 'char') return 'uint8';
  const text = texts.get(lastPart(type));
  if (text === undefined) throw new SchemaError(`${within}: the type '${type}' is not defined`);
  return parseOne(type, text, texts, depth + 1);
}
