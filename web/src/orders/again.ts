/**
 * The form of the reading after the steps: what is typed, and the reading that it makes.
 * Pure. What always holds: the unit is the first reading's until another is chosen.
 */

import type { BerthReading, SecondReading } from '../api/types';
import { field, instant } from '../logbook';
import * as text from '../text';
import { headingOf, number, type ReadingDraft } from './reading';

/** What stands in the fields; an empty one is no value. */
export type AgainDraft = Pick<
  ReadingDraft,
  'at' | 'forward' | 'starboard' | 'down' | 'unit' | 'compass' | 'heading'
>;

export function newAgain(first: BerthReading | null, now: Date): AgainDraft {
  return {
    at: field(now),
    forward: '',
    starboard: '',
    down: '',
    unit: first?.unit ?? 'microtesla',
    compass: '',
    heading: '',
  };
}

/** The first thing that is wrong with a draft. */
export function faultAgain(draft: AgainDraft): { field: keyof AgainDraft; message: string } | null {
  const { wrong, ...t } = text.berth.reading;
  if (instant(draft.at) === null) return { field: 'at', message: wrong.at };
  for (const name of ['forward', 'starboard'] as const) {
    if (number(draft[name]) === null) return { field: name, message: wrong.number(t[name]) };
  }
  if (draft.down.trim() !== '' && number(draft.down) === null) {
    return { field: 'down', message: wrong.number(t.down) };
  }
  for (const name of ['compass', 'heading'] as const) {
    if (draft[name].trim() !== '' && headingOf(draft[name]) === null) {
      return { field: name, message: wrong.heading(t[name]) };
    }
  }
  return null;
}

/** The reading that a draft without fault makes. */
export function againOf(draft: AgainDraft): SecondReading {
  const reading: SecondReading = {
    at: instant(draft.at) ?? '',
    forward: number(draft.forward) ?? 0,
    starboard: number(draft.starboard) ?? 0,
    unit: draft.unit,
  };
  const [down, compass, heading] = [
    draft.down.trim() === '' ? null : number(draft.down),
    draft.compass.trim() === '' ? null : headingOf(draft.compass),
    draft.heading.trim() === '' ? null : headingOf(draft.heading),
  ];
  if (down !== null) reading.down = down;
  if (compass !== null) reading.compass_deg = compass;
  if (heading !== null) reading.heading_true_deg = heading;
  return reading;
}
