// SPDX-License-Identifier: Apache-2.0
import type { Side } from '../kernel/kernel';
import { Contact, sentence } from './contact';
import { kinds, type Kind, type Knob } from './kinds';
import type { Order, Report } from './orders';
import { range_mm, Scene } from './scene';
import { Trace } from './trace';

/** With reduced motion the picture moves in steps. */
const stepEvery_ms = matchMedia('(prefers-reduced-motion: reduce)').matches ? 250 : 0;
const keySteps: Readonly<Record<string, number>> = { ArrowRight: 0.5, ArrowUp: 0.5, ArrowLeft: -0.5, ArrowDown: -0.5, PageUp: 2, PageDown: -2 };

interface View {
  readonly name: string;
  readonly contact: Contact;
  readonly scene: Scene;
  readonly trace: Trace;
  readonly verdict: HTMLElement;
  readonly results: HTMLElement;
  /** The number of the contact that was last written down. */
  noted: number;
}

function create<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Partial<HTMLElementTagNameMap[K]> = {}, ...children: Node[]): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** One figure: one or two machines under one hand, what the reader can change, and what came out. */
export class TactusFigure extends HTMLElement {
  private readonly worker = new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' });
  private readonly views: View[] = [];
  private readonly values = new Map<string, number>();
  private handle!: HTMLElement;
  private tapStart_mm = 0;
  private aim_mm = 0;
  private tapping = false;
  private drawnAt_ms = -Infinity;

  connectedCallback(): void {
    const name = this.getAttribute('kind') ?? '';
    const kind = kinds[name];
    if (!kind) throw new Error(`there is no figure of the kind "${name}"`);
    const state = new URLSearchParams(location.hash.slice(1));
    for (const knob of kind.knobs) {
      const wanted = Number(state.get(`${name}.${knob.name}`) ?? knob.initial);
      this.values.set(knob.name, wanted >= knob.least && wanted <= knob.most ? wanted : knob.initial);
    }
    this.build(kind, name);
    this.worker.addEventListener('message', (event: MessageEvent<Report>) => this.take(event.data));
    this.order({ settings: [...kind.fixed, ...kind.knobs.flatMap((knob) => knob.settings(this.values.get(knob.name)!))], fresh: true });
    // Only a figure that can be seen runs.
    new IntersectionObserver((entries) => this.order({ run: entries.some((entry) => entry.isIntersecting) })).observe(this);
    const frame = (now_ms: number): void => {
      this.draw(now_ms);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  private order(order: Order): void {
    this.worker.postMessage(order);
  }

  private build(kind: Kind, name: string): void {
    const machines = create('div', { className: 'machines' });
    this.handle = create('div', { className: 'touch', tabIndex: 0 });
    const about: Record<string, string> = {
      role: 'slider',
      'aria-label': 'Handle. Arrows move it, Space taps the wall, Home and Escape let it rest.',
      'aria-valuemin': String(range_mm.least),
      'aria-valuemax': String(range_mm.most),
      'aria-valuenow': '0',
      'aria-valuetext': 'at rest',
    };
    for (const [key, value] of Object.entries(about)) this.handle.setAttribute(key, value);
    for (const { side, name: shown } of kind.shown) machines.append(this.machine(side, shown));
    machines.append(this.handle);
    this.listenToHand();
    const tap = create('button', { className: 'primary', type: 'button', textContent: 'Tap the wall' });
    tap.addEventListener('click', () => this.tap());
    const panel = create('div', { className: 'knobs' }, tap, ...kind.knobs.map((knob) => this.knob(knob, name)));
    this.append(machines, panel);
  }

  private machine(side: Side, name: string): HTMLElement {
    const contact = new Contact(side);
    const view: View = {
      name,
      contact,
      scene: new Scene(),
      trace: new Trace(),
      verdict: create('p', { className: 'verdict' }),
      results: create('ol', { className: 'results' }),
      noted: 0,
    };
    view.verdict.setAttribute('role', 'status');
    view.results.setAttribute('aria-label', `Taps so far, ${name}`);
    view.results.hidden = true;
    this.views.push(view);
    return create('div', { className: 'machine' }, create('h3', { textContent: name }), view.scene.element, view.verdict, view.trace.element, view.results);
  }

  private knob(knob: Knob, figure: string): HTMLElement {
    const value = this.values.get(knob.name)!;
    const output = create('output', { textContent: knob.text(value) });
    const range = create('input', { type: 'range', min: String(knob.least), max: String(knob.most), step: String(knob.step) });
    range.value = String(value);
    range.name = knob.name;
    range.setAttribute('aria-valuetext', knob.text(value));
    range.addEventListener('input', () => {
      const wanted = Number(range.value);
      this.values.set(knob.name, wanted);
      output.textContent = knob.text(wanted);
      range.setAttribute('aria-valuetext', knob.text(wanted));
      this.order({ settings: knob.settings(wanted) });
      const state = new URLSearchParams(location.hash.slice(1));
      state.set(`${figure}.${knob.name}`, range.value);
      history.replaceState(null, '', `#${state.toString()}`);
    });
    return create('label', { className: 'knob' }, create('span', { textContent: knob.label }), range, output);
  }

  private listenToHand(): void {
    let grabbed: { x: number; from_mm: number } | undefined;
    this.handle.addEventListener('pointerdown', (event) => {
      this.handle.setPointerCapture(event.pointerId);
      grabbed = { x: event.clientX, from_mm: this.aim_mm };
    });
    this.handle.addEventListener('pointermove', (event) => {
      const picture = this.querySelector('.scene')?.getBoundingClientRect();
      if (!grabbed || !picture) return;
      this.aim(grabbed.from_mm + ((event.clientX - grabbed.x) / picture.width) * (range_mm.most - range_mm.least));
    });
    const release = (): void => {
      grabbed = undefined;
      this.aim(0);
    };
    this.handle.addEventListener('pointerup', release);
    this.handle.addEventListener('pointercancel', release);
    this.handle.addEventListener('keydown', (event) => {
      const step_mm = keySteps[event.key];
      if (step_mm !== undefined) this.aim(this.aim_mm + step_mm);
      else if (event.key === ' ' || event.key === 'Enter') this.tap();
      else if (event.key === 'Home' || event.key === 'Escape') this.aim(0);
      else return;
      event.preventDefault();
    });
  }

  /** Up to where a tap starts the hand follows the reader; from there on the tap plays. */
  private aim(position_mm: number): void {
    if (this.tapping) return;
    if (position_mm > this.tapStart_mm) return this.tap();
    this.aim_mm = Math.max(position_mm, range_mm.least);
    this.order({ aim_m: this.aim_mm / 1000 });
  }

  private tap(): void {
    if (this.tapping || this.tapStart_mm === 0) return;
    this.tapping = true;
    this.aim_mm = 0;
    for (const { contact } of this.views) contact.restart();
    this.order({ tap: true });
  }

  private take(report: Report): void {
    if (report.ready) {
      this.tapStart_mm = 1000 * report.ready.tapStart_m;
      this.dataset.state = 'ready';
    }
    if (report.failed) {
      this.dataset.state = 'failed';
      for (const { verdict } of this.views) verdict.textContent = `The figure cannot run: ${report.failed}`;
    }
    if (!report.rows) return;
    for (const { contact } of this.views) contact.take(report.rows);
    const { now } = this.views[0]!.contact;
    // A tap ends at the place of rest.
    const judged = this.views.every(({ contact, noted }) => contact.now.stopped || (contact.number > noted && contact.verdict !== 'contact'));
    if (this.tapping && judged && Math.abs(now.hand_mm) < 0.01) this.note();
  }

  /** The tap is over: its result stays, with what was set. */
  private note(): void {
    this.tapping = false;
    const settings = [...this.querySelectorAll<HTMLOutputElement>('output')].map((output) => output.textContent).join(', ');
    for (const view of this.views) {
      view.noted = view.contact.number;
      const result = create('li', { textContent: `${settings}: ${sentence(view.contact)}` });
      result.dataset.verdict = view.contact.verdict;
      view.results.hidden = false;
      view.results.prepend(result);
      while (view.results.childElementCount > 4) view.results.lastElementChild?.remove();
    }
    this.dataset.taps = String(Number(this.dataset.taps ?? 0) + 1);
  }

  private draw(now_ms: number): void {
    if (now_ms - this.drawnAt_ms < stepEvery_ms || this.dataset.state === 'failed') return;
    this.drawnAt_ms = now_ms;
    for (const { contact, scene, trace, verdict } of this.views) {
      const words = sentence(contact);
      scene.draw(contact);
      trace.draw(contact, words);
      if (verdict.textContent !== words) verdict.textContent = words;
      verdict.dataset.verdict = contact.now.stopped ? 'rings' : contact.verdict;
    }
    const hand_mm = this.views[0]!.contact.now.leader_mm;
    this.handle.setAttribute('aria-valuenow', hand_mm.toFixed(1));
    this.handle.setAttribute('aria-valuetext', `${hand_mm.toFixed(1)} mm`);
  }
}
