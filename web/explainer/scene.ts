// SPDX-License-Identifier: Apache-2.0
import type { Contact } from './contact';

/** One machine, drawn: your hand and handle, the robot finger, the wall, and the force on your hand. */

const names = 'http://www.w3.org/2000/svg';
export const wall_mm = 10;
/** Of the drawing: from left to right, in millimetres of the handle. */
export const range_mm = { least: -3, most: 14 } as const;
const width = 340;
const perMillimetre = width / (range_mm.most - range_mm.least);
const handY = 46;
const tipY = 118;
const arrowPerNewton = 26;

function xOf(position_mm: number): number {
  return (Math.min(Math.max(position_mm, range_mm.least), range_mm.most) - range_mm.least) * perMillimetre;
}

function add<K extends keyof SVGElementTagNameMap>(parent: Element, tag: K, attributes: Record<string, string | number>, text = ''): SVGElementTagNameMap[K] {
  const element = document.createElementNS(names, tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.textContent = text;
  parent.append(element);
  return element;
}

export class Scene {
  readonly element = document.createElementNS(names, 'svg');
  private readonly handle: SVGGElement;
  private readonly ghost: SVGCircleElement;
  private readonly tip: SVGGElement;
  private readonly link: SVGLineElement;
  private readonly arrow: SVGPathElement;

  constructor() {
    this.element.setAttribute('viewBox', `0 0 ${width} 150`);
    this.element.setAttribute('aria-hidden', 'true');
    this.element.classList.add('scene');
    add(this.element, 'text', { x: 4, y: 16, class: 'label leader' }, 'your handle');
    add(this.element, 'text', { x: 4, y: 98, class: 'label follower' }, 'robot finger');
    add(this.element, 'line', { x1: 0, x2: width, y1: handY + 22, y2: handY + 22, class: 'rail' });
    add(this.element, 'rect', { x: xOf(wall_mm), y: 90, width: width - xOf(wall_mm), height: 56, class: 'wall' });
    add(this.element, 'text', { x: xOf(wall_mm) + 8, y: 123, class: 'label' }, 'wall');
    this.link = add(this.element, 'line', { class: 'link', y1: handY, y2: tipY });
    this.ghost = add(this.element, 'circle', { cy: handY, r: 17, class: 'ghost' });
    this.handle = add(this.element, 'g', {});
    add(this.handle, 'circle', { cy: handY, r: 17, class: 'handle-shape' });
    this.arrow = add(this.element, 'path', { class: 'arrow' });
    this.tip = add(this.element, 'g', {});
    add(this.tip, 'path', { d: `M-46 ${tipY - 9} H-12 A9 9 0 0 1 -12 ${tipY + 9} H-46 Z`, transform: 'translate(3 0)', class: 'tip-shape' });
  }

  draw({ now }: Contact): void {
    const handle = xOf(now.leader_mm);
    const tip = xOf(now.tip_mm);
    this.handle.setAttribute('transform', `translate(${handle.toFixed(2)} 0)`);
    this.ghost.setAttribute('cx', xOf(now.intended_mm).toFixed(2));
    this.tip.setAttribute('transform', `translate(${tip.toFixed(2)} 0)`);
    this.link.setAttribute('x1', handle.toFixed(2));
    this.link.setAttribute('x2', (tip - 24).toFixed(2));
    const length = Math.min(Math.abs(now.displayed_N) * arrowPerNewton, 70);
    const toward = now.displayed_N >= 0 ? -1 : 1;
    const from = handle + 17 * toward;
    const to = from + toward * length;
    this.arrow.setAttribute('d', length < 1 ? '' : `M${from} ${handY} H${to} m${-6 * toward} -5 L${to} ${handY} l${-6 * toward} 5`);
  }
}
