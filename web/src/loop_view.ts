// SPDX-License-Identifier: Apache-2.0
import { armKeys, axisKeys, dragWithPointer, moveWithKeys, type Place } from './operator/inputs';
import { axisReach, type Hand, type HandPoint } from './operator/hand';
import { Plot, type PlotData } from './plots/plot';
import * as descriptions from './plots/descriptions';
import type { SignalName } from './protocol/messages';
import type { ArmScene } from './scene/arm_scene';
import { compact, drawScene, fitCanvas, roomy, type Layout } from './scene/scene';
import { scaleFor } from './scene/scale';
import { signalIndex, type Loop } from './state/loop';
import type { Side } from './state/session';
import { gripSentence } from './state/grip';
import { clips, judgement, type Forces } from './state/verdict';

const icons = {
  free: 'M12 4a8 8 0 1 0 .01 0Z',
  moving: 'M3 12h17M14 6l6 6-6 6',
  contact: 'M12 4a8 8 0 1 0 .01 0ZM12 4v16',
  settled: 'M4 13l5 5L20 6',
  rings: 'M2 12c2-9 3-9 5 0s3 9 5 0 3-9 5 0 3 9 5 0',
  stopped: 'M6 6h12v12H6Z',
  unknown: 'M5 5l14 14M19 5L5 19',
} as const;

/** How far back a moving thing leaves its blur, and a force its arrow. */
const blur_s = 0.05;
const forceMemory_s = 0.1;
/** The meter reaches to this, or to half as much again as the motor displays. */
const meterFull_N = 2;
const armMeterFull_N = 20;
/** Heights of the picture of arms, in pixels. */
const armHeight = 320;
const compactArmHeight = 170;
const textEvery_s = 0.25;
/** On a phone two loops are in sight together, so each gets less height. */
const phone = matchMedia('(max-width: 600px)');

/** What a picture depends on beside the loop. */
export interface Moment {
  readonly plotsToo: boolean;
  readonly hint: boolean;
  readonly connected: boolean;
}

/** One loop on the page: heading with its method, verdict, scene and force meter; and two plots. */
export class LoopView {
  readonly element: HTMLElement;
  readonly methodPlace: HTMLElement;
  readonly positions = new Plot(descriptions.positions);
  readonly forces = new Plot(descriptions.forces);
  private readonly canvas: HTMLCanvasElement;
  private readonly context: CanvasRenderingContext2D;
  private readonly handle: HTMLElement;
  private textAt_s = -Infinity;
  private textIsDue = false;
  private peak_N = 0;
  private width = 0;
  private arms: ArmScene | undefined;

  constructor(
    side: Side,
    private readonly loop: Loop,
    private readonly hand: Hand,
    tap: () => void,
  ) {
    const template = document.getElementById('loop-template') as HTMLTemplateElement;
    this.element = (template.content.cloneNode(true) as DocumentFragment).firstElementChild as HTMLElement;
    this.element.dataset.side = side;
    this.methodPlace = document.createElement('div');
    this.methodPlace.className = 'method';
    this.find('h2').after(this.methodPlace);
    this.canvas = this.find<HTMLCanvasElement>('canvas');
    this.context = this.canvas.getContext('2d')!;
    this.handle = this.find('.handle');
    this.handle.id = `handle-${side}`;
    this.handle.setAttribute('aria-label', `Your handle, ${side} loop, in millimetres`);
    this.tellReach();
    const place: Place = {
      dragged_m: (right, down) => this.dragged_m(right, down),
      handle_m: () => [loop.state.hand_position_m, 0, 0],
      wall_m: () => loop.state.wall_position_m,
      get keySteps() {
        return hand.reach === axisReach ? axisKeys : armKeys;
      },
    };
    dragWithPointer(this.find('.scene'), hand, place);
    moveWithKeys(this.handle, hand, place, tap);
    for (const plot of [this.positions, this.forces]) plot.element.dataset.side = side;
  }

  /** Draws everything as it is now. */
  draw(now_s: number, { plotsToo, hint, connected }: Moment): void {
    const layout = phone.matches && document.body.dataset.mode === 'both' ? compact : roomy;
    const height = this.arms ? (layout === compact ? compactArmHeight : armHeight) : layout.height;
    this.width = fitCanvas(this.canvas, this.context, height);
    const { trace } = this.loop;
    const handForce_N = connected ? magnitudes(trace.extremes(signalIndex('hand_force_n'), trace.latest - blur_s)) : none;
    this.textIsDue = now_s - this.textAt_s >= textEvery_s;
    const atWall_N = Math.max(0, trace.extremes(signalIndex('slave_force_n'), trace.latest - blur_s)[1]);
    this.drawVerdict({ atWall_N, onHand_N: handForce_N[1] }, connected);
    if (this.textIsDue) this.textAt_s = now_s;
    this.drawMeter(handForce_N);
    this.drawHand(layout, height, hint, connected);
    if (plotsToo) this.drawPlots(now_s);
  }

  /** Draws arms from now on; without any, one axis. */
  drawArms(arms: ArmScene | undefined): void {
    this.arms = arms;
    this.tellReach();
  }

  rename(name: string): void {
    for (const place of this.element.querySelectorAll('.name')) place.textContent = name;
  }

  /** Shows or hides all of it. */
  show(visible: boolean): void {
    for (const element of [this.element, this.positions.element, this.forces.element]) element.hidden = !visible;
  }

  private tellReach(): void {
    const [lowest_m, highest_m] = this.hand.reach[0];
    this.handle.setAttribute('aria-valuemin', String(1e3 * lowest_m));
    this.handle.setAttribute('aria-valuemax', String(1e3 * highest_m));
  }

  private dragged_m(right: number, down: number): HandPoint {
    return this.arms?.dragged_m(right, down) ?? [(1e-3 * right) / scaleFor(this.width).pixelsPerMillimetre, 0, 0];
  }

  private find<Kind extends HTMLElement = HTMLElement>(selector: string): Kind {
    return this.element.querySelector<Kind>(selector)!;
  }

  private drawVerdict(forces: Forces, connected: boolean): void {
    const { verdict, word, sentence, measured } = judgement(this.loop.state, forces, connected);
    const element = this.find('.verdict');
    const same = this.element.dataset.verdict === verdict && element.dataset.sentence === sentence;
    // A verdict and the numbers beside it are of the same moment.
    this.textIsDue ||= !same;
    if (this.textIsDue) {
      this.find('.measured').textContent = measured;
      const { estimatedGrip, gripDeviation } = this.loop.state;
      this.find('.grip').textContent = connected ? gripSentence(estimatedGrip, gripDeviation) : '';
    }
    if (same) return;
    this.element.dataset.verdict = verdict;
    element.dataset.sentence = sentence;
    element.querySelector('path')!.setAttribute('d', icons[verdict]);
    element.querySelector('strong')!.textContent = word;
    element.querySelector('.sentence')!.textContent = sentence;
  }

  private drawMeter([low, high]: readonly [number, number]): void {
    const { trace, state } = this.loop;
    const { forceLimit_N } = state;
    const full_N = Math.max(this.arms ? armMeterFull_N : meterFull_N, 1.5 * forceLimit_N);
    this.peak_N = Math.max(high, this.peak_N * 0.985);
    const share = (force_N: number): number => Math.min(1, force_N / full_N);
    this.find('.meter-level').style.transform = `scaleX(${share(low)})`;
    this.find('.meter-range').style.transform = `translateX(${100 * share(low)}%) scaleX(${Math.max(0.004, share(high) - share(low))})`;
    this.find('.meter-peak').style.transform = `translateX(${98 * share(this.peak_N)}%)`;
    this.find('.meter-limit').style.transform = `translateX(${100 * share(forceLimit_N)}%)`;
    if (!this.textIsDue) return;
    const text = `${high.toFixed(2)} N`;
    this.find('.meter-text').textContent = text;
    const meter = this.find('.meter');
    meter.setAttribute('aria-valuemax', String(full_N));
    meter.setAttribute('aria-valuenow', Math.min(high, full_N).toFixed(2));
    meter.setAttribute('aria-valuetext', text);
    const displayed_N = magnitudes(trace.extremes(signalIndex('displayed_force_n'), trace.latest - blur_s))[1];
    const atLimit = clips(displayed_N, forceLimit_N);
    this.find('.limit').dataset.clips = String(atLimit);
    const limit = `${Number(forceLimit_N.toPrecision(3))} N`;
    this.find('.limit').textContent =
      forceLimit_N <= 0 ? '' : atLimit ? `The motor is at its limit of ${limit}.` : `The motor’s limit is ${limit}.`;
  }

  private drawHand(layout: Layout, height: number, hint: boolean, connected: boolean): void {
    const { state, trace } = this.loop;
    const hand_m = this.hand.engaged ? this.hand.position_m : state.hand_position_m;
    const recent = (name: SignalName, since_s: number): [number, number] =>
      trace.extremes(signalIndex(name), trace.latest - since_s);
    const master_mm = orElse(recent('master_position_m', blur_s), 1e3 * state.master_position_m);
    const displayed_N = connected ? magnitudes(recent('displayed_force_n', forceMemory_s))[1] : 0;
    const contact_N = connected ? Math.max(0, recent('slave_force_n', forceMemory_s)[1]) : 0;
    const rings = this.element.dataset.verdict === 'rings';
    if (this.textIsDue) this.describeHandle(hand_m);
    if (this.arms) {
      const content = { arms: this.loop.arms, engaged: this.hand.engaged, displayed_N, contact_N, rings, hint };
      const [x, y] = this.arms.draw(this.context, this.width, height, content);
      this.handle.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      return;
    }
    drawScene(this.context, this.width, layout, {
      hand_mm: 1e3 * hand_m,
      engaged: this.hand.engaged,
      master_mm,
      slave_mm: orElse(recent('slave_position_m', blur_s), 1e3 * state.slave_position_m),
      wall_mm: 1e3 * state.wall_position_m,
      displayed_N,
      clips: clips(displayed_N, state.forceLimit_N),
      contact_N,
      rings,
      hint,
    });
    const x = scaleFor(this.width).x((master_mm[0] + master_mm[1]) / 2);
    this.handle.style.transform = `translate(${x.toFixed(1)}px, ${layout.master - roomy.master}px)`;
  }

  private describeHandle(hand_m: number): void {
    const toWall_mm = 1e3 * (this.loop.state.wall_position_m - hand_m);
    const where = toWall_mm >= 0 ? `${toWall_mm.toFixed(1)} mm before the wall` : `${(-toWall_mm).toFixed(1)} mm into the wall`;
    this.handle.setAttribute('aria-valuenow', (1e3 * hand_m).toFixed(1));
    this.handle.setAttribute('aria-valuetext', `${(1e3 * hand_m).toFixed(1)} mm, ${where}`);
  }

  private drawPlots(now_s: number): void {
    const { trace } = this.loop;
    if (trace.length === 0) return;
    const [time, ...signals] = trace.views();
    const select = (names: readonly SignalName[]): PlotData => [time, ...names.map((name) => signals[signalIndex(name)]!)];
    this.positions.update(select(descriptions.positionSignals), trace.latest, now_s);
    this.forces.markLimit(this.loop.state.forceLimit_N);
    this.forces.update(select(descriptions.forceSignals), trace.latest, now_s);
    if (!this.textIsDue) return;
    descriptions.forceSignals.forEach((name, index) => {
      const [, greatest] = magnitudes(trace.extremes(signalIndex(name), trace.latest - blur_s));
      this.forces.tell(index, `${greatest.toFixed(2)} N`);
    });
  }
}

const none: [number, number] = [0, 0];

function orElse(range: [number, number], value: number): [number, number] {
  return range[0] <= range[1] ? range : [value, value];
}

/** Least and greatest magnitude of a range of values. */
function magnitudes([low, high]: [number, number]): [number, number] {
  if (low > high) return none;
  const greatest = Math.max(Math.abs(low), Math.abs(high));
  return low <= 0 && high >= 0 ? [0, greatest] : [Math.min(Math.abs(low), Math.abs(high)), greatest];
}
