/** How alerts are put in order: the worst first, those that nobody knows of before. */

import type { Alert, AlertCause, Severity } from './api/types';

/** From the mildest to the worst. */
export const severities: readonly Severity[] = ['notice', 'warning', 'critical'];

/** Whether an alert is snoozed at a time. */
export const isSnoozed = ({ snoozed_until: until }: Alert, now: Date): boolean =>
  until !== null && Date.parse(until) > now.getTime();

const rank: Record<Severity, number> = { critical: 0, warning: 1, notice: 2 };

/** The order in which someone should see to them. */
export function inOrder(alerts: readonly Alert[]): Alert[] {
  const known = (alert: Alert) => (alert.state === 'raised' ? 0 : 1);
  return [...alerts].sort(
    (a, b) =>
      known(a) - known(b) ||
      rank[a.severity] - rank[b.severity] ||
      b.raised_at.localeCompare(a.raised_at),
  );
}

/** One vessel's, the worst first whether anybody knows of them or not. */
export const ofVessel = (alerts: readonly Alert[], vessel: string): Alert[] =>
  inOrder(alerts)
    .filter((alert) => alert.vessel_id === vessel)
    .sort((a, b) => rank[a.severity] - rank[b.severity]);

/** What keeps a card from being made: with these open, no model tells what the compass shows. */
export const againstCard = (alerts: readonly Alert[], compass: string): Alert | undefined =>
  inOrder(alerts).find(
    ({ compass_id, cause }) =>
      compass_id === compass && (cause === 'compass_fault' || cause === 'reported_aboard'),
  );

/** Those that nobody has acknowledged or snoozed, the worst first. */
export const raisedOf = (alerts: readonly Alert[], now: Date): Alert[] =>
  inOrder(alerts).filter((alert) => alert.state === 'raised' && !isSnoozed(alert, now));

/** Causes that an adjustment cures, or may. */
const adjusted: AlertCause[] = [
  'deviation_over_limit',
  'lightning_or_shock',
  'drift',
  'adjustment_not_confirmed',
  'agreed_job_at_risk',
];

/** Whether what to do about an open alert may be an adjustment. */
export const callsForAdjustment = (alert: Alert): boolean =>
  alert.state !== 'cleared' && adjusted.includes(alert.cause);
