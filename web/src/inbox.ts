/**
 * How the alerts' inbox is filtered. Pure functions: the page holds the query, the address
 * bar repeats it.
 */

import type { Alert, AlertCause, Severity } from './api/types';
import { isSnoozed, severities } from './alerts';
import { plainly } from './plainly';
import * as text from './text';

const states = ['raised', 'acknowledged', 'mine', 'snoozed'] as const;
type OpenState = (typeof states)[number];

export interface InboxQuery {
  /** Words of the vessel's and the compass's names. */
  search: string;
  /** No one in particular where it is empty; so are the others. */
  state: OpenState | '';
  severity: Severity | '';
  cause: AlertCause | '';
}

export const everyAlert: InboxQuery = { search: '', state: '', severity: '', cause: '' };

export const openStates: readonly OpenState[] = states;

/** The alerts that a query asks for, as they stood. What is over is in no state to be asked for. */
export function matching(
  alerts: readonly Alert[],
  query: InboxQuery,
  reader: { me: string; now: Date },
): Alert[] {
  const words = plainly(query.search).split(/\s+/).filter(Boolean);
  const says = (alert: Alert) => {
    const hay = plainly(`${alert.vessel_name} ${alert.compass_name}`);
    return words.every((word) => hay.includes(word));
  };
  return alerts.filter(
    (alert) =>
      isIn(query.state, alert, reader) &&
      (query.severity === '' || alert.severity === query.severity) &&
      (query.cause === '' || alert.cause === query.cause) &&
      says(alert),
  );
}

/** What is snoozed is not asked for, but where it is asked for. */
function isIn(
  state: OpenState | '',
  alert: Alert,
  { me, now }: { me: string; now: Date },
): boolean {
  if (alert.state === 'cleared') return true;
  if (state === 'snoozed') return isSnoozed(alert, now);
  if (isSnoozed(alert, now)) return false;
  if (state === 'mine') return alert.assigned_to === me;
  return state === '' || alert.state === state;
}

/** In the order in which they stood; each that is new after the one that it follows. */
export function asTheyStood(alerts: readonly Alert[], stood: readonly string[]): Alert[] {
  const places = new Map(stood.map((id, place) => [id, place]));
  const place = ({ id }: Alert) => places.get(id) ?? -1;
  const known = alerts.filter(({ id }) => places.has(id)).sort((a, b) => place(a) - place(b));
  alerts.forEach((alert, index) => {
    if (places.has(alert.id)) return;
    const before = alerts[index - 1];
    known.splice(before ? known.indexOf(before) + 1 : 0, 0, alert);
  });
  return known;
}

/** The causes among alerts, and one that is asked for in any case, by their words. */
export function causesOf(alerts: readonly Alert[], asked: AlertCause | ''): AlertCause[] {
  const found = new Set(alerts.map(({ cause }) => cause));
  if (asked !== '') found.add(asked);
  const words = (cause: AlertCause) => text.alertCause[cause];
  return [...found].sort((a, b) => words(a).localeCompare(words(b), 'en'));
}

/** A query as it stands in the address bar; the whole inbox is nothing. */
export function toInboxSearch({ search, state, severity, cause }: InboxQuery): string {
  const params = new URLSearchParams();
  if (search.trim() !== '') params.set('q', search.trim());
  if (state !== '') params.set('state', state);
  if (severity !== '') params.set('severity', severity);
  if (cause !== '') params.set('cause', cause);
  const written = params.toString();
  return written === '' ? '' : `?${written}`;
}

const isCause = (word: string | null): word is AlertCause =>
  word !== null && Object.hasOwn(text.alertCause, word);

/** The query in an address; what is not understood asks for nothing in particular. */
export function fromInboxSearch(written: string): InboxQuery {
  const params = new URLSearchParams(written);
  const cause = params.get('cause');
  return {
    search: params.get('q') ?? '',
    state: states.find((known) => known === params.get('state')) ?? '',
    severity: severities.find((known) => known === params.get('severity')) ?? '',
    cause: isCause(cause) ? cause : '',
  };
}
