/**
 * A month as a calendar: its weeks from Monday on, and what falls on each day. Days are
 * `YYYY-MM-DD`; a call's are those of UTC, a job's and a due date's are as they were given.
 * Pure functions.
 */

import type { AdjustmentNeed, PlannedJob, PortCall } from '../api/types';
import { dayAt } from '../zone';
import type { Row, Work } from './plan';

const dayMs = 86_400_000;

/** The month of a day, as `YYYY-MM`. */
export const monthOf = (day: string): string => day.slice(0, 7);

/** The day so many days later. */
export const dayAfter = (day: string, days: number): string =>
  new Date(Date.parse(`${day}T00:00:00Z`) + days * dayMs).toISOString().slice(0, 10);

/** The same day of another month, or its last one where it has no such day. */
export function inMonth(day: string, months: number): string {
  const [year = 0, month = 1, date = 1] = day.split('-').map(Number);
  const last = new Date(Date.UTC(year, month + months, 0)).getUTCDate();
  return new Date(Date.UTC(year, month - 1 + months, Math.min(date, last)))
    .toISOString()
    .slice(0, 10);
}

/** Whole weeks, so that the first and the last may have days of other months. */
export function weeksOf(month: string): string[][] {
  const first = new Date(`${month}-01T00:00:00Z`);
  let day = dayAfter(`${month}-01`, -((first.getUTCDay() + 6) % 7));
  const weeks: string[][] = [];
  do {
    weeks.push([0, 1, 2, 3, 4, 5, 6].map((n) => dayAfter(day, n)));
    day = dayAfter(day, 7);
  } while (monthOf(day) === month);
  return weeks;
}

export interface Day {
  dues: AdjustmentNeed[];
  jobs: PlannedJob[];
  /** Orders beside the plan, on the day on which their work begins. */
  work: Work[];
  arriving: PortCall[];
  /** In port since an earlier day. */
  inPort: PortCall[];
}

export const nothing: Day = { dues: [], jobs: [], work: [], arriving: [], inPort: [] };

/** What falls on the days from `from` to `to`; a day without anything is not in it. */
export function daysWith(rows: readonly Row[], from: string, to: string): Map<string, Day> {
  const days = new Map<string, Day>();
  const on = (day: string): Day | undefined => {
    if (day < from || day > to) return undefined;
    const known = days.get(day) ?? { dues: [], jobs: [], work: [], arriving: [], inPort: [] };
    days.set(day, known);
    return known;
  };
  for (const { needs, jobs, work, calls } of rows) {
    for (const need of needs) if (need.urgency !== 'unknown') on(need.due_on)?.dues.push(need);
    for (const job of jobs) on(job.day)?.jobs.push(job);
    for (const of of work) on(dayAt(Date.parse(of.order.from), 0))?.work.push(of);
    for (const call of calls) {
      const [arrives, leaves] = [dayAt(Date.parse(call.eta), 0), dayAt(Date.parse(call.etd), 0)];
      on(arrives)?.arriving.push(call);
      const first = arrives < from ? from : dayAfter(arrives, 1);
      for (let day = first; day <= leaves && day <= to; day = dayAfter(day, 1)) {
        on(day)?.inPort.push(call);
      }
    }
  }
  return days;
}

const ways: Record<string, number> = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -7, ArrowDown: 7 };

/** The day that a key leads to; nothing for a key that leads nowhere. */
export function keyedDay(day: string, key: string): string | null {
  const weekday = (new Date(`${day}T00:00:00Z`).getUTCDay() + 6) % 7;
  if (key === 'Home') return dayAfter(day, -weekday);
  if (key === 'End') return dayAfter(day, 6 - weekday);
  if (key === 'PageUp') return inMonth(day, -1);
  if (key === 'PageDown') return inMonth(day, 1);
  const way = ways[key];
  return way === undefined ? null : dayAfter(day, way);
}
