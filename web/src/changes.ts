/**
 * The timeline of a compass: changes, epochs and reports in one order, and what they
 * say. Pure functions.
 */

import type { Change, ChangeCause, DeviationRow, Epoch, LogbookEntry, Timeline } from './api/types';
import { degrees, eastWest, fixed, heading, signed, time } from './format';
import * as text from './text';
import { withoutItsDay, type At } from './whereabouts';

/** A line of the timeline. */
export type Line =
  | { kind: 'change'; at: string; change: Change; index: number; epoch: Epoch | null }
  | { kind: 'epoch'; at: string; epoch: Epoch }
  | { kind: 'entry'; at: string; entry: LogbookEntry };

/** What only disturbs the compass, or is no matter of the compass at all. */
const passing: readonly ChangeCause[] = [
  'compass_fault',
  'reference_fault',
  'local_anomaly',
  'magnetic_storm',
  'berth_steel',
  'gnss_interference',
];

/** Whether the ship's magnetism is another after it; what was withdrawn changed nothing. */
export const isTheShips = (change: Change): boolean =>
  !change.withdrawn && !passing.includes(change.cause);

/** Instants this far apart are of two changes, ms: an alert's beginning may have been refined. */
const sameChangeMs = 3 * 86_400_000;

/** The change nearest to an instant, the ship's own first; none where none is near. */
export function changeNear({ changes }: Timeline, instant: string | null): Change | undefined {
  if (instant === null) return undefined;
  const off = (change: Change) => Math.abs(Date.parse(change.from) - Date.parse(instant));
  return changes
    .filter((change) => off(change) <= sameChangeMs)
    .sort((a, b) => Number(isTheShips(b)) - Number(isTheShips(a)) || off(a) - off(b))[0];
}

/** The first sample. A report from before it leaves the epochs before it empty. */
export const sampledSince = ({ epochs }: Timeline): string | null =>
  epochs.find((epoch) => epoch.data_from !== null)?.data_from ?? null;

/**
 * Everything that happened, the latest first. An epoch that a change began, or that
 * began when one was over, stands with that change; a report that was withdrawn, and
 * one from before the first sample, are left to the logbook.
 */
export function lines(timeline: Timeline, entries: readonly LogbookEntry[]): Line[] {
  const { changes, epochs } = timeline;
  const told = new Set(changes.map((change) => change.epoch_after));
  const began = sampledSince(timeline);
  const all: Line[] = [
    ...changes.map((change, index) => ({
      kind: 'change' as const,
      at: change.from,
      change,
      index,
      epoch: change.epoch_after === null ? null : (epochs[change.epoch_after] ?? null),
    })),
    ...epochs.flatMap((epoch, index) => {
      const at = epoch.from ?? epoch.data_from;
      return at === null || told.has(index) ? [] : [{ kind: 'epoch' as const, at, epoch }];
    }),
    ...entries
      .filter(
        (entry) =>
          entry.withdrawn_at === null && began !== null && (entry.to ?? entry.from) >= began,
      )
      .map((entry) => ({ kind: 'entry' as const, at: entry.from, entry })),
  ];
  return all.sort((a, b) => Date.parse(b.at) - Date.parse(a.at));
}

/** `18 Nov 2026, 12:00 UTC`, with the time between which it must lie if that is wide. */
export function when(change: Change, at: At = time): string {
  const [earliest, latest] = [Date.parse(change.from_earliest), Date.parse(change.from_latest)];
  if (latest - earliest <= 2 * minuteMs) return at(change.from);
  const from = at(change.from_earliest);
  return text.changes.between(from, withoutItsDay(at(change.from_latest), from));
}

const minuteMs = 60_000;

/** How long after it happened the samples told: `2 h`, `40 min`, `3 days`. */
export function delay(change: Change): string | null {
  const minutes = Math.round((Date.parse(change.detected_at) - Date.parse(change.from)) / minuteMs);
  if (minutes < 1) return null;
  if (minutes < 90) return `${minutes} min`;
  const hours = Math.round(minutes / 60);
  return hours < 48 ? `${hours} h` : text.formats.days(Math.round(hours / 24));
}

/** A component of a step with its standard error: `+1.9 ± 0.1 µT`. */
export const component = (nt: number, seNt: number): string =>
  `${signed(nt / 1000, 1)} ± ${fixed(Math.abs(seNt) / 1000, 1)}\u00a0µT`;

/** A figure of a change, and what it is a figure of. */
export interface Size {
  what: string;
  size: string;
}

/** How large a change of the ship's magnetism is, each figure by its name. */
export function sizes(timeline: Timeline, change: Change): Size[] {
  if (!isTheShips(change)) return [];
  const t = text.changes.sizes;
  const { deviation_change_deg: then, step } = change;
  const last = mostParted(pairs(timeline, change));
  const all: Size[] = [];
  const add = (what: string, size: string) => all.push({ what, size: t.by(size) });
  if (then !== null) add(t.then, degrees(Math.abs(then)));
  if (last) add(t.last(heading(last.pair.compass_deg)), eastWest(last.degrees));
  if (step) {
    add(t.foreAft, component(step.bx_nt, step.bx_se_nt));
    add(t.athwart, component(step.by_nt, step.by_se_nt));
  }
  return all;
}

/** How sure a probability is, in a word. */
export function sureness(probability: number): string {
  const { words } = text.changes;
  if (probability >= 0.95) return words.certain;
  if (probability >= 0.5) return words.likely;
  return probability >= 0.1 ? words.possible : words.unlikely;
}

/** A heading's deviation before and after. */
export interface Pair {
  compass_deg: number;
  before: DeviationRow | null;
  after: DeviationRow | null;
}

/** The curves of the epochs that a change parts, heading by heading. */
export function pairs(timeline: Timeline, change: Change): Pair[] {
  const curve = (place: number | null): DeviationRow[] =>
    (place === null ? null : timeline.epochs[place]?.curve) ?? [];
  const [before, after] = [curve(change.epoch_before), curve(change.epoch_after)];
  const longer = before.length >= after.length ? before : after;
  const at = (rows: DeviationRow[], compass_deg: number) =>
    rows.find((row) => row.compass_deg === compass_deg) ?? null;
  return longer.map(({ compass_deg }) => ({
    compass_deg,
    before: at(before, compass_deg),
    after: at(after, compass_deg),
  }));
}

/** The pair whose curves part most; none without both. */
export function mostParted(all: readonly Pair[]): { pair: Pair; degrees: number } | null {
  let most: { pair: Pair; degrees: number } | null = null;
  for (const pair of all) {
    if (!pair.before || !pair.after) continue;
    const degrees = pair.after.deviation_deg - pair.before.deviation_deg;
    if (!most || Math.abs(degrees) > Math.abs(most.degrees)) most = { pair, degrees };
  }
  return most;
}
