/**
 * What to do about a vessel now: one thing, with the way to do it. Pure.
 *
 * An order that is open comes before the alerts that an adjustment cures; a critical alert
 * of another kind before it. Nothing to do is an answer too.
 */

import { callsForAdjustment, isSnoozed } from './alerts';
import type { AdjustmentNeed, Alert, Vessel, WorkOrderSummary } from './api/types';
import { day, sentence } from './format';
import { isOpen, stateName, waitsForOperator, whatNext } from './orders/order';
import {
  alertPath,
  changePath,
  newWorkOrderPath,
  plannedPath,
  startPath,
  vesselTabPath,
  workOrderPath,
} from './state/route.svelte';
import * as text from './text';

export interface Way {
  label: string;
  path: string;
}

export interface Now {
  tone: 'good' | 'plain' | 'notable' | 'bad';
  title: string;
  why: string;
  /** The first is the one to press. */
  ways: Way[];
}

export interface Known {
  vessel: Vessel;
  /** The vessel's open alerts, the worst first; snoozed ones are left out. */
  alerts: readonly Alert[];
  needs: readonly AdjustmentNeed[];
  /** The next one first. */
  orders: readonly WorkOrderSummary[];
  now: Date;
  /** Whether the reader may order and enrol. */
  writes: boolean;
  /** How instants in the server's sentences are written. */
  at: (instant: string) => string;
}

/** What is asked for; a part that has not come yet is not known. */
export type Asked = Omit<Known, 'alerts' | 'needs' | 'orders'> & {
  [part in 'alerts' | 'needs' | 'orders']: Known[part] | undefined;
};

const t = () => text.now;

/** Alerts whose curves before and after show what happened. */
const changed: Alert['cause'][] = [
  'lightning_or_shock',
  'magnetic_cargo',
  'drift',
  'alignment',
  'unknown_change',
];

export const isChange = (alert: Alert): boolean => changed.includes(alert.cause);

/** The way to the curves before and after what an alert is about. */
export const toChange = (alert: Alert): Way => ({
  label: t().seeChange,
  path: changePath(alert.vessel_id, alert.compass_id, alert.since),
});

/** Says that nothing is known rather than that all is well while a part is missing. */
export function nowFor({ alerts, needs, orders, ...rest }: Asked): Now {
  if (!alerts || !needs || !orders) return way('plain', t().unknown, t().unknownWhy);
  return ofKnown({ ...rest, alerts, needs, orders });
}

function ofKnown(known: Known): Now {
  const { vessel, needs, orders, now } = known;
  const alerts = known.alerts.filter((alert) => !isSnoozed(alert, now));
  const order = orders.find(({ state }) => isOpen(state));
  const pressing = alerts.find(({ severity }) => severity !== 'notice');
  if (pressing?.severity === 'critical' && !callsForAdjustment(pressing)) {
    return ofAlert(pressing, known);
  }
  if (order) return ofOrder(order);
  if (pressing) return ofAlert(pressing, known);
  // Without an adjustment on record the day on which one is due moves with the calendar.
  const due = needs
    .filter(({ urgency }) => urgency !== 'unknown')
    .sort((a, b) => a.due_on.localeCompare(b.due_on))[0];
  if (due && (due.urgency === 'overdue' || due.urgency === 'urgent')) return ofDue(due, known);
  if (vessel.compasses.length > 0 && !vessel.last_upload_at) return noData(known);
  if (!vessel.model) {
    const path = vesselTabPath(vessel.id, 'agent');
    return way('plain', t().noModel, t().noModelWhy, { label: t().toAgent, path });
  }
  const notice = alerts[0];
  if (notice) return ofAlert(notice, known);
  const unrecorded = needs.find(({ urgency }) => urgency === 'unknown');
  if (unrecorded) return notRecorded(unrecorded);
  const snoozed = known.alerts.length;
  const why = [
    ...(snoozed > 0 ? [t().snoozed(snoozed)] : []),
    due ? t().dueLater(day(due.due_on)) : t().nothingDue,
  ];
  return way('good', t().nothing, why.join(' '));
}

const way = (tone: Now['tone'], title: string, why: string, ...ways: Way[]): Now => ({
  tone,
  title,
  why,
  ways,
});

function ofAlert(alert: Alert, { orders, writes, at }: Known): Now {
  const orderable = writes && callsForAdjustment(alert) && !orders.some((o) => isOpen(o.state));
  const order = {
    label: text.orderPanel.order,
    path: newWorkOrderPath(alert.vessel_id, alert.compass_id),
  };
  const open = { label: t().openAlert, path: alertPath(alert.id) };
  const tone = { critical: 'bad', warning: 'notable', notice: 'plain' } as const;
  return way(
    tone[alert.severity],
    text.alertCause[alert.cause],
    sentence(alert.advice, at),
    ...(orderable ? [order] : []),
    ...(isChange(alert) ? [toChange(alert)] : []),
    open,
  );
}

function ofOrder({ id, state, port, planned_at: at }: WorkOrderSummary): Now {
  const tone = state === 'failed' ? 'bad' : waitsForOperator(state) ? 'notable' : 'plain';
  const title = t().order(stateName(state), port, day(at));
  return way(tone, title, whatNext(state), { label: t().openOrder, path: workOrderPath(id) });
}

function ofDue(due: AdjustmentNeed, { writes }: Known): Now {
  const overdue = due.urgency === 'overdue';
  const title = (overdue ? t().overdue : t().dueBy)(day(due.due_on));
  const order = {
    label: text.orderPanel.order,
    path: newWorkOrderPath(due.vessel_id, due.compass_id),
  };
  const plan = { label: t().toSchedule, path: plannedPath(due.compass_id) };
  const ways = writes ? [order, plan] : [plan];
  return way(overdue ? 'bad' : 'notable', title, sentence(due.reason), ...ways);
}

/** An agent that was enrolled and has sent nothing yet is known from none by its own page alone. */
const noData = ({ vessel }: Known): Now =>
  way('notable', t().noAgent, t().noAgentWhy, {
    label: t().toAgent,
    path: vesselTabPath(vessel.id, 'agent'),
  });

const notRecorded = ({ reason }: AdjustmentNeed): Now =>
  way('plain', t().notRecorded, sentence(reason), { label: t().toStart, path: startPath });
