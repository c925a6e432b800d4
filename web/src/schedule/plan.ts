/** A plan as people look at it: a row for each vessel, what changed, what it costs. */

import type {
  AdjustmentNeed,
  PlanChange,
  PlannedJob,
  PortCall,
  SchedulePlan,
  UnscheduledNeed,
} from '../api/types';
import * as text from '../text';
import { dayAt, type Zone } from '../zone';
import { dayAfter } from './month';

/** A vessel of the schedule: when she is in port, what is planned and what is due. */
export interface Row {
  vesselId: string;
  vesselName: string;
  calls: PortCall[];
  jobs: PlannedJob[];
  needs: AdjustmentNeed[];
  /** Compasses whose order the plan no longer holds: it is being done, or waits. */
  work: Work[];
  /** Whether the plan meets her needs: one of them not at all, one only late, or all in time. */
  met: 'not' | 'late' | 'in time';
}

/** A compass with its open order. */
export type Work = AdjustmentNeed & { order: NonNullable<AdjustmentNeed['order']> };

const urgencies = ['overdue', 'urgent', 'soon', 'unknown', 'routine'] as const;

/** The open orders that no job of the plan stands for, the first to be done first. */
export function workBeside(plan: SchedulePlan | null, needs: readonly AdjustmentNeed[]): Work[] {
  const planned = new Set(
    (plan?.jobs ?? [])
      .filter((job) => job.state !== 'proposed')
      .flatMap((job) => job.compasses.map(({ compass_id }) => compass_id)),
  );
  return needs
    .filter((need): need is Work => need.order !== null && !planned.has(need.compass_id))
    .sort((a, b) => a.order.from.localeCompare(b.order.from));
}

/** The vessels that have something to show: what is not met first, then by the next job. */
export function rowsOf(
  plan: SchedulePlan | null,
  needs: readonly AdjustmentNeed[],
  calls: readonly PortCall[],
): Row[] {
  const rows = new Map<string, Row>();
  const of = (item: { vessel_id: string; vessel_name: string }): Row => {
    const known = rows.get(item.vessel_id);
    if (known) return known;
    const { vessel_id: vesselId, vessel_name: vesselName } = item;
    const row: Row = {
      vesselId,
      vesselName,
      calls: [],
      jobs: [],
      needs: [],
      work: [],
      met: 'in time',
    };
    rows.set(vesselId, row);
    return row;
  };
  for (const call of calls) of(call).calls.push(call);
  for (const need of needs) of(need).needs.push(need);
  for (const work of workBeside(plan, needs)) of(work).work.push(work);
  for (const job of plan?.jobs ?? []) {
    const row = of(job);
    row.jobs.push(job);
    if (job.late_days > 0) row.met = 'late';
  }
  for (const need of plan?.unscheduled ?? []) if (!need.planned_late) of(need).met = 'not';
  const order = ['not', 'late', 'in time'];
  return [...rows.values()].sort(
    (a, b) =>
      order.indexOf(a.met) - order.indexOf(b.met) ||
      first(a) - first(b) ||
      a.vesselName.localeCompare(b.vesselName, 'en'),
  );
}

/** When a vessel is to be thought of: her first job, else her first due date. */
function first({ jobs, needs }: Row): number {
  const days = jobs.length > 0 ? jobs.map((job) => job.day) : needs.map((need) => need.due_on);
  return Math.min(Number.MAX_SAFE_INTEGER, ...days.map((day) => Date.parse(day)));
}

/** What the plan leaves to be done late or not at all, in vessels' jobs. */
export function unmetBy(plan: SchedulePlan): { unscheduled: number; late: number } {
  // A job that is late may stand among the unscheduled too, with why.
  return {
    unscheduled: plan.unscheduled.filter((need) => !need.planned_late).length,
    late: plan.jobs.filter((job) => job.late_days > 0).length,
  };
}

/** Where the plan has put a compass: in a job, or nowhere with the reasons. */
export interface Planned {
  job?: PlannedJob | undefined;
  unmet?: UnscheduledNeed | undefined;
}

/** What the plan says of a compass; nothing where it has no need of it. */
export function plannedFor(plan: SchedulePlan | null | undefined, compass: string): Planned {
  const hers = ({ compasses }: PlannedJob | UnscheduledNeed) =>
    compasses.some(({ compass_id }) => compass_id === compass);
  const job = plan?.jobs.find(hers);
  return { job, unmet: job ? undefined : plan?.unscheduled.find(hers) };
}

/** How much the most pressing of some needs presses. */
export const mostUrgent = (needs: readonly { urgency: (typeof urgencies)[number] }[]) =>
  urgencies.find((urgency) => needs.some((need) => need.urgency === urgency)) ?? 'routine';

/** What a job is known by from plan to plan. */
export const jobKey = (job: { compasses: readonly { compass_id: string }[] }): string =>
  job.compasses.map((compass) => compass.compass_id).join('+');

export const paid = (job: PlannedJob): number => job.fee_eur + job.travel_eur;

/**
 * What changed against the plan that was looked at, the moved and dropped first. A job that
 * a person pinned elsewhere is kept for the server, which plans around it; for who looked at
 * the plan before it has moved.
 */
export function realChanges(before: SchedulePlan | null, plan: SchedulePlan): PlanChange[] {
  const order = ['dropped', 'moved', 'new'];
  const told = plan.changes.filter((change) => change.what !== 'kept');
  const known = new Set(told.map(jobKey));
  const were = new Map(before?.jobs.map((job) => [jobKey(job), job]));
  const pinned = plan.jobs.flatMap((job) => {
    const was = were.get(jobKey(job));
    return was && !known.has(jobKey(job)) && !samePlace(was, job) ? [movedBy(was, job)] : [];
  });
  return [...told, ...pinned].sort((a, b) => order.indexOf(a.what) - order.indexOf(b.what));
}

const samePlace = (a: PlannedJob, b: PlannedJob): boolean =>
  a.call_id === b.call_id && a.from === b.from && a.firm_id === b.firm_id;

function movedBy(was: PlannedJob, job: PlannedJob): PlanChange {
  const place = (at: PlannedJob) => ({
    call_id: at.call_id,
    day: at.day,
    from: at.from,
    firm_id: at.firm_id,
    firm_name: at.firm_name,
    port_name: at.port_name,
    paid_eur: paid(at),
  });
  const { compasses, vessel_id, vessel_name } = job;
  const why = job.pinned ? text.schedule.changes.pinned : '';
  const places = { from: place(was), to: place(job) };
  return { compasses, vessel_id, vessel_name, what: 'moved', why, ...places };
}

const hourMs = 3_600_000;

/** The days of a call in its port's time, as `YYYY-MM-DD`. */
export function daysOf(call: { eta: string; etd: string }, zone: Zone): string[] {
  const days: string[] = [];
  const last = dayAt(Date.parse(call.etd), zone);
  for (let day = dayAt(Date.parse(call.eta), zone); day <= last; day = dayAfter(day, 1)) {
    days.push(day);
  }
  return days;
}

/** The call in which an instant lies; with `slackH` it may lie so far beside one. */
export function callAt<C extends { eta: string; etd: string }>(
  calls: readonly C[],
  atMs: number,
  slackH = 0,
): C | undefined {
  const off = (call: C) => Math.max(Date.parse(call.eta) - atMs, atMs - Date.parse(call.etd), 0);
  const near = calls.filter((call) => off(call) <= slackH * hourMs);
  return near.sort((a, b) => off(a) - off(b))[0];
}
