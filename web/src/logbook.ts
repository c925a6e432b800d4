/**
 * The logbook's form: what a reporter types, and the entry that it makes. Times are
 * typed in UTC, to the minute, and shown by the clocks that the reader chose. Pure functions.
 */

import type { CargoKind, LogbookEntry, LogbookKind, NewEntry } from './api/types';
import { time } from './format';
import * as text from './text';
import { fromTo, type At } from './whereabouts';

/** What stands in the fields; an empty one is no value. */
export interface Draft {
  kind: LogbookKind;
  from: string;
  to: string;
  cargo: CargoKind;
  hatch: string;
  port: string;
  compass: string;
  note: string;
}

/** The kinds in groups, what is reported most often first. */
export const groups: { name: 'cargo' | 'blow' | 'work' | 'rest'; kinds: LogbookKind[] }[] = [
  { name: 'cargo', kinds: ['magnetic_cargo', 'berth'] },
  { name: 'blow', kinds: ['lightning', 'shock'] },
  {
    name: 'work',
    kinds: [
      'adjustment',
      'corrector_change',
      'compass_moved',
      'repair',
      'dry_docking',
      'welding',
      'degaussing',
    ],
  },
  { name: 'rest', kinds: ['note'] },
];

export const cargoes: CargoKind[] = ['steel', 'scrap', 'containers', 'other'];

const ofOneCompass: LogbookKind[] = [
  'adjustment',
  'corrector_change',
  'compass_moved',
  'repair',
  'note',
];

/** Whether an entry of this kind may concern one compass only. */
export const mayNameCompass = (kind: LogbookKind): boolean => ofOneCompass.includes(kind);

/** Whether an entry of this kind goes on until somebody closes it. */
export const lasts = (kind: LogbookKind): boolean => kind === 'magnetic_cargo' || kind === 'berth';

export const isOpen = (entry: LogbookEntry): boolean =>
  lasts(entry.kind) && (entry.to ?? null) === null && entry.withdrawn_at === null;

/** An instant as a field of type `datetime-local` has it, in UTC: `2026-11-21T07:30`. */
export function field(value: string | Date | null | undefined): string {
  if (value === null || value === undefined) return '';
  const date = new Date(value);
  return Number.isNaN(date.getTime()) ? '' : date.toISOString().slice(0, 16);
}

/** The instant that such a field names, read as UTC; `null` when it names none. */
export function instant(typed: string): string | null {
  const date = new Date(`${typed}Z`);
  return typed === '' || Number.isNaN(date.getTime()) ? null : date.toISOString();
}

export function newDraft(now: Date): Draft {
  return {
    kind: 'magnetic_cargo',
    from: field(now),
    to: '',
    cargo: 'steel',
    hatch: '',
    port: '',
    compass: '',
    note: '',
  };
}

export function draftOf(entry: LogbookEntry): Draft {
  return {
    kind: entry.kind,
    from: field(entry.from),
    to: field(entry.to),
    cargo: entry.cargo ?? 'other',
    hatch: entry.hatch ?? '',
    port: entry.port ?? '',
    compass: entry.compass_id ?? '',
    note: entry.note,
  };
}

/** What is wrong with a draft; `null` when it can be sent. */
export function fault(draft: Draft): { field: 'from' | 'to'; message: string } | null {
  const from = instant(draft.from);
  if (from === null) return { field: 'from', message: text.logbook.fromMissing };
  if (draft.to === '') return null;
  const to = instant(draft.to);
  if (to === null) return { field: 'to', message: text.logbook.toWrong };
  return to < from ? { field: 'to', message: text.logbook.toBeforeFrom } : null;
}

/**
 * The entry that a draft without fault makes. A field shows minutes: where it was
 * not touched, the entry keeps the seconds that it had.
 */
export function entryOf(draft: Draft, before?: LogbookEntry): NewEntry {
  const isCargo = draft.kind === 'magnetic_cargo';
  const at = (typed: string, was: string | null | undefined): string | null =>
    was && field(was) === typed ? was : instant(typed);
  return {
    kind: draft.kind,
    from: at(draft.from, before?.from) ?? '',
    to: at(draft.to, before?.to),
    cargo: isCargo ? draft.cargo : null,
    hatch: isCargo ? blankToNull(draft.hatch) : null,
    port: blankToNull(draft.port),
    compass_id: mayNameCompass(draft.kind) ? blankToNull(draft.compass) : null,
    note: draft.note.trim(),
  };
}

function blankToNull(typed: string): string | null {
  const trimmed = typed.trim();
  return trimmed === '' ? null : trimmed;
}

/** `14 Nov 2026, 08:30 – 16:00 UTC`, `since 14 Nov 2026, 08:30 UTC`. */
export function period(entry: LogbookEntry, at: At = time): string {
  const { from, to } = entry;
  if (to) return fromTo(at(from), at(to));
  return isOpen(entry) ? text.logbook.since(at(from)) : at(from);
}

/** What was reported, in a few words: `Scrap, hatch 2, Bilbao`. */
export function details(entry: LogbookEntry, compassName: (id: string) => string): string {
  const parts = [
    entry.cargo ? text.logbook.cargoes[entry.cargo] : null,
    entry.hatch ? text.logbook.inHatch(entry.hatch) : null,
    entry.port ?? null,
    entry.compass_id ? compassName(entry.compass_id) : null,
  ];
  return parts.filter((part) => part !== null && part !== '').join(', ');
}
