// SPDX-License-Identifier: Apache-2.0
import type { ParameterValue } from '../protocol/foxglove';
import { linkOf, valuesOf } from '../state/link';
import type { Session } from '../state/session';

/**
 * Keeps the address of the page a link to what it shows, and asks the server for what the address says: when the page
 * begins, when the connection is back, and when the visitor opens another link.
 */
export function keepLink(session: Session, send: (values: ReadonlyMap<string, ParameterValue>) => void): void {
  const ask = (): void => {
    const tunable = session.described.filter((parameter) => parameter.tunable);
    const asked = valuesOf(location.hash, tunable);
    for (const { name, initial } of tunable) {
      // A link that says nothing of a parameter shows it as the server began with it.
      if (location.hash !== '' && initial !== undefined && !asked.has(name)) asked.set(name, initial);
    }
    if (asked.size > 0) send(asked);
  };
  session.on('server', ask);
  addEventListener('hashchange', ask);
  session.on('parameters', () => {
    const link = linkOf(session.described, session.values);
    // `replaceState` tells no listener, so the page does not answer itself.
    if (link !== location.hash) history.replaceState(null, '', link === '' ? location.pathname : link);
  });
}
