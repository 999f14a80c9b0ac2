// SPDX-License-Identifier: Apache-2.0
/** Runs the loops in real time: a thread of its own, so that the page can be slow without a control cycle being late. */
import experiment from '../../experiments/tapping.toml';
import { Kernel, sides } from '../kernel/kernel';
import wasm from '../../build/web-kernel/tactus.wasm?url';
import type { Order, Report } from './orders';

const beat_ms = 8;
/** If the machine falls behind by more, that time is left out: no burst follows. */
const mostBehind_s = 0.1;

let kernel: Kernel | undefined;
let timer: ReturnType<typeof setInterval> | undefined;
let last_ms = 0;
let due = 0;
let speed = 1;

function report(message: Report, transfer: Transferable[] = []): void {
  postMessage(message, { transfer });
}

function beat(): void {
  if (!kernel) return;
  const now_ms = performance.now();
  due += Math.min((now_ms - last_ms) / 1000, mostBehind_s) * (speed / kernel.cycle_s);
  last_ms = now_ms;
  const cycles = Math.floor(due);
  if (cycles === 0) return;
  due -= cycles;
  const rows = kernel.step(cycles);
  report({ rows }, [rows.buffer]);
}

function run(wanted: boolean): void {
  clearInterval(timer);
  timer = wanted ? setInterval(beat, beat_ms) : undefined;
  last_ms = performance.now();
}

async function load(): Promise<Kernel> {
  const made = await Kernel.load(await (await fetch(wasm)).arrayBuffer());
  for (const side of sides) for (const [key, value] of experiment) made.set(side, key, value);
  return made;
}

function obey(order: Order): void {
  if (!kernel) return;
  if (order.settings) {
    for (const { side, key, value } of order.settings) kernel.set(side, key, value);
    kernel.apply();
    if (order.fresh) kernel.restart();
  }
  if (order.aim_m !== undefined) kernel.aim(order.aim_m);
  if (order.tap) kernel.tap();
  if (order.speed !== undefined) speed = order.speed;
  if (order.run !== undefined) run(order.run);
}

const ready = load().then(
  (made) => {
    kernel = made;
    report({ ready: { cycle_s: made.cycle_s, tapStart_m: made.tapStart_m } });
  },
  (reason: unknown) => report({ failed: String(reason) }),
);

addEventListener('message', (event: MessageEvent<Order>) => {
  void ready
    .then(() => obey(event.data))
    .catch((reason: unknown) => report({ failed: String(reason) }));
});
