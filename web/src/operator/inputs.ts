// SPDX-License-Identifier: Apache-2.0
import type { Hand, HandPoint } from './hand';

/** Mouse, touch and pen on a scene; keys on a handle; a gamepad. All move the one hand. */

export interface Place {
  /** How far a drag by so many pixels of the screen, right and down, moves the hand. */
  dragged_m(right: number, down: number): HandPoint;
  /** Where the handle is now. */
  handle_m(): HandPoint;
  wall_m(): number;
  /** How far each of the keys that move the hand moves it. */
  readonly keySteps: KeySteps;
}

/** The scene is dragged anywhere: a finger need not cover the handle. Where the hand has one axis, vertical moves scroll the page (`touch-action`). */
export function dragWithPointer(scene: HTMLElement, hand: Hand, place: Place): void {
  let pointer: number | undefined;
  let startX = 0;
  let startY = 0;
  let start_m: HandPoint = [0, 0, 0];
  scene.addEventListener('pointerdown', (event) => {
    if (pointer !== undefined || event.button !== 0) return;
    pointer = event.pointerId;
    scene.setPointerCapture(pointer);
    startX = event.clientX;
    startY = event.clientY;
    start_m = hand.engaged ? hand.point_m : place.handle_m();
    hand.grasp(start_m);
  });
  scene.addEventListener('pointermove', (event) => {
    if (event.pointerId !== pointer) return;
    hand.moveTo(sum(start_m, place.dragged_m(event.clientX - startX, event.clientY - startY)));
  });
  const end = (event: PointerEvent): void => {
    if (event.pointerId !== pointer) return;
    pointer = undefined;
    hand.release();
  };
  scene.addEventListener('pointerup', end);
  scene.addEventListener('pointercancel', end);
}

export type KeySteps = Readonly<Record<string, HandPoint>>;

/** Arrow keys move by 0.5 mm, page keys by 2 mm. */
export const axisKeys: KeySteps = {
  ArrowLeft: [-0.5e-3, 0, 0],
  ArrowDown: [-0.5e-3, 0, 0],
  ArrowRight: [0.5e-3, 0, 0],
  ArrowUp: [0.5e-3, 0, 0],
  PageDown: [-2e-3, 0, 0],
  PageUp: [2e-3, 0, 0],
};

/** Up and down move by 1 mm from the wall and to it, the others by 5 mm across. */
export const armKeys: KeySteps = {
  ArrowUp: [-1e-3, 0, 0],
  ArrowDown: [1e-3, 0, 0],
  ArrowLeft: [0, 0, -5e-3],
  ArrowRight: [0, 0, 5e-3],
  PageDown: [0, -5e-3, 0],
  PageUp: [0, 5e-3, 0],
};

function sum([a, b, c]: HandPoint, [x, y, z]: HandPoint): HandPoint {
  return [a + x, b + y, c + z];
}

/** Arrow and page keys move as the place has it; Home is rest, End presses 4 mm into the wall, Escape lets go. */
export function moveWithKeys(handle: HTMLElement, hand: Hand, place: Place, tap: () => void): void {
  handle.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = place.keySteps[event.key];
    if (step !== undefined) hand.grasp(sum(hand.engaged ? hand.point_m : place.handle_m(), step));
    else if (event.key === 'Home') hand.grasp(0);
    else if (event.key === 'End') hand.grasp(place.wall_m() + 4e-3);
    else if (event.key === 'Escape') hand.release();
    else if (event.key === ' ' || event.key === 'Enter') tap();
    else return;
    event.preventDefault();
  });
  handle.addEventListener('blur', () => hand.release());
}

const deadZone = 0.08;

/** The left stick of the first gamepad places the hand between its ends; the first button taps. */
export class GamepadInput {
  private held = false;
  private pressed = false;

  constructor(
    private readonly hand: Hand,
    private readonly tap: () => void,
    private readonly gamepads: () => readonly (Pick<Gamepad, 'axes' | 'buttons'> | null)[] = () =>
      navigator.getGamepads(),
  ) {}

  /** Reads the gamepad; called every frame. */
  poll(): void {
    const gamepad = this.gamepads().find((one) => one !== null);
    if (!gamepad) return;
    const axis = gamepad.axes[0] ?? 0;
    if (Math.abs(axis) > deadZone) {
      const share = (Math.abs(axis) - deadZone) / (1 - deadZone);
      const [lowest_m, highest_m] = this.hand.reach[0];
      this.hand.grasp(axis > 0 ? share * highest_m : share * lowest_m);
      this.held = true;
    } else if (this.held) {
      this.held = false;
      this.hand.release();
    }
    const pressed = gamepad.buttons[0]?.pressed ?? false;
    if (pressed && !this.pressed) this.tap();
    this.pressed = pressed;
  }
}
