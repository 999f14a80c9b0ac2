// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import { parseRos2msg, SchemaError } from '../../src/protocol/ros2msg';

describe('a message definition', () => {
  test('has its fields in order, in lower case, without comments, constants and blank lines', () => {
    const text = '# A comment\nuint8 LEFT=1\nuint8 RIGHT = 2\n\nfloat64 force_N  # in N\n  bool in_contact\nstring cause\n';
    expect(parseRos2msg('a/msg/B', text).fields).toEqual([
      { name: 'force_n', type: 'float64', array: undefined },
      { name: 'in_contact', type: 'bool', array: undefined },
      { name: 'cause', type: 'string', array: undefined },
    ]);
  });

  test('knows sequences, bounded sequences, bounded strings, fixed arrays and defaults', () => {
    const fields = parseRos2msg('a/B', 'float32[] a\nfloat32[<=8] b\nfloat32[3] c\nstring<=10 d\nint32 e 7\n').fields;
    expect(fields.map(({ array }) => array)).toEqual(['sequence', 'sequence', 3, undefined, undefined]);
    expect(fields.map(({ name }) => name)).toEqual(['a', 'b', 'c', 'd', 'e']);
  });

  test('brings the definitions that it uses along', () => {
    const text = 'std_msgs/Header header\nPoint[] points\n' +
      '================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n' +
      '================\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\n';
    const [header, points] = parseRos2msg('a/B', text).fields;
    expect(header!.type).toMatchObject({ fields: [{ name: 'stamp' }, { name: 'frame_id', type: 'string' }] });
    expect(points).toMatchObject({ array: 'sequence', type: { fields: [{ name: 'x' }, { name: 'y' }] } });
  });

  test.each(['nonsense', 'float64', 'Unknown thing', 'float64[ x'])('is refused when a line reads %j', (line) => {
    expect(() => parseRos2msg('a/B', line)).toThrow(SchemaError);
  });

  test('that contains itself is refused and does not recurse forever', () => {
    expect(() => parseRos2msg('a/B', 'C c\n===\nMSG: a/C\nC c\n')).toThrow(SchemaError);
  });
});
