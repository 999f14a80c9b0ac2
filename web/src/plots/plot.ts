// SPDX-License-Identifier: Apache-2.0
import uPlot from 'uplot';
import { palette, type ColourName } from '../scene/palette';
import { findEnvelope, makeEnvelope, type Envelope } from './envelope';
import { Raster, rgb } from './raster';
import { StableRange } from './range';

/** One line of a plot. */
export interface Line {
  readonly label: string;
  readonly colour: ColourName;
  readonly width?: number;
}

export interface PlotDescription {
  readonly title: string;
  /** One sentence for who sees the plot for the first time. */
  readonly note: string;
  readonly xLabel: string;
  readonly yLabel: string;
  readonly lines: readonly Line[];
  /** What the x axis shows, before and after the origin of the data. */
  readonly reach: readonly [number, number];
  readonly base: readonly [number, number];
  readonly height: number;
  /** Labels of the x axis; by default the values themselves. */
  readonly xText?: (value: number) => string;
  /** Distance of the marks of the x axis. */
  readonly xStep: number;
}

export type PlotData = readonly [Float64Array, ...Float32Array[]];

/**
 * A plot with a title, a legend whose entries show and hide lines, and axes with units. uPlot draws the axes, when they
 * change; the lines are drawn anew in every picture, on a canvas of their own above them.
 */
export class Plot {
  readonly element: HTMLElement;
  private readonly chart: uPlot;
  private readonly canvas = document.createElement('canvas');
  private readonly context = this.canvas.getContext('2d')!;
  private readonly range: StableRange;
  private readonly shown: boolean[];
  private readonly entries: HTMLButtonElement[] = [];
  private readonly values: HTMLElement[] = [];
  private raster = new Raster(1, 1);
  private envelopes: Envelope[] = [];
  private bounds: readonly [low: number, high: number];
  private limit = 0;

  constructor(private readonly description: PlotDescription) {
    this.range = new StableRange(...description.base);
    this.bounds = description.base;
    this.shown = description.lines.map(() => true);
    this.element = document.createElement('figure');
    this.element.className = 'plot';
    const caption = document.createElement('figcaption');
    const title = document.createElement('h3');
    title.textContent = description.title;
    const note = document.createElement('p');
    note.textContent = description.note;
    caption.append(title, note, this.legend());
    const host = document.createElement('div');
    host.className = 'plot-host';
    host.setAttribute('role', 'img');
    host.setAttribute('aria-label', `${description.title}, in ${description.yLabel} over ${description.xLabel}`);
    this.element.append(caption, host);
    this.chart = new uPlot(this.options(), [[]], host);
    this.chart.over.append(this.canvas);
    new ResizeObserver(() => this.fit(host)).observe(host);
  }

  /** Shows data; `origin` is where in their time the zero of the x axis is. */
  update([time, ...signals]: PlotData, origin: number, now_s: number): void {
    this.fitRaster();
    const [from, to] = this.description.reach.map((value) => origin + value) as [number, number];
    let [low, high] = [Infinity, -Infinity];
    this.envelopes.forEach((envelope, index) => {
      findEnvelope(time, signals[index]!, from, to, envelope);
      if (!this.shown[index]) return;
      low = envelope.low.reduce((least, value) => Math.min(least, value), low);
      high = envelope.high.reduce((greatest, value) => Math.max(greatest, value), high);
    });
    this.bounds = this.range.update(low, high, now_s);
    const [min, max] = this.bounds;
    const { y } = this.chart.scales;
    if (min !== y!.min || max !== y!.max) this.chart.setScale('y', { min, max });
    this.drawLines();
  }

  /** Names a line anew in the legend, or leaves it out there. */
  nameLine(index: number, label: string, present: boolean): void {
    const entry = this.entries[index]!;
    entry.childNodes[1]!.textContent = label;
    entry.hidden = !present;
  }

  /** Says beside the name of a line how much it is. */
  tell(index: number, text: string): void {
    this.values[index]!.textContent = text;
  }

  /** Draws a level on both sides of zero that the lines of a limited signal cannot pass; none at 0. */
  markLimit(limit: number): void {
    if (limit === this.limit) return;
    this.limit = limit;
    this.chart.redraw(false, true);
  }

  /** Draws again, in the colours of now. */
  redraw(): void {
    this.chart.redraw(false, true);
    this.drawLines();
  }

  private drawLines(): void {
    const { raster, canvas, context } = this;
    raster.clear();
    this.description.lines.forEach((line, index) => {
      const envelope = this.envelopes[index];
      if (!this.shown[index] || !envelope) return;
      raster.draw(envelope, ...this.bounds, (line.width ?? 1.5) * devicePixelRatio, rgb(palette[line.colour]));
    });
    if (canvas.width !== raster.width || canvas.height !== raster.height) {
      canvas.width = raster.width;
      canvas.height = raster.height;
    }
    context.putImageData(new ImageData(raster.bytes, raster.width, raster.height), 0, 0);
  }

  private drawLimit({ ctx, bbox, valToPos }: uPlot): void {
    if (!(this.limit > 0)) return;
    ctx.save();
    ctx.strokeStyle = palette.muted;
    ctx.fillStyle = palette.muted;
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
    for (const level of [this.limit, -this.limit]) {
      const y = Math.round(valToPos(level, 'y', true)) + 0.5;
      if (y < bbox.top || y > bbox.top + bbox.height) continue;
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = 'left';
    ctx.textBaseline = 'bottom';
    ctx.fillText('limit of the motor', bbox.left + 4, valToPos(this.limit, 'y', true) - 2);
    ctx.restore();
  }

  private fitRaster(): void {
    const { width, height } = this.chart.bbox;
    if (this.raster.width === width && this.raster.height === height) return;
    this.raster = new Raster(width, height);
    this.envelopes = this.description.lines.map(() => makeEnvelope(width));
  }

  private fit(host: HTMLElement): void {
    const width = Math.floor(host.clientWidth);
    if (width > 0 && width !== this.chart.width) this.chart.setSize({ width, height: this.description.height });
  }

  private legend(): HTMLElement {
    const legend = document.createElement('div');
    legend.className = 'legend';
    legend.setAttribute('role', 'group');
    legend.setAttribute('aria-label', `Lines of: ${this.description.title}`);
    this.description.lines.forEach((line, index) => {
      const entry = document.createElement('button');
      entry.type = 'button';
      entry.setAttribute('aria-pressed', 'true');
      entry.title = 'Show or hide this line';
      const swatch = document.createElement('span');
      swatch.className = 'swatch';
      swatch.style.setProperty('background', `var(--${line.colour})`);
      const value = document.createElement('span');
      value.className = 'value';
      this.values.push(value);
      entry.append(swatch, line.label, value);
      this.entries.push(entry);
      entry.addEventListener('click', () => {
        this.shown[index] = !this.shown[index];
        entry.setAttribute('aria-pressed', String(this.shown[index]));
        this.drawLines();
      });
      legend.append(entry);
    });
    return legend;
  }

  private options(): uPlot.Options {
    const { xLabel, yLabel, height, reach, base, xStep } = this.description;
    const xText = this.description.xText ?? ((value: number) => String(value).replace('-', '−'));
    const axis: uPlot.Axis = {
      stroke: () => palette.muted,
      grid: { stroke: () => palette.grid, width: 1 },
      ticks: { show: false },
      font: '12px system-ui, sans-serif',
      labelFont: '12px system-ui, sans-serif',
      labelSize: 18,
      labelGap: 0,
      gap: 4,
    };
    return {
      width: 320,
      height,
      legend: { show: false },
      cursor: { show: false },
      padding: [8, 12, 0, 0],
      scales: { x: { time: false, range: [...reach] }, y: { min: base[0], max: base[1], range: (_chart, min, max) => [min, max] } },
      axes: [
        {
          ...axis,
          size: 32,
          // Clear of the lowest mark of the other axis.
          gap: 10,
          label: xLabel,
          splits: (_chart, _axis, min, max) => marks(min, max, xStep),
          values: (_chart, splits) => splits.map(xText),
        },
        { ...axis, size: 42, space: 24, label: yLabel, values: (_chart, splits) => splits.map(minusSign) },
      ],
      series: [{}],
      hooks: { drawAxes: [(chart) => this.drawLimit(chart)] },
    };
  }
}

/** Multiples of `step`. */
function marks(min: number, max: number, step: number): number[] {
  const values: number[] = [];
  for (let k = Math.ceil(min / step); k <= Math.floor(max / step); ++k) values.push(k * step);
  return values;
}

function minusSign(value: number): string {
  return String(Number(value.toPrecision(6))).replace('-', '−');
}
