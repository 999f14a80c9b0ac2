import uPlot from 'uplot';
import { palette, type ColourName } from '../scene/palette';
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
  readonly base: readonly [number, number];
  readonly height: number;
  /** Labels of the x axis; by default the values themselves. */
  readonly xText?: (value: number, latest: number) => string;
  /** Distance of the marks of the x axis. */
  readonly xStep: number;
}

export type PlotData = readonly [Float64Array, ...Float32Array[]];

/** A plot with a title, a legend whose entries show and hide lines, and axes with units. */
export class Plot {
  readonly element: HTMLElement;
  private readonly chart: uPlot;
  private readonly range: StableRange;
  private readonly shown: boolean[];
  private readonly entries: HTMLButtonElement[] = [];
  private latest = 0;
  /** Stretches of x without data, which no line may cross. */
  gaps: readonly { readonly from: number; readonly to: number }[] = [];

  constructor(private readonly description: PlotDescription) {
    this.range = new StableRange(...description.base);
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
    host.setAttribute('aria-label', `${description.title}: ${description.yLabel} over ${description.xLabel}`);
    this.element.append(caption, host);
    this.chart = new uPlot(this.options(), [[], ...description.lines.map(() => [])], host);
    new ResizeObserver(() => this.fit(host)).observe(host);
  }

  /** Shows data from `from` to `to` on the x axis. */
  update(data: PlotData, from: number, to: number, now_s: number): void {
    this.latest = to;
    const [low, high] = this.range.update(...this.extremes(data, from), now_s);
    this.chart.batch(() => {
      this.chart.setData(data as unknown as uPlot.AlignedData, false);
      this.chart.setScale('x', { min: from, max: to });
      this.chart.setScale('y', { min: low, max: high });
    });
  }

  /** Names a line anew in the legend, or leaves it out there. */
  nameLine(index: number, label: string, present: boolean): void {
    const entry = this.entries[index]!;
    entry.lastChild!.textContent = label;
    entry.hidden = !present;
  }

  /** Draws again, in the colours of now. */
  redraw(): void {
    this.chart.redraw(false, true);
  }

  private fit(host: HTMLElement): void {
    const width = Math.floor(host.clientWidth);
    if (width > 0 && width !== this.chart.width) this.chart.setSize({ width, height: this.description.height });
  }

  private extremes([time, ...signals]: PlotData, from: number): [number, number] {
    let low = Infinity;
    let high = -Infinity;
    signals.forEach((values, index) => {
      if (!this.shown[index]) return;
      for (let i = values.length - 1; i >= 0 && time[i]! >= from; --i) {
        const value = values[i]!;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    });
    return [low, high];
  }

  private legend(): HTMLElement {
    const legend = document.createElement('div');
    legend.className = 'legend';
    this.description.lines.forEach((line, index) => {
      const entry = document.createElement('button');
      entry.type = 'button';
      entry.setAttribute('aria-pressed', 'true');
      entry.title = 'Show or hide this line';
      const swatch = document.createElement('span');
      swatch.className = 'swatch';
      swatch.style.setProperty('background', `var(--${line.colour})`);
      entry.append(swatch, line.label);
      this.entries.push(entry);
      entry.addEventListener('click', () => {
        this.shown[index] = !this.shown[index];
        entry.setAttribute('aria-pressed', String(this.shown[index]));
        this.chart.setSeries(index + 1, { show: this.shown[index]! });
      });
      legend.append(entry);
    });
    return legend;
  }

  private options(): uPlot.Options {
    const { xLabel, yLabel, lines, height, xStep } = this.description;
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
    const latest = (): number => this.latest;
    return {
      width: 320,
      height,
      legend: { show: false },
      cursor: { show: false },
      padding: [8, 12, 0, 0],
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      axes: [
        {
          ...axis,
          size: 32,
          // Clear of the lowest mark of the other axis.
          gap: 10,
          label: xLabel,
          splits: (_chart, _axis, min, max) => marks(min, max, xStep, this.description.xText ? latest() : 0),
          values: (_chart, splits) => splits.map((value) => xText(value, latest())),
        },
        { ...axis, size: 42, space: 24, label: yLabel, values: (_chart, splits) => splits.map(minusSign) },
      ],
      series: [
        {},
        ...lines.map((line) => ({
          label: line.label,
          stroke: () => palette[line.colour],
          width: line.width ?? 1.5,
          points: { show: false },
          gaps: (chart: uPlot) => this.gapPixels(chart),
        })),
      ],
    };
  }

  private gapPixels(chart: uPlot): [number, number][] {
    return this.gaps
      .filter(({ to }) => to > (chart.scales.x?.min ?? 0))
      .map(({ from, to }) => [chart.valToPos(from, 'x', true), chart.valToPos(to, 'x', true)]);
  }
}

/** Multiples of `step` away from `origin`. */
function marks(min: number, max: number, step: number, origin: number): number[] {
  const values: number[] = [];
  for (let k = Math.ceil((min - origin) / step - 1e-6); origin + k * step <= max + 1e-6 * step; ++k) {
    values.push(origin + k * step);
  }
  return values;
}

function minusSign(value: number): string {
  return String(Number(value.toPrecision(6))).replace('-', '−');
}
