// SPDX-License-Identifier: Apache-2.0
import { createServer, type IncomingMessage, type Server, type ServerResponse } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import type { AddressInfo } from 'node:net';
import { WebSocket, WebSocketServer } from 'ws';
import { MockHand } from './hand';
import { blockMessage, handForceMessage, schemas, stateMessage } from './messages';
import { MockLoop, tick_s, type Tick } from './loop';

/** Speaks to the page as `tactus serve` does, with the loops of `loop.ts`: for the tests of the page alone. */

const parameters = [
  number('control.force_gain', 'Force gain', '', 10, [0, 30]),
  number('environment.stiffness_N_per_m', 'Wall stiffness', 'N/m', 40000, [500, 100000], true),
  number('channel.delay_s', 'Delay, one way', 's', 0, [0, 0.2]),
  number('operator.grip', 'Grip', '', 1, [0.25, 4], true),
  choice('left.method', 'Method'),
  choice('right.method', 'Method'),
  { name: 'side_by_side', label: 'Both side by side', unit: '', kind: 'flag', initial: false, tunable: true },
];

type Reach = readonly [minimum: number, maximum: number];

function number(name: string, label: string, unit: string, initial: number, [minimum, maximum]: Reach, logarithmic = false) {
  return { name, label, unit, kind: 'number', initial, minimum, maximum, logarithmic, tunable: true };
}

function choice(name: string, label: string) {
  const choices = ['none', 'cancellation', 'local-damping', 'force-filter'];
  const explanations = choices.map((one) => `What ${one} does.`);
  return { name, label, unit: '', kind: 'choice', choices, explanations, initial: 'none', tunable: true };
}

const types: Readonly<Record<string, string>> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
};

const topics = ['/left/block', '/left/hand_force', '/left/state', '/right/block', '/right/hand_force', '/right/state'];
type Kind = keyof typeof schemas;

export interface MockOptions {
  readonly page?: string;
  readonly port?: number;
  readonly tuning?: boolean;
}

export class MockServer {
  readonly values = new Map<string, number | string | boolean>(parameters.map(({ name, initial }) => [name, initial]));
  /** Messages of the page, as they came. */
  readonly received: { topic: string; content: Record<string, unknown> }[] = [];
  /** Sends nothing while set, with the connection open. */
  silent = false;
  /** Leaves out the next blocks, as a server with a full queue does. */
  skipBlocks = 0;
  private readonly http: Server;
  private readonly sockets: WebSocketServer;
  private readonly subscriptions = new Map<WebSocket, Map<number, number>>();
  private readonly hand = new MockHand();
  private readonly loops = [this.newLoop(), this.newLoop()];
  private ticks = 0;
  private dropped = 0;
  private readonly timer: ReturnType<typeof setInterval>;
  private startedAt = performance.now();

  private constructor(private readonly options: MockOptions) {
    this.http = createServer((request, response) => void this.serve(request, response));
    this.sockets = new WebSocketServer({
      server: this.http,
      handleProtocols: (offered) => (offered.has('foxglove.sdk.v1') ? 'foxglove.sdk.v1' : false),
    });
    this.sockets.on('connection', (socket) => this.accept(socket));
    this.timer = setInterval(() => this.run(), 1000 / 60);
  }

  static async start(options: MockOptions = {}): Promise<MockServer> {
    const server = new MockServer(options);
    await new Promise<void>((resolve) => server.http.listen(options.port ?? 0, '127.0.0.1', resolve));
    return server;
  }

  get port(): number {
    return (this.http.address() as AddressInfo).port;
  }

  get url(): string {
    return `http://127.0.0.1:${this.port}/`;
  }

  /** Cuts every connection; the server goes on. */
  cut(): void {
    for (const socket of this.sockets.clients) socket.terminate();
  }

  async stop(): Promise<void> {
    clearInterval(this.timer);
    this.cut();
    this.sockets.close();
    await new Promise((resolve) => this.http.close(resolve));
  }

  sendToAll(message: object): void {
    for (const socket of this.sockets.clients) socket.send(JSON.stringify(message));
  }

  private newLoop(): MockLoop {
    return new MockLoop({ method: 'none', forceGain: 10 });
  }

  private async serve(request: IncomingMessage, response: ServerResponse): Promise<void> {
    const path = normalize(new URL(request.url ?? '/', 'http://mock').pathname);
    const file = join(this.options.page ?? 'dist', path === '/' ? 'index.html' : path);
    try {
      const content = await readFile(file);
      response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' }).end(content);
    } catch {
      response.writeHead(404).end();
    }
  }

  private accept(socket: WebSocket): void {
    this.subscriptions.set(socket, new Map());
    socket.on('close', () => this.subscriptions.delete(socket));
    const listed = parameters.map((one) => ({ ...one, tunable: this.options.tuning ?? true }));
    const metadata = { 'tactus.parameters': JSON.stringify(listed), 'tactus.version': 'mock' };
    const capabilities = ['parameters', 'parametersSubscribe', 'clientPublish'];
    send(socket, { op: 'serverInfo', name: 'mock', capabilities, supportedEncodings: ['cdr', 'json'], metadata });
    const channels = topics.map((topic, index) => {
      const kind = topic.split('/')[2] as Kind;
      const { name, text } = schemas[kind];
      return { id: index + 1, topic, encoding: 'cdr', schemaName: name, schemaEncoding: 'ros2msg', schema: text };
    });
    send(socket, { op: 'advertise', channels });
    const published = new Map<number, string>();
    socket.on('message', (data: Buffer, binary: boolean) => {
      if (binary) this.onPublished(published.get(data.readUInt32LE(1)) ?? '', JSON.parse(data.subarray(5).toString()));
      else this.onText(socket, JSON.parse(data.toString()), published);
    });
  }

  private onText(socket: WebSocket, message: Record<string, any>, published: Map<number, string>): void {
    if (message.op === 'advertise') {
      for (const { id, topic } of message.channels) published.set(id, topic);
    } else if (message.op === 'subscribe') {
      for (const { id, channelId } of message.subscriptions) this.subscriptions.get(socket)?.set(channelId, id);
    } else if (message.op === 'getParameters') {
      send(socket, this.parameterValues([...this.values.keys()]));
    } else if (message.op === 'setParameters') {
      for (const { name, value } of message.parameters) this.setParameter(socket, name, value);
      this.sendToAll(this.parameterValues(message.parameters.map((one: { name: string }) => one.name)));
    }
  }

  private parameterValues(names: readonly string[]): object {
    return { op: 'parameterValues', parameters: names.map((name) => ({ name, value: this.values.get(name) })) };
  }

  private setParameter(socket: WebSocket, name: string, value: number | string | boolean): void {
    const described = parameters.find((one) => one.name === name) as { minimum?: number; maximum?: number } | undefined;
    const bounded = typeof value !== 'number' || (value >= described!.minimum! && value <= described!.maximum!);
    if (described === undefined || !bounded || this.options.tuning === false) {
      send(socket, { op: 'status', level: 2, message: `${name}: ${value} is refused; choose a value within its bounds` });
      return;
    }
    this.values.set(name, value);
    this.loops.forEach(({ settings }, index) => {
      settings.forceGain = this.values.get('control.force_gain') as number;
      settings.method = this.values.get(index === 0 ? 'left.method' : 'right.method') as string;
    });
  }

  private onPublished(topic: string, content: Record<string, unknown>): void {
    this.received.push({ topic, content });
    if (topic === '/operator/hand') this.hand.ask(Number(content.position_m), content.engaged === true);
    if (topic !== '/operator/command') return;
    if (content.command === 'tap') this.hand.tap(this.ticks * tick_s);
    if (content.command === 'reset') this.loops.forEach((loop, i) => (this.loops[i] = new MockLoop(loop.settings)));
  }

  /** Catches up with the real time, in one block of whole columns for each loop. */
  private run(): void {
    const due = Math.floor((performance.now() - this.startedAt) / 1000 / tick_s);
    if (due - this.ticks > 500) {
      this.startedAt += (due - this.ticks - 500) * tick_s * 1000;
    }
    const count = Math.min(500, Math.floor((due - this.ticks) / 10) * 10);
    if (count <= 0) return;
    const start_s = this.ticks * tick_s;
    const rows: Tick[][] = [[], []];
    for (let i = 0; i < count; ++i) {
      this.hand.tick((this.ticks + i) * tick_s);
      this.loops.forEach((loop, k) => rows[k]!.push(loop.tick(this.hand.position_m)));
    }
    this.ticks += count;
    const skip = this.skipBlocks > 0;
    if (skip) {
      this.skipBlocks -= 1;
      this.dropped += 1;
    }
    this.loops.forEach((loop, k) => {
      if (k === 1 && this.values.get('side_by_side') !== true) return;
      const state = stateMessage(this.ticks * tick_s, this.hand.position_m, loop, rows[k]!.at(-1)!, this.dropped);
      this.broadcast(3 * k + 3, state);
      if (skip) return;
      this.broadcast(3 * k + 1, blockMessage(start_s, 10, rows[k]!));
      this.broadcast(3 * k + 2, handForceMessage(start_s, rows[k]!));
    });
  }

  private broadcast(channel: number, payload: Uint8Array): void {
    if (this.silent) return;
    for (const [socket, subscriptions] of this.subscriptions) {
      const id = subscriptions.get(channel);
      if (id === undefined || socket.readyState !== WebSocket.OPEN) continue;
      const frame = Buffer.alloc(13 + payload.length);
      frame[0] = 1;
      frame.writeUInt32LE(id, 1);
      frame.writeBigUInt64LE(BigInt(Math.round(this.ticks * tick_s * 1e9)), 5);
      frame.set(payload, 13);
      socket.send(frame);
    }
  }
}

function send(socket: WebSocket, message: object): void {
  socket.send(JSON.stringify(message));
}
