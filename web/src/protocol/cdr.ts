// SPDX-License-Identifier: Apache-2.0
import type { Definition, Field, Primitive } from './ros2msg';

/**
 * Decodes CDR (OMG DDSI-RTPS 2.3 §10, XCDR version 1): four bytes of header, of which the second tells the byte order;
 * then the fields in order, each at a multiple of its size counted after the header. Written for any definition: a plan
 * is made once from the schema and run for every message.
 */

export type NumberArray = Float32Array | Float64Array | Uint8Array | number[];
export type Value = number | boolean | string | Message | NumberArray | readonly (boolean | string | Message)[];
/** Whole numbers beyond 2^53 are rounded to the nearest `number`. */
export interface Message {
  readonly [field: string]: Value;
}

/** Thrown for a message that does not match its definition. */
export class CdrError extends Error {}

const headerSize = 4;
const decoder = new TextDecoder();

const sizes: Readonly<Record<Exclude<Primitive, 'string'>, 1 | 2 | 4 | 8>> = {
  bool: 1,
  int8: 1,
  uint8: 1,
  int16: 2,
  uint16: 2,
  int32: 4,
  uint32: 4,
  int64: 8,
  uint64: 8,
  float32: 4,
  float64: 8,
};

class Reader {
  private offset = headerSize;
  readonly littleEndian: boolean;

  constructor(private readonly view: DataView) {
    if (view.byteLength < headerSize) throw new CdrError(`a message of ${view.byteLength} bytes has no CDR header`);
    const representation = view.getUint16(0);
    if (representation > 1) throw new CdrError(`representation ${representation} is not plain CDR`);
    this.littleEndian = representation === 1;
  }

  /** The place of the next value of `size` bytes; `count` of them are there. */
  take(size: 1 | 2 | 4 | 8, count = 1): number {
    const begin = headerSize + Math.ceil((this.offset - headerSize) / size) * size;
    const end = begin + size * count;
    if (end > this.view.byteLength) {
      throw new CdrError(`the message ends at byte ${this.view.byteLength}, a value would end at ${end}`);
    }
    this.offset = end;
    return begin;
  }

  number(type: Exclude<Primitive, 'string'>): number {
    const at = this.take(sizes[type]);
    const { view, littleEndian } = this;
    switch (type) {
      case 'bool':
      case 'uint8':
        return view.getUint8(at);
      case 'int8':
        return view.getInt8(at);
      case 'int16':
        return view.getInt16(at, littleEndian);
      case 'uint16':
        return view.getUint16(at, littleEndian);
      case 'int32':
        return view.getInt32(at, littleEndian);
      case 'uint32':
        return view.getUint32(at, littleEndian);
      case 'int64':
        return Number(view.getBigInt64(at, littleEndian));
      case 'uint64':
        return Number(view.getBigUint64(at, littleEndian));
      case 'float32':
        return view.getFloat32(at, littleEndian);
      case 'float64':
        return view.getFloat64(at, littleEndian);
    }
  }

  text(): string {
    const length = this.number('uint32');
    const begin = this.take(1, length);
    // The length counts a zero at the end.
    return decoder.decode(new Uint8Array(this.view.buffer, this.view.byteOffset + begin, Math.max(0, length - 1)));
  }

  float32s(count: number): Float32Array {
    const values = new Float32Array(this.checked(4, count));
    if (count === 0) return values;
    const begin = this.take(4, count);
    for (let i = 0; i < count; ++i) values[i] = this.view.getFloat32(begin + 4 * i, this.littleEndian);
    return values;
  }

  float64s(count: number): Float64Array {
    const values = new Float64Array(this.checked(8, count));
    if (count === 0) return values;
    const begin = this.take(8, count);
    for (let i = 0; i < count; ++i) values[i] = this.view.getFloat64(begin + 8 * i, this.littleEndian);
    return values;
  }

  /** A count that the rest of the message can hold: nothing is allocated for one that it cannot. */
  checked(size: number, count: number): number {
    if (count * size > this.view.byteLength - this.offset) {
      throw new CdrError(`${count} values of ${size} bytes do not fit into a message of ${this.view.byteLength} bytes`);
    }
    return count;
  }
}

type Step = (reader: Reader) => Value;

function single(type: Field['type']): Step {
  if (typeof type !== 'string') return plan(type);
  if (type === 'string') return (reader) => reader.text();
  if (type === 'bool') return (reader) => reader.number('bool') !== 0;
  return (reader) => reader.number(type);
}

function several(type: Field['type'], count: (reader: Reader) => number): Step {
  if (type === 'float32') return (reader) => reader.float32s(count(reader));
  if (type === 'float64') return (reader) => reader.float64s(count(reader));
  const one = single(type);
  return (reader) => {
    const values = new Array<Value>(reader.checked(1, count(reader)));
    for (let i = 0; i < values.length; ++i) values[i] = one(reader);
    return values as Value;
  };
}

function plan(definition: Definition): (reader: Reader) => Message {
  const steps = definition.fields.map((field): [string, Step] => {
    if (field.array === undefined) return [field.name, single(field.type)];
    const fixed = field.array;
    return [field.name, several(field.type, fixed === 'sequence' ? (reader) => reader.number('uint32') : () => fixed)];
  });
  return (reader) => {
    const message: Record<string, Value> = {};
    for (const [name, step] of steps) message[name] = step(reader);
    return message;
  };
}

/** A decoder for messages of one definition. It throws `CdrError` for a message that is cut or not plain CDR. */
export function cdrDecoder(definition: Definition): (bytes: DataView) => Message {
  const read = plan(definition);
  return (bytes) => read(new Reader(bytes));
}
