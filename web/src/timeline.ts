/**
 * One time axis under the residuals: epochs, changes, what was reported and port calls.
 * Pure functions; instants are milliseconds.
 */

import type { LogbookEntry, PortCall, Timeline } from './api/types';
import { isTheShips, when } from './changes';
import { count, day, degrees, time } from './format';
import { details, isOpen, period } from './logbook';
import * as text from './text';
import type { At } from './whereabouts';

export interface Range {
  fromMs: number;
  toMs: number;
}

export const lanes = ['epochs', 'changes', 'reports', 'calls'] as const;
export type Lane = (typeof lanes)[number];

/** Something on the axis. */
export interface Mark {
  key: string;
  lane: Lane;
  fromMs: number;
  toMs: number;
  /** What it is, in a word or two. */
  title: string;
  /** When, as people read it. */
  when: string;
  /** What else there is to say; may be empty. */
  more: string;
  /** Where on the page more of it stands. */
  at: string;
  /** Whether the ship's own magnetism is not what it was. */
  grave: boolean;
}

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.timeAxis;

/** Everything that falls into the range, lane by lane and each in order of time. */
export function marksIn(
  range: Range,
  timeline: Timeline | undefined,
  entries: readonly LogbookEntry[],
  calls: readonly PortCall[],
  at: At = time,
): Mark[] {
  const found = [
    ...(timeline ? [...epochMarks(timeline, range), ...changeMarks(timeline, at)] : []),
    ...entries
      .filter((entry) => entry.withdrawn_at === null)
      .map((entry) => reportMark(entry, range, at)),
    ...calls.filter((call) => call.withdrawn_at === null).map((call) => callMark(call, at)),
  ];
  return found
    .filter((mark) => mark.toMs >= range.fromMs && mark.fromMs <= range.toMs)
    .map((mark) => ({
      ...mark,
      fromMs: Math.max(mark.fromMs, range.fromMs),
      toMs: Math.min(mark.toMs, range.toMs),
    }))
    .sort((a, b) => lanes.indexOf(a.lane) - lanes.indexOf(b.lane) || a.fromMs - b.fromMs);
}

function epochMarks({ epochs }: Timeline, range: Range): Mark[] {
  return epochs.map((epoch, index) => ({
    key: `epoch ${index}`,
    lane: 'epochs' as const,
    fromMs: epoch.from === null ? range.fromMs : Date.parse(epoch.from),
    toMs: epoch.to === null ? range.toMs : Date.parse(epoch.to),
    title: t().epoch(index + 1),
    when: epoch.from === null ? t().fromTheStart : t().since(day(epoch.from)),
    more:
      epoch.curve === null
        ? text.changes.epochNoModel
        : text.changes.epochModel(count(epoch.samples_used), degrees(epoch.rms_deg)),
    at: '#changes',
    grave: false,
  }));
}

function changeMarks({ changes }: Timeline, at: At): Mark[] {
  return changes.map((change) => ({
    key: `change ${change.from}`,
    lane: 'changes' as const,
    fromMs: Date.parse(change.from),
    // A disturbance lasts; a step is there at once.
    toMs: Date.parse(change.ended ?? change.from),
    title: text.changes.cause[change.cause],
    when: when(change, at),
    more:
      isTheShips(change) && change.deviation_change_deg !== null
        ? text.changes.deviation(degrees(Math.abs(change.deviation_change_deg)))
        : isTheShips(change)
          ? ''
          : change.confirmed || change.withdrawn
            ? text.changes.notHers
            : text.changes.perhapsNotHers,
    at: '#changes',
    grave: isTheShips(change),
  }));
}

function reportMark(entry: LogbookEntry, range: Range, at: At): Mark {
  return {
    key: `entry ${entry.id}`,
    lane: 'reports',
    fromMs: Date.parse(entry.from),
    toMs: isOpen(entry) ? range.toMs : Date.parse(entry.to ?? entry.from),
    title: text.logbook.kinds[entry.kind],
    when: period(entry, at),
    more: [details(entry, () => ''), entry.note].filter((part) => part !== '').join('. '),
    at: '#logbook',
    grave: false,
  };
}

function callMark(call: PortCall, at: At): Mark {
  return {
    key: `call ${call.id}`,
    lane: 'calls',
    fromMs: Date.parse(call.eta),
    toMs: Date.parse(call.etd),
    title: call.port_name || call.port,
    when: t().fromTo(at(call.eta, call.port), at(call.etd, call.port)),
    more: '',
    at: '/schedule',
    grave: false,
  };
}

/**
 * The axis: the samples' time, and a little further where something is there: recorded data
 * may be of years ago, and then now is no part of the picture.
 */
export function rangeOf(sampleTimes: readonly Date[], marks: readonly Range[]): Range | null {
  const [first, last] = [sampleTimes[0], sampleTimes.at(-1)];
  if (!first || !last) return null;
  const fromMs = first.getTime();
  const most = last.getTime() + Math.max(last.getTime() - fromMs, dayMs) / 10;
  const near = marks.filter((mark) => mark.fromMs <= most);
  const toMs = Math.max(last.getTime(), ...near.map((mark) => Math.min(mark.toMs, most)));
  return { fromMs, toMs: Math.max(toMs, fromMs + dayMs) };
}

const dayMs = 86_400_000;

export interface Placed {
  mark: Mark;
  x: number;
  width: number;
  /** Marks that would lie on each other are put in rows below. */
  row: number;
}

/** Where a lane's marks lie on a width; each is at least `least` wide. */
export function placed(
  marks: readonly Mark[],
  range: Range,
  width: number,
  least: number,
): Placed[] {
  const ends: number[] = [];
  const xOf = (ms: number) => ((ms - range.fromMs) / (range.toMs - range.fromMs)) * width;
  return marks.map((mark) => {
    const wide = Math.max(xOf(mark.toMs) - xOf(mark.fromMs), least);
    const centred = (xOf(mark.fromMs) + xOf(mark.toMs) - wide) / 2;
    const x = Math.min(Math.max(centred, 0), Math.max(0, width - wide));
    let row = ends.findIndex((end) => end <= x + 0.5);
    if (row === -1) row = ends.length;
    ends[row] = x + wide;
    return { mark, x, width: wide, row };
  });
}

/** The mark that an arrow key leads to: along its lane, or to the nearest of the next lane. */
export function next(marks: readonly Mark[], from: Mark, key: string): Mark | null {
  if (key === 'Home') return marks.find((mark) => mark.lane === from.lane) ?? null;
  if (key === 'End') return marks.findLast((mark) => mark.lane === from.lane) ?? null;
  const along = { ArrowLeft: -1, ArrowRight: 1 }[key];
  if (along) {
    const lane = marks.filter((mark) => mark.lane === from.lane);
    return lane[lane.indexOf(from) + along] ?? null;
  }
  const across = { ArrowUp: -1, ArrowDown: 1 }[key];
  if (!across) return null;
  const there = lanes.filter((lane) => marks.some((mark) => mark.lane === lane));
  const lane = there[there.indexOf(from.lane) + across];
  const middle = (mark: Mark) => mark.fromMs + mark.toMs;
  const off = (mark: Mark) => Math.abs(middle(mark) - middle(from));
  const near = marks.filter((mark) => mark.lane === lane);
  return near.reduce<Mark | null>(
    (best, mark) => (best && off(best) <= off(mark) ? best : mark),
    null,
  );
}
