// SPDX-License-Identifier: Apache-2.0
import type { ParameterValue } from '../protocol/foxglove';
import type { Session } from '../state/session';
import { makeControl, type Control } from './control';

/** Where controls stand: the methods with their loops, the switch of the mode with the actions, the rest in the panel. */
export interface Places {
  readonly methods: Readonly<Record<string, HTMLElement>>;
  readonly mode: HTMLElement;
  readonly panel: HTMLElement;
  readonly locked: HTMLElement;
}

/** Changes are sent at most once a frame: of a slider that is dragged, the latest value. */
class Sender {
  private readonly waiting = new Map<string, ParameterValue>();

  constructor(private readonly send: (values: ReadonlyMap<string, ParameterValue>) => void) {}

  change(name: string, value: ParameterValue): void {
    if (this.waiting.size === 0) requestAnimationFrame(() => this.flush());
    this.waiting.set(name, value);
  }

  private flush(): void {
    this.send(new Map(this.waiting));
    this.waiting.clear();
  }
}

/** Builds the controls from the list of the server, anew whenever it is told, and keeps them at its values. */
export function buildControls(
  session: Session,
  places: Places,
  send: (values: ReadonlyMap<string, ParameterValue>) => void,
): void {
  const sender = new Sender(send);
  const controls = new Map<string, Control>();
  session.on('server', () => {
    controls.clear();
    const all = [places.mode, places.panel, ...Object.values(places.methods)];
    for (const place of all) place.replaceChildren();
    for (const parameter of session.described) {
      const control = makeControl(parameter, (name, value) => sender.change(name, value));
      const place = places.methods[parameter.name] ?? (parameter.name === 'side_by_side' ? places.mode : places.panel);
      place.append(control.element);
      controls.set(parameter.name, control);
      const value = session.values.get(parameter.name);
      if (value !== undefined) control.show(value);
    }
    places.locked.hidden = session.described.some((parameter) => parameter.tunable) || session.described.length === 0;
  });
  session.on('parameters', (values) => {
    for (const [name, value] of values) controls.get(name)?.show(value);
  });
}

/** A button that sets every parameter to what the server began with; off while nothing differs. */
export function restoreWith(
  button: HTMLButtonElement,
  session: Session,
  send: (values: ReadonlyMap<string, ParameterValue>) => void,
): void {
  const changed = (): Map<string, ParameterValue> => {
    const values = new Map<string, ParameterValue>();
    for (const { name, initial, tunable } of session.described) {
      if (tunable && initial !== undefined && session.values.get(name) !== initial) values.set(name, initial);
    }
    return values;
  };
  button.addEventListener('click', () => send(changed()));
  const show = (): void => {
    button.disabled = changed().size === 0;
  };
  session.on('server', show);
  session.on('parameters', show);
}
