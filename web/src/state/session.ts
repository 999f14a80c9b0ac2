// SPDX-License-Identifier: Apache-2.0
import type { Message } from '../protocol/cdr';
import type { Connection, Handlers, ParameterValue, ServerInfo, StatusLevel } from '../protocol/foxglove';
import { toArms, toBlock, toHandForce, toLoopState } from '../protocol/messages';
import { describedArms, type ArmPair } from './arms';
import { Loop } from './loop';
import { describedParameters, type ParameterDescription } from './parameters';
import { SlidingSeries } from './series';

export const sides = ['left', 'right'] as const;
export type Side = (typeof sides)[number];

export interface Notice {
  readonly level: StatusLevel;
  readonly text: string;
  readonly id: string | undefined;
}

/** What a part of the page can listen to. Loops are not among them: they are drawn anew every frame. */
export interface Events {
  connection: Connection;
  server: ServerInfo;
  parameters: ReadonlyMap<string, ParameterValue>;
  notice: Notice;
  handForce: { readonly side: Side; readonly force_N: ArrayLike<number>; readonly period_s: number };
}

type Listeners = { [Name in keyof Events]: ((event: Events[Name]) => void)[] };

/** All that the page knows: filled by the connection, read by everything that is shown or heard. */
export class Session implements Handlers {
  readonly loops: Readonly<Record<Side, Loop>> = { left: new Loop(), right: new Loop() };
  /** Energy that each loop gave to the handle by vibration, in mJ, over the time of the left loop. */
  readonly energy = new SlidingSeries(400, sides.length);
  connection: Connection = { state: 'connecting' };
  described: readonly ParameterDescription[] = [];
  /** What is served, where that is a pair of arms. */
  arms: ArmPair | undefined;
  readonly values = new Map<string, ParameterValue>();
  private readonly listeners: Listeners = { connection: [], server: [], parameters: [], notice: [], handForce: [] };

  on<Name extends keyof Events>(name: Name, listener: (event: Events[Name]) => void): void {
    this.listeners[name].push(listener);
  }

  get sideBySide(): boolean {
    return this.values.get('side_by_side') === true;
  }

  wants(topic: string): boolean {
    return /^\/(left|right)\/(block|state|hand_force|arms)$/.test(topic);
  }

  onConnection(connection: Connection): void {
    this.connection = connection;
    this.tell('connection', connection);
  }

  onServerInfo(info: ServerInfo): void {
    for (const side of sides) this.loops[side].clear();
    this.energy.clear();
    this.described = describedParameters(info);
    this.arms = describedArms(info);
    this.tell('server', info);
  }

  onMessage(topic: string, message: Message): void {
    const [, side, kind] = topic.split('/') as [string, Side, string];
    const loop = this.loops[side];
    if (kind === 'state') {
      loop.addState(toLoopState(message));
      if (side === 'left') this.addEnergy(loop.state.time_s);
    } else if (kind === 'arms') {
      loop.arms = toArms(message) ?? loop.arms;
    } else if (kind === 'block') {
      loop.addBlock(toBlock(message));
    } else {
      const piece = toHandForce(message);
      loop.addHandForce(piece);
      this.tell('handForce', { side, force_N: piece.force_N, period_s: piece.period_s });
    }
  }

  private addEnergy(time_s: number): void {
    if (time_s < this.energy.latest) this.energy.clear();
    this.energy.add(time_s);
    sides.forEach((side, index) => {
      const runs = side === 'left' || this.sideBySide;
      this.energy.set(index, runs ? 1e3 * this.loops[side].state.vibrationEnergy_J : NaN);
    });
  }

  onParameters(values: ReadonlyMap<string, ParameterValue>): void {
    for (const [name, value] of values) this.values.set(name, value);
    this.tell('parameters', values);
  }

  onStatus(level: StatusLevel, text: string, id?: string): void {
    this.tell('notice', { level, text, id });
  }

  private tell<Name extends keyof Events>(name: Name, event: Events[Name]): void {
    for (const listener of this.listeners[name]) listener(event);
  }
}
