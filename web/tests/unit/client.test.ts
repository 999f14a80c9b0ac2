// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { WebSocket as NodeSocket } from 'ws';
import { FoxgloveClient, type Connection } from '../../src/protocol/foxglove';
import { Session } from '../../src/state/session';
import { MockServer } from '../mock/server';

let server: MockServer;
let session: Session;
let client: FoxgloveClient;
let connections: Connection[];
let notices: string[];

const until = (check: () => void) => vi.waitFor(check, { timeout: 20_000, interval: 20 });

beforeEach(async () => {
  server = await MockServer.start();
  session = new Session();
  connections = [];
  notices = [];
  session.on('connection', (connection) => connections.push(connection));
  session.on('notice', ({ text }) => notices.push(text));
  const url = server.url.replace('http', 'ws');
  client = new FoxgloveClient(url, session, (to, protocols) => new NodeSocket(to, protocols) as unknown as WebSocket);
  session.on('server', () => client.watchParameters(session.described.map(({ name }) => name)));
  client.start();
});

afterEach(async () => {
  client.stop();
  await server.stop();
});

describe('the client', () => {
  test('learns the parameters with bounds and values', async () => {
    await until(() => expect(session.values.get('control.force_gain')).toBe(10));
    expect(session.described.find(({ name }) => name === 'control.force_gain')).toMatchObject({ minimum: 0, maximum: 30 });
    expect(session.described.find(({ name }) => name === 'left.method')?.choices).toContain('cancellation');
  });

  test('fills the loops from the streams', async () => {
    await until(() => expect(session.loops.left.trace.length).toBeGreaterThan(200));
    expect(session.loops.left.state.time_s).toBeGreaterThan(0);
    expect(session.loops.left.handForce.length).toBeGreaterThan(500);
    expect(client.undecodable).toBe(0);
  });

  test('changes a parameter, and keeps the old value of what is refused, with the reason', async () => {
    await until(() => expect(session.values.size).toBeGreaterThan(0));
    client.setParameters(new Map([['control.force_gain', 3]]));
    await until(() => expect(session.values.get('control.force_gain')).toBe(3));
    client.setParameters(new Map([['control.force_gain', 99]]));
    await until(() => expect(notices.join()).toContain('control.force_gain'));
    expect(session.values.get('control.force_gain')).toBe(3);
  });

  test('publishes the hand as JSON on an advertised channel', async () => {
    await until(() => expect(session.connection.state).toBe('open'));
    expect(client.publish('/operator/hand', { position_m: 0.004, engaged: true })).toBe(true);
    await until(() =>
      expect(server.received).toContainEqual({
        topic: '/operator/hand',
        content: { position_m: 0.004, engaged: true },
      }),
    );
  });

  test('connects again after the connection was cut, and goes on', async () => {
    await until(() => expect(session.loops.left.trace.length).toBeGreaterThan(0));
    server.cut();
    await until(() => expect(connections.some(({ state }) => state === 'lost')).toBe(true));
    expect(client.publish('/operator/hand', {})).toBe(false);
    await until(() => expect(connections.at(-1)?.state).toBe('open'));
    const before = session.loops.left.trace.latest;
    await until(() => expect(session.loops.left.trace.latest).toBeGreaterThan(before));
  });

  test('tells when the server falls silent, and when it speaks again', async () => {
    await until(() => expect(session.loops.left.trace.length).toBeGreaterThan(0));
    server.silent = true;
    await until(() => expect(connections.at(-1)?.state).toBe('silent'));
    server.silent = false;
    await until(() => expect(connections.at(-1)?.state).toBe('open'));
  });

  test('counts blocks that are missing', async () => {
    await until(() => expect(session.loops.left.trace.length).toBeGreaterThan(0));
    server.skipBlocks = 3;
    await until(() => expect(session.loops.left.missingPieces).toBe(1));
    await until(() => expect(session.loops.left.state.dropped).toBe(3));
  });

  test('says so when a definition cannot be read, and bears nonsense', async () => {
    await until(() => expect(session.connection.state).toBe('open'));
    const channel = { id: 77, topic: '/left/state', encoding: 'cdr', schemaName: 'a/B', schema: 'what[' };
    server.sendToAll({ op: 'advertise', channels: [channel] });
    server.sendToAll({ op: 'never heard of' });
    await until(() => expect(notices.join()).toContain('/left/state'));
    expect(session.connection.state).toBe('open');
  });
});
