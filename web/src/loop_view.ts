import { dragWithPointer, moveWithKeys, type Place } from './operator/inputs';
import { highest_m, lowest_m, type Hand } from './operator/hand';
import { Plot, type PlotData } from './plots/plot';
import * as descriptions from './plots/descriptions';
import type { SignalName } from './protocol/messages';
import { drawScene, fitCanvas, sceneHeight } from './scene/scene';
import { scaleFor } from './scene/scale';
import { signalIndex, type Loop } from './state/loop';
import type { Side } from './state/session';
import { SteadyVerdict } from './state/verdict';

const icons = {
  free: 'M12 4a8 8 0 1 0 .01 0Z',
  contact: 'M12 4a8 8 0 1 0 .01 0ZM12 4v16',
  settled: 'M4 13l5 5L20 6',
  rings: 'M2 12c2-9 3-9 5 0s3 9 5 0 3-9 5 0 3 9 5 0',
  stopped: 'M6 6h12v12H6Z',
} as const;

/** How far back a moving thing leaves its blur, and a force its arrow. */
const blur_s = 0.05;
const forceMemory_s = 0.1;
const meterFull_N = 2;
const textEvery_s = 0.25;

/** One loop on the page: heading with its method, verdict, scene and force meter; and two plots. */
export class LoopView {
  readonly element: HTMLElement;
  readonly methodPlace: HTMLElement;
  readonly positions = new Plot(descriptions.positions);
  readonly forces = new Plot(descriptions.forces);
  private readonly canvas: HTMLCanvasElement;
  private readonly context: CanvasRenderingContext2D;
  private readonly handle: HTMLElement;
  private readonly verdict = new SteadyVerdict();
  private textAt_s = -Infinity;
  private textIsDue = false;
  private peak_N = 0;
  private width = 0;

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
    this.canvas.style.height = `${sceneHeight}px`;
    this.context = this.canvas.getContext('2d')!;
    this.handle = this.find('.handle');
    this.handle.id = `handle-${side}`;
    this.handle.setAttribute('aria-label', `Your handle, ${side} loop, in millimetres`);
    this.handle.setAttribute('aria-valuemin', String(1e3 * lowest_m));
    this.handle.setAttribute('aria-valuemax', String(1e3 * highest_m));
    this.find('.meter').setAttribute('aria-valuemax', String(meterFull_N));
    const place: Place = {
      millimetresPerPixel: () => 1 / scaleFor(this.width).pixelsPerMillimetre,
      handle_m: () => loop.state.hand_position_m,
      wall_m: () => loop.state.wall_position_m,
    };
    dragWithPointer(this.find('.scene'), hand, place);
    moveWithKeys(this.handle, hand, place, tap);
    for (const plot of [this.positions, this.forces]) plot.element.dataset.side = side;
  }

  /** Draws everything as it is now. */
  draw(now_s: number, plotsToo: boolean, hint: boolean): void {
    this.width = fitCanvas(this.canvas, this.context);
    this.textIsDue = now_s - this.textAt_s >= textEvery_s;
    if (this.textIsDue) this.textAt_s = now_s;
    this.drawVerdict(now_s);
    this.drawMeter();
    this.drawHand(hint);
    if (plotsToo) this.drawPlots(now_s);
  }

  rename(name: string): void {
    for (const place of this.element.querySelectorAll('.name')) place.textContent = name;
  }

  /** Shows or hides all of it. */
  show(visible: boolean): void {
    for (const element of [this.element, this.positions.element, this.forces.element]) element.hidden = !visible;
  }

  private find<Kind extends HTMLElement = HTMLElement>(selector: string): Kind {
    return this.element.querySelector<Kind>(selector)!;
  }

  private drawVerdict(now_s: number): void {
    const { verdict, word, sentence, measured } = this.verdict.update(this.loop.state, now_s);
    const element = this.find('.verdict');
    const same = this.element.dataset.verdict === verdict && element.dataset.sentence === sentence;
    if (this.textIsDue || !same) this.find('.measured').textContent = measured;
    if (same) return;
    this.element.dataset.verdict = verdict;
    element.dataset.sentence = sentence;
    element.querySelector('path')!.setAttribute('d', icons[verdict]);
    element.querySelector('strong')!.textContent = word;
    element.querySelector('.sentence')!.textContent = sentence;
  }

  private drawMeter(): void {
    const { trace } = this.loop;
    const [low, high] = magnitudes(trace.extremes(signalIndex('hand_force_n'), trace.latest - blur_s));
    this.peak_N = Math.max(high, this.peak_N * 0.985);
    const share = (force_N: number): number => Math.min(1, force_N / meterFull_N);
    this.find('.meter-level').style.transform = `scaleX(${share(low)})`;
    this.find('.meter-range').style.transform = `translateX(${100 * share(low)}%) scaleX(${Math.max(0.004, share(high) - share(low))})`;
    this.find('.meter-peak').style.transform = `translateX(${98 * share(this.peak_N)}%)`;
    if (!this.textIsDue) return;
    const text = `${high.toFixed(2)} N`;
    this.find('.meter-text').textContent = text;
    this.find('.meter').setAttribute('aria-valuenow', Math.min(high, meterFull_N).toFixed(2));
    this.find('.meter').setAttribute('aria-valuetext', text);
  }

  private drawHand(hint: boolean): void {
    const { state, trace } = this.loop;
    const hand_m = this.hand.engaged ? this.hand.position_m : state.hand_position_m;
    const recent = (name: SignalName, since_s: number): [number, number] =>
      trace.extremes(signalIndex(name), trace.latest - since_s);
    const master_mm = orElse(recent('master_position_m', blur_s), 1e3 * state.master_position_m);
    drawScene(this.context, this.width, {
      hand_mm: 1e3 * hand_m,
      engaged: this.hand.engaged,
      master_mm,
      slave_mm: orElse(recent('slave_position_m', blur_s), 1e3 * state.slave_position_m),
      wall_mm: 1e3 * state.wall_position_m,
      displayed_N: magnitudes(recent('displayed_force_n', forceMemory_s))[1],
      contact_N: Math.max(0, recent('slave_force_n', forceMemory_s)[1]),
      rings: this.element.dataset.verdict === 'rings',
      hint,
    });
    const x = scaleFor(this.width).x((master_mm[0] + master_mm[1]) / 2);
    this.handle.style.transform = `translateX(${x.toFixed(1)}px)`;
    if (this.textIsDue) this.describeHandle(hand_m);
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
    this.forces.update(select(descriptions.forceSignals), trace.latest, now_s);
  }
}

function orElse(range: [number, number], value: number): [number, number] {
  return range[0] <= range[1] ? range : [value, value];
}

/** Least and greatest magnitude of a range of values. */
function magnitudes([low, high]: [number, number]): [number, number] {
  if (low > high) return [0, 0];
  const greatest = Math.max(Math.abs(low), Math.abs(high));
  return low <= 0 && high >= 0 ? [0, greatest] : [Math.min(Math.abs(low), Math.abs(high)), greatest];
}
