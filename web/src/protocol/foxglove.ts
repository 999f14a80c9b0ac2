// SPDX-License-Identifier: Apache-2.0
import { cdrDecoder, type Message } from './cdr';
import { parseRos2msg } from './ros2msg';

/** The Foxglove WebSocket protocol, as far as the page needs it, over a connection that is made anew when it is lost. */

export const subprotocols = ['foxglove.sdk.v1', 'foxglove.websocket.v1'];

export type ParameterValue = number | string | boolean;

export interface ServerInfo {
  readonly name: string;
  readonly capabilities: readonly string[];
  readonly metadata: Readonly<Record<string, string>>;
}

export type Connection =
  | { readonly state: 'connecting' }
  | { readonly state: 'open' }
  /** The connection is up and nothing has come for a while. */
  | { readonly state: 'silent' }
  | { readonly state: 'lost'; readonly retryInSeconds: number };

/** As the protocol numbers them: 0 information, 1 warning, 2 error. */
export type StatusLevel = 0 | 1 | 2;

export interface Handlers {
  /** Whether messages of a topic are wanted. Asked once for every advertised channel. */
  wants(topic: string): boolean;
  onConnection(connection: Connection): void;
  onServerInfo(info: ServerInfo): void;
  onMessage(topic: string, message: Message): void;
  onParameters(values: ReadonlyMap<string, ParameterValue>): void;
  /** A status with the id of an earlier one replaces it. */
  onStatus(level: StatusLevel, text: string, id?: string): void;
}

type SocketMaker = (url: string, protocols: string[]) => WebSocket;

interface Subscription {
  readonly topic: string;
  readonly decode: (bytes: DataView) => Message;
}

const silentAfterMilliseconds = 1500;
const firstRetryMilliseconds = 250;
const longestRetryMilliseconds = 4000;
const messageDataHeader = 1 + 4 + 8;

export class FoxgloveClient {
  private socket: WebSocket | undefined;
  private readonly subscriptions = new Map<number, Subscription>();
  private readonly publications = new Map<string, number>();
  private retryMilliseconds = firstRetryMilliseconds;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private silenceTimer: ReturnType<typeof setInterval> | undefined;
  private lastHeard = 0;
  private silent = false;
  private stopped = true;
  /** Messages that could not be decoded since the page was loaded. */
  undecodable = 0;

  constructor(
    private readonly url: string,
    private readonly handlers: Handlers,
    private readonly makeSocket: SocketMaker = (url, protocols) => new WebSocket(url, protocols),
  ) {}

  start(): void {
    this.stopped = false;
    this.connect();
  }

  stop(): void {
    this.stopped = true;
    clearTimeout(this.retryTimer);
    clearInterval(this.silenceTimer);
    this.socket?.close();
    this.socket = undefined;
  }

  /** Sends a message as JSON. Returns false, and sends nothing, while there is no connection. */
  publish(topic: string, content: unknown): boolean {
    const channel = this.publications.get(topic);
    if (this.socket === undefined || channel === undefined) return false;
    const text = new TextEncoder().encode(JSON.stringify(content));
    const frame = new Uint8Array(5 + text.length);
    frame[0] = 1;
    new DataView(frame.buffer).setUint32(1, channel, true);
    frame.set(text, 5);
    this.socket.send(frame);
    return true;
  }

  setParameters(values: ReadonlyMap<string, ParameterValue>): void {
    const parameters = [...values].map(([name, value]) => ({ name, value }));
    this.send({ op: 'setParameters', id: 'page', parameters });
  }

  /** Asks for the values of these parameters, now and whenever they change. */
  watchParameters(parameterNames: readonly string[]): void {
    this.send({ op: 'getParameters', parameterNames, id: 'page' });
    this.send({ op: 'subscribeParameterUpdates', parameterNames });
  }

  private send(message: object): void {
    if (this.socket?.readyState === 1) this.socket.send(JSON.stringify(message));
  }

  private connect(): void {
    this.handlers.onConnection({ state: 'connecting' });
    const socket = this.makeSocket(this.url, subprotocols);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.socket = socket;
      this.heard();
      this.silenceTimer = setInterval(() => this.checkSilence(), 250);
      this.advertise();
      this.handlers.onConnection({ state: 'open' });
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      this.heard();
      if (typeof event.data === 'string') this.onText(event.data);
      else this.onBinary(new DataView(event.data));
    };
    socket.onclose = () => this.onLost();
  }

  private onLost(): void {
    clearInterval(this.silenceTimer);
    this.socket = undefined;
    this.subscriptions.clear();
    this.publications.clear();
    if (this.stopped) return;
    this.handlers.onConnection({ state: 'lost', retryInSeconds: this.retryMilliseconds / 1000 });
    this.retryTimer = setTimeout(() => this.connect(), this.retryMilliseconds);
    this.retryMilliseconds = Math.min(2 * this.retryMilliseconds, longestRetryMilliseconds);
  }

  private heard(): void {
    this.lastHeard = performance.now();
    if (!this.silent) return;
    this.silent = false;
    this.handlers.onConnection({ state: 'open' });
  }

  private checkSilence(): void {
    if (this.silent || performance.now() - this.lastHeard < silentAfterMilliseconds) return;
    this.silent = true;
    this.handlers.onConnection({ state: 'silent' });
  }

  private advertise(): void {
    const channels = ['/operator/hand', '/operator/command'].map((topic, index) => {
      this.publications.set(topic, index + 1);
      return { id: index + 1, topic, encoding: 'json', schemaName: '' };
    });
    this.send({ op: 'advertise', channels });
  }

  private onText(text: string): void {
    let message: Record<string, unknown>;
    try {
      message = JSON.parse(text) as Record<string, unknown>;
    } catch {
      this.undecodable += 1;
      return;
    }
    switch (message.op) {
      case 'serverInfo':
        this.onServerInfo(message);
        break;
      case 'advertise':
        this.subscribe((message.channels ?? []) as readonly AdvertisedChannel[]);
        break;
      case 'parameterValues':
        this.onParameterValues((message.parameters ?? []) as readonly { name: string; value: unknown }[]);
        break;
      case 'status':
        this.onStatus(message);
        break;
    }
  }

  private onStatus({ level, message, id }: Record<string, unknown>): void {
    const known = typeof id === 'string' ? id : undefined;
    this.handlers.onStatus(Number(level) as StatusLevel, String(message), known);
  }

  private onServerInfo(message: Record<string, unknown>): void {
    this.retryMilliseconds = firstRetryMilliseconds;
    const info: ServerInfo = {
      name: String(message.name ?? ''),
      capabilities: (message.capabilities ?? []) as string[],
      metadata: (message.metadata ?? {}) as Record<string, string>,
    };
    this.handlers.onServerInfo(info);
  }

  private onParameterValues(parameters: readonly { name: string; value: unknown }[]): void {
    const values = new Map<string, ParameterValue>();
    for (const { name, value } of parameters) {
      if (typeof value === 'number' || typeof value === 'string' || typeof value === 'boolean') values.set(name, value);
    }
    this.handlers.onParameters(values);
  }

  private subscribe(channels: readonly AdvertisedChannel[]): void {
    const wanted: { id: number; channelId: number }[] = [];
    for (const channel of channels) {
      if (channel.encoding !== 'cdr' || !this.handlers.wants(channel.topic)) continue;
      if (channel.schemaEncoding !== undefined && channel.schemaEncoding !== 'ros2msg') continue;
      try {
        const decode = cdrDecoder(parseRos2msg(channel.schemaName, channel.schema));
        this.subscriptions.set(channel.id, { topic: channel.topic, decode });
        wanted.push({ id: channel.id, channelId: channel.id });
      } catch (error) {
        this.handlers.onStatus(2, `${channel.topic}: ${String(error)}`);
      }
    }
    if (wanted.length > 0) this.send({ op: 'subscribe', subscriptions: wanted });
  }

  private onBinary(frame: DataView): void {
    if (frame.byteLength < messageDataHeader || frame.getUint8(0) !== 1) return;
    const subscription = this.subscriptions.get(frame.getUint32(1, true));
    if (subscription === undefined) return;
    let message: Message;
    try {
      message = subscription.decode(new DataView(frame.buffer, frame.byteOffset + messageDataHeader));
    } catch {
      this.undecodable += 1;
      return;
    }
    this.handlers.onMessage(subscription.topic, message);
  }
}

interface AdvertisedChannel {
  readonly id: number;
  readonly topic: string;
  readonly encoding: string;
  readonly schemaName: string;
  readonly schema: string;
  readonly schemaEncoding?: string;
}
