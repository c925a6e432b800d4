/**
 * What a vessel needs done, the most pressing first: an alert, an order that waits for an
 * answer, an adjustment that is due and not in hand, a deviation that is large where the vessel
 * is or goes next. Pure functions.
 */

import type {
  AdjustmentNeed,
  AlertCause,
  FleetVessel,
  SchedulePlan,
  Severity,
  Urgency,
  WorkOrderState,
  Worst,
} from './api/types';
import { waitsForOperator, type OperatorState } from './orders/order';
import { grade } from './science/curve';

/** When a vessel's compass is to be adjusted next, the first of hers. */
export interface Due {
  compass: string;
  on: string;
  urgency: Urgency;
  reason: string;
}

/** A vessel with when she is due; nothing where that is not known yet, or she is not. */
export type FleetLine = FleetVessel & {
  due?: Due | undefined;
  /** The first that presses and that no firm was asked for; planned for a day, or for none. */
  unoffered?: (Due & { day: string | null }) | undefined;
  /** An order that waits for the operator. */
  waiting?: (OpenOrder & { state: OperatorState; urgency: Urgency }) | undefined;
  /** An adjustment that is with a firm, being done, or waiting for headings at sea. */
  inHand?: (OpenOrder & { compass: string }) | undefined;
};

/** How far the order of a compass has come. */
export interface OpenOrder {
  order: string;
  state: WorkOrderState;
  from: string;
}

/** States in which the work is done, and what comes due afterwards is another need. */
const workIsDone: readonly WorkOrderState[] = ['adjusted', 'verified'];

/** The vessels with the needs of each, and how far the plan has come with them. */
export function withDues(
  vessels: readonly FleetVessel[],
  needs: readonly AdjustmentNeed[],
  plan: SchedulePlan | null,
): FleetLine[] {
  const jobs = new Map(
    (plan?.jobs ?? []).flatMap((job) =>
      job.compasses.map(({ compass_id }): [string, string] => [compass_id, job.day]),
    ),
  );
  const known = new Map<string, Pick<FleetLine, 'due' | 'unoffered' | 'waiting' | 'inHand'>>();
  for (const { vessel_id, compass_id, due_on: on, urgency, reason, order } of needs) {
    const due = { compass: compass_id, on, urgency, reason };
    const open = order && { order: order.id, state: order.state, from: order.from };
    const hers = known.get(vessel_id) ?? {};
    known.set(vessel_id, hers);
    if (!hers.due || on < hers.due.on) hers.due = due;
    if (open && waitsForOperator(open.state)) {
      hers.waiting ??= { ...open, state: open.state, urgency };
      continue;
    }
    if (open && (!hers.inHand || open.from < hers.inHand.from)) {
      hers.inHand = { ...open, compass: compass_id };
    }
    if (open && !workIsDone.includes(open.state)) continue;
    if (urgency !== 'routine' && (!hers.unoffered || on < hers.unoffered.on)) {
      hers.unoffered = { ...due, day: jobs.get(compass_id) ?? null };
    }
  }
  return vessels.map((vessel) => ({ ...vessel, ...known.get(vessel.id) }));
}

/** The largest deviation that she is to meet, and the port if it is not where she was last. */
export function worstAhead({
  worst,
  next_call: call,
}: FleetVessel): { worst: Worst; port: string | null } | null {
  const there = call?.worst ?? null;
  const here = worst === null ? -1 : Math.abs(worst.deviation_deg);
  if (call && there && Math.abs(there.deviation_deg) > here) {
    return { worst: there, port: call.port_name || call.port };
  }
  return worst && { worst, port: null };
}

export type Reason =
  | {
      kind: 'alert';
      id: string;
      severity: Severity;
      cause: AlertCause;
      why: string;
      known: boolean;
      more: number;
    }
  | { kind: 'due'; compass: string; urgency: Urgency; on: string; day: string | null; why: string }
  | ({ kind: 'order' } & NonNullable<FleetLine['waiting']>)
  | { kind: 'deviation'; port: string | null };

/** The state of the order that meets what is due first; none where that is not in hand. */
export function settledBy({ due, inHand }: FleetLine): WorkOrderState | undefined {
  if (!inHand || inHand.compass !== due?.compass || workIsDone.includes(inHand.state)) {
    return undefined;
  }
  return inHand.state;
}

/** Why she needs someone, the most pressing first; nothing where she does not. */
export function reasonsOf(vessel: FleetLine): Reason[] {
  const { alert, open_alerts, unoffered, waiting } = vessel;
  const reasons: Reason[] = [];
  if (alert) {
    const { id, severity, cause, summary: why } = alert;
    const known = alert.state !== 'raised';
    reasons.push({
      kind: 'alert',
      id,
      severity,
      cause,
      why,
      known,
      more: open_alerts - (known ? 0 : 1),
    });
  }
  if (waiting) reasons.push({ kind: 'order', ...waiting });
  if (unoffered) reasons.push({ kind: 'due', why: unoffered.reason, ...unoffered });
  const ahead = worstAhead(vessel);
  // The alert says it already.
  const said = alert?.cause === 'deviation_over_limit';
  if (ahead && !said && grade(ahead.worst.deviation_deg) === 'large') {
    reasons.push({ kind: 'deviation', port: ahead.port });
  }
  return reasons.sort((a, b) => rank(b) - rank(a));
}

const severityRank: Record<Severity, number> = { notice: 1, warning: 2, critical: 3 };
/** An overdue compass presses as a warning that somebody knows of; beyond 5° little less. */
const urgencyRank: Record<Urgency, number> = {
  overdue: 2.2,
  urgent: 1.2,
  soon: 0.8,
  unknown: 0.5,
  routine: 0,
};
const largeRank = 2.1;
/** A firm that waits for an answer lets its offer lapse: today's work, whenever it is due. */
const answerRank = 1.6;

function rank(reason: Reason): number {
  switch (reason.kind) {
    case 'alert':
      return severityRank[reason.severity] + (reason.known ? 0 : 0.5);
    case 'due':
      return urgencyRank[reason.urgency];
    case 'order':
      return reason.state === 'planned'
        ? urgencyRank[reason.urgency]
        : Math.max(answerRank, urgencyRank[reason.urgency]);
    case 'deviation':
      return largeRank;
  }
}

/** How much that presses: the worst reason counts most, then how many there are. */
export function pressing(vessel: FleetLine): number {
  const reasons = reasonsOf(vessel);
  const first = reasons[0];
  return first ? rank(first) * 1_000 + Math.min(reasons.length + vessel.open_alerts, 99) : 0;
}
