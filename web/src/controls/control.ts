// SPDX-License-Identifier: Apache-2.0
import type { ParameterValue } from '../protocol/foxglove';
import { fromSlider, sliderSteps, toSlider, valueText, type ParameterDescription } from '../state/parameters';

/** A control for one parameter, made from what the server tells of it. */
export interface Control {
  readonly element: HTMLElement;
  /** Shows the server's value, unless the visitor is moving the control. */
  show(value: ParameterValue): void;
}

export type Change = (name: string, value: ParameterValue) => void;

let controls = 0;

export function makeControl(parameter: ParameterDescription, change: Change): Control {
  const element = document.createElement('div');
  element.className = `control control-${parameter.kind}`;
  element.dataset.parameter = parameter.name;
  const id = `control-${++controls}`;
  const label = document.createElement('label');
  label.htmlFor = id;
  label.textContent = parameter.label;
  const makers = { number: makeSlider, choice: makeChoice, flag: makeFlag };
  const { input, show } = makers[parameter.kind](parameter, element, change);
  input.id = id;
  input.disabled = !parameter.tunable;
  element.prepend(label);
  return {
    element,
    show: (value) => {
      element.dataset.value = String(value);
      show(value);
    },
  };
}

interface Parts {
  readonly input: HTMLInputElement | HTMLSelectElement;
  readonly show: (value: ParameterValue) => void;
}

function makeSlider(parameter: ParameterDescription, element: HTMLElement, change: Change): Parts {
  const input = document.createElement('input');
  const output = document.createElement('output');
  input.type = 'range';
  input.min = '0';
  input.max = String(sliderSteps);
  let moving = false;
  let latest: number | undefined;
  const place = (value: number): void => {
    const text = valueText(parameter, value);
    output.textContent = text;
    input.setAttribute('aria-valuetext', text);
  };
  const settle = (): void => {
    moving = false;
    if (latest === undefined) return;
    input.value = String(toSlider(parameter, latest));
    place(latest);
  };
  input.addEventListener('pointerdown', () => (moving = true));
  input.addEventListener('pointerup', settle);
  input.addEventListener('pointercancel', settle);
  input.addEventListener('input', () => {
    const value = fromSlider(parameter, Number(input.value));
    place(value);
    latest = value;
    change(parameter.name, value);
  });
  element.append(input, output);
  return {
    input,
    show: (value) => {
      latest = Number(value);
      if (!moving) settle();
    },
  };
}

function makeChoice(parameter: ParameterDescription, element: HTMLElement, change: Change): Parts {
  const input = document.createElement('select');
  for (const choice of parameter.choices) input.append(new Option(valueText(parameter, choice), choice));
  input.addEventListener('change', () => change(parameter.name, input.value));
  const explanation = document.createElement('p');
  explanation.className = 'explanation small';
  element.append(input, explanation);
  return {
    input,
    show: (value) => {
      input.value = String(value);
      explanation.textContent = parameter.explanations[parameter.choices.indexOf(input.value)] ?? '';
    },
  };
}

function makeFlag(parameter: ParameterDescription, element: HTMLElement, change: Change): Parts {
  const input = document.createElement('input');
  input.type = 'checkbox';
  input.setAttribute('role', 'switch');
  input.addEventListener('change', () => change(parameter.name, input.checked));
  element.append(input);
  return { input, show: (value) => (input.checked = value === true) };
}
