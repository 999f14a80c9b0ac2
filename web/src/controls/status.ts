// SPDX-License-Identifier: Apache-2.0
import { Sound } from '../sound/sound';
import { sides, type Session } from '../state/session';

/** Everything that tells how the page itself fares: connection, notices, sound, the line at the end. */

export function element<Kind extends HTMLElement = HTMLElement>(id: string): Kind {
  return document.getElementById(id) as Kind;
}

export function showConnection(session: Session): void {
  const pill = element('connection');
  session.on('connection', (connection) => {
    pill.dataset.state = connection.state;
    document.body.dataset.connection = connection.state;
    pill.textContent = {
      connecting: 'connecting …',
      open: 'connected',
      silent: 'nothing comes from the server',
      lost: 'connection lost, trying again',
    }[connection.state];
  });
}

const noticeTime_ms = 8000;
const mostNotices = 3;

/** Warnings and errors of the server, in its own words, for a while. */
export function showNotices(session: Session): void {
  const list = element('notices');
  session.on('notice', ({ level, text, id }) => {
    if (level === 0) return;
    const notice = document.createElement('p');
    if (id !== undefined) {
      notice.dataset.id = id;
      for (const earlier of [...list.children]) if ((earlier as HTMLElement).dataset.id === id) earlier.remove();
    }
    notice.textContent = `${level === 1 ? '⚠ ' : '✕ '}${text}`;
    list.append(notice);
    while (list.childElementCount > mostNotices) list.firstElementChild?.remove();
    setTimeout(() => notice.remove(), noticeTime_ms);
  });
}

/** The explanation shows until it was dismissed once; the button brings it back. */
export function showIntroduction(): void {
  const intro = element('intro');
  const help = element('help');
  const show = (visible: boolean): void => {
    intro.hidden = !visible;
    help.setAttribute('aria-expanded', String(visible));
  };
  show(!wasSeen());
  help.addEventListener('click', () => show(intro.hidden === true));
  element('dismiss').addEventListener('click', () => {
    rememberSeen();
    show(false);
    element('help').focus();
  });
}

const seenKey = 'tactus.introduction-seen';

/** A browser that keeps nothing shows the explanation each time. */
function wasSeen(): boolean {
  try {
    return localStorage.getItem(seenKey) !== null;
  } catch {
    return false;
  }
}

function rememberSeen(): void {
  try {
    localStorage.setItem(seenKey, 'yes');
  } catch {
    // Nothing is kept, and nothing is lost.
  }
}

export function showSound(sound: Sound, session: Session): void {
  const button = element<HTMLButtonElement>('sound');
  const volume = element<HTMLInputElement>('volume');
  if (!Sound.available) {
    button.disabled = volume.disabled = true;
    button.title = 'This browser plays sound only from https or from the machine itself.';
    return;
  }
  let on = false;
  button.addEventListener('click', () => {
    on = !on;
    button.setAttribute('aria-pressed', String(on));
    button.textContent = on ? 'Sound: on' : 'Sound: off';
    sound.turn(on).catch((error: unknown) => session.onStatus(1, `No sound: ${String(error)}`));
  });
  volume.addEventListener('input', () => sound.setVolume(Number(volume.value) / 100));
}

/** The line at the end, renewed once a second. */
export class HealthLine {
  private frames = 0;
  private since_s: number | undefined;
  private readonly line = element('health');

  constructor(
    private readonly session: Session,
    private readonly undecodable: () => number,
  ) {}

  frame(now_s: number): void {
    this.since_s ??= now_s;
    this.frames += 1;
    const elapsed_s = now_s - this.since_s;
    if (elapsed_s < 1) return;
    const rate = this.frames / elapsed_s;
    this.frames = 0;
    this.since_s = now_s;
    this.line.dataset.framesPerSecond = rate.toFixed(1);
    const loops = sides.filter((side) => side === 'left' || this.session.sideBySide).map((s) => this.session.loops[s]);
    const dropped = loops.reduce((sum, loop) => sum + loop.state.dropped, 0);
    const missing = loops.reduce((sum, loop) => sum + loop.missingPieces, 0);
    const texts = [
      `${rate.toFixed(0)} pictures a second`,
      `server at ${this.session.loops.left.state.realTimeRatio.toFixed(2)} × real time`,
      dropped === 0 ? 'nothing dropped' : `⚠ ${dropped} messages dropped by the server, for this page was too slow`,
    ];
    if (missing > 0) texts.push(`⚠ ${missing} ${missing === 1 ? 'gap' : 'gaps'} in the plots`);
    if (this.undecodable() > 0) texts.push(`⚠ ${this.undecodable()} messages could not be read`);
    this.line.textContent = texts.join(' · ');
  }
}
