// SPDX-License-Identifier: Apache-2.0
import 'uplot/dist/uPlot.min.css';
import './base.css';
import './controls/controls.css';
import './plots/plots.css';
import './loop.css';
import './page.css';
import { keepLink } from './controls/link';
import { buildControls, restoreWith } from './controls/parameters';
import { element, HealthLine, showConnection, showIntroduction, showNotices, showSound } from './controls/status';
import { LoopView } from './loop_view';
import { armReach, axisReach, Hand } from './operator/hand';
import { GamepadInput } from './operator/inputs';
import * as descriptions from './plots/descriptions';
import { Plot } from './plots/plot';
import { FoxgloveClient } from './protocol/foxglove';
import { onSchemeChange } from './scene/palette';
import { Sound } from './sound/sound';
import { closeUpTime_ms } from './state/contact';
import { choiceText } from './state/parameters';
import { Session, sides } from './state/session';

const session = new Session();
const hand = new Hand();
const client = new FoxgloveClient(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/`, session);

const command = (name: 'tap' | 'reset'): void => {
  hand.release();
  sendHand(performance.now() / 1000);
  client.publish('/operator/command', { command: name });
};
const tap = (): void => command('tap');

function sendHand(now_s: number): void {
  const message = hand.message(now_s);
  if (message) client.publish('/operator/hand', message);
}

const views = sides.map((side) => new LoopView(side, session.loops[side], hand, tap));
const [left, right] = views as [LoopView, LoopView];
element('loops').append(...views.map((view) => view.element));

const closeUp = new Plot(descriptions.closeUp);
const energy = new Plot(descriptions.energy);
const plots = [closeUp, energy, left.positions, right.positions, left.forces, right.forces];
element('plots').append(...plots.map((plot) => plot.element));

showConnection(session);
showNotices(session);
showIntroduction();
showSound(new Sound(session), session);
buildControls(
  session,
  {
    methods: { 'left.method': left.methodPlace, 'right.method': right.methodPlace },
    mode: element('mode'),
    panel: element('sliders'),
    locked: element('locked'),
  },
  (values) => client.setParameters(values),
);
restoreWith(element<HTMLButtonElement>('restore'), session, (values) => client.setParameters(values));
keepLink(session, (values) => client.setParameters(values));
session.on('server', () => client.watchParameters(session.described.map(({ name }) => name)));

const showMode = (): void => {
  const both = session.sideBySide;
  document.body.dataset.mode = both ? 'both' : 'one';
  right.show(both);
  views.forEach((view, index) => {
    const name = both ? (['Left', 'Right'][index] ?? '') : 'Your loop';
    view.rename(name);
    const method = session.values.get(`${sides[index]}.method`);
    for (const plot of [closeUp, energy]) {
      plot.nameLine(index, method === undefined ? name : `${name}: ${choiceText(String(method))}`, both || index === 0);
    }
  });
};
showMode();
session.on('parameters', showMode);

let drawn = '';
/** What draws arms is fetched where arms are served. */
async function drawArms(): Promise<void> {
  const { arms } = session;
  const told = JSON.stringify(arms ?? null);
  if (told === drawn) return;
  drawn = told;
  hand.release();
  hand.reach = arms ? armReach : axisReach;
  document.body.dataset.kind = arms ? 'arms' : 'axis';
  if (!arms) {
    for (const view of views) view.drawArms(undefined);
    return;
  }
  const { ArmScene } = await import('./scene/arm_scene');
  if (told !== drawn) return;
  for (const view of views) view.drawArms(new ArmScene(arms));
}
session.on('server', () => void drawArms());

let held = false;
const pause = element('pause');
pause.addEventListener('click', () => {
  held = !held;
  pause.setAttribute('aria-pressed', String(held));
});
element('tap').addEventListener('click', tap);
element('reset').addEventListener('click', () => command('reset'));
document.addEventListener('visibilitychange', () => {
  if (document.hidden) hand.release();
  sendHand(performance.now() / 1000);
});

const gamepad = new GamepadInput(hand, tap);
const health = new HealthLine(session, () => client.undecodable);
const nothing = new Float32Array(closeUpTime_ms.length).fill(NaN);

function drawShared(now_s: number): void {
  const { left: a, right: b } = session.loops;
  closeUp.update([closeUpTime_ms, a.contact.force_N, session.sideBySide ? b.contact.force_N : nothing], 0, now_s);
  const { latest } = session.energy;
  if (latest > -Infinity) energy.update(session.energy.views(), latest, now_s);
}

/** With reduced motion the plots move on in steps. */
const plotsEvery_s = matchMedia('(prefers-reduced-motion: reduce)').matches ? 0.5 : 0;
let plotsAt_s = -Infinity;
let hint = true;
function frame(now_ms: number): void {
  const now_s = now_ms / 1000;
  gamepad.poll();
  sendHand(now_s);
  hint &&= !hand.engaged;
  const plotsToo = !held && now_s - plotsAt_s >= plotsEvery_s;
  if (plotsToo) plotsAt_s = now_s;
  const connected = session.connection.state === 'open';
  for (const view of session.sideBySide ? views : [left]) view.draw(now_s, { plotsToo, hint, connected });
  if (plotsToo) drawShared(now_s);
  health.frame(now_s);
  requestAnimationFrame(frame);
}

onSchemeChange(() => {
  for (const plot of plots) plot.redraw();
});
client.start();
requestAnimationFrame(frame);
