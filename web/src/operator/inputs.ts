import { highest_m, lowest_m, type Hand } from './hand';

/** Mouse, touch and pen on a scene; keys on a handle; a gamepad. All move the one hand. */

export interface Place {
  /** Millimetres of the scene per pixel of the screen. */
  millimetresPerPixel(): number;
  /** Where the handle is now. */
  handle_m(): number;
  wall_m(): number;
}

/** The scene is dragged anywhere: a finger need not cover the handle. Vertical moves scroll the page (`touch-action`). */
export function dragWithPointer(scene: HTMLElement, hand: Hand, place: Place): void {
  let pointer: number | undefined;
  let startX = 0;
  let start_m = 0;
  scene.addEventListener('pointerdown', (event) => {
    if (pointer !== undefined || event.button !== 0) return;
    pointer = event.pointerId;
    scene.setPointerCapture(pointer);
    startX = event.clientX;
    start_m = hand.engaged ? hand.position_m : place.handle_m();
    hand.grasp(start_m);
  });
  scene.addEventListener('pointermove', (event) => {
    if (event.pointerId !== pointer) return;
    hand.moveTo(start_m + 1e-3 * (event.clientX - startX) * place.millimetresPerPixel());
  });
  const end = (event: PointerEvent): void => {
    if (event.pointerId !== pointer) return;
    pointer = undefined;
    hand.release();
  };
  scene.addEventListener('pointerup', end);
  scene.addEventListener('pointercancel', end);
}

const keySteps: Readonly<Record<string, number>> = {
  ArrowLeft: -0.5e-3,
  ArrowDown: -0.5e-3,
  ArrowRight: 0.5e-3,
  ArrowUp: 0.5e-3,
  PageDown: -2e-3,
  PageUp: 2e-3,
};

/** Arrow keys move by 0.5 mm, page keys by 2 mm; Home is rest, End presses 4 mm into the wall, Escape lets go. */
export function moveWithKeys(handle: HTMLElement, hand: Hand, place: Place, tap: () => void): void {
  handle.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = keySteps[event.key];
    if (step !== undefined) hand.grasp((hand.engaged ? hand.position_m : place.handle_m()) + step);
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
