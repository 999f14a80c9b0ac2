// SPDX-License-Identifier: Apache-2.0
import { step_s, window_s, type Contact } from './contact';

/** The force on the wall in the quarter of a second after the touch. */

const names = 'http://www.w3.org/2000/svg';
const width = 340;
const height = 84;
const left = 30;
const bottom = 66;
const top = 8;

function add(parent: Element, tag: 'text' | 'line' | 'path', attributes: Record<string, string | number>, text = ''): SVGElement {
  const element = document.createElementNS(names, tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.textContent = text;
  parent.append(element);
  return element;
}

export class Trace {
  readonly element = document.createElementNS(names, 'svg');
  private readonly curve: SVGElement;
  private readonly most: SVGElement;
  private drawn = '';

  constructor() {
    this.element.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.element.classList.add('trace');
    this.element.setAttribute('role', 'img');
    add(this.element, 'line', { x1: left, x2: width, y1: bottom, y2: bottom, class: 'axis' });
    add(this.element, 'text', { x: left, y: height - 4, class: 'label' }, 'touch');
    add(this.element, 'text', { x: width, y: height - 4, class: 'label', 'text-anchor': 'end' }, `${1000 * window_s} ms later`);
    this.most = add(this.element, 'text', { x: left - 4, y: top + 8, class: 'label', 'text-anchor': 'end' });
    this.curve = add(this.element, 'path', { class: 'curve' });
  }

  draw(contact: Contact, words: string): void {
    const state = `${contact.number} ${contact.filled} ${contact.verdict}`;
    if (state === this.drawn) return;
    this.drawn = state;
    this.element.setAttribute('aria-label', `Force on the wall after the touch. ${words}`);
    const most_N = Math.max(1, Math.ceil(Math.max(...contact.force_N.subarray(0, contact.filled), 0)));
    this.most.textContent = `${most_N} N`;
    let path = '';
    for (let i = 0; i < contact.filled; ++i) {
      const x = left + ((width - left) * i * step_s) / window_s;
      const y = bottom - ((bottom - top) * contact.force_N[i]!) / most_N;
      path += `${i === 0 ? 'M' : 'L'}${x.toFixed(1)} ${y.toFixed(1)}`;
    }
    this.curve.setAttribute('d', path);
  }
}
