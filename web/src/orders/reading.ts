/**
 * The form of a reading at the berth: what is typed, and the reading that it makes.
 * Pure. What always holds: a unit is what was chosen, and nothing is guessed.
 */

import type { BerthReading } from '../api/types';
import { latitude, longitude, parseAngle } from '../format';
import { field, instant } from '../logbook';
import * as text from '../text';
import { wrapped } from './ahead';

/** What stands in the fields; an empty one is no value. */
export interface ReadingDraft {
  at: string;
  lat: string;
  lon: string;
  heading: string;
  headingFrom: BerthReading['heading_from'];
  headingSd: string;
  compass: string;
  unit: BerthReading['unit'];
  forward: string;
  starboard: string;
  down: string;
  magnetometer: BerthReading['magnetometer'];
  serial: string;
  fieldSd: string;
  heel: string;
  steel: boolean;
  cargo: boolean;
  /** Where the ship was shifted to another heading of the berth. */
  shiftedHeading: string;
  shiftedForward: string;
  shiftedStarboard: string;
}

export const units: BerthReading['unit'][] = ['microtesla', 'nanotesla', 'gauss', 'milligauss'];
export const magnetometers: BerthReading['magnetometer'][] = [
  'fluxgate',
  'magnetoresistive',
  'other',
  'phone',
];
const nanotesla: Record<BerthReading['unit'], number> = {
  nanotesla: 1,
  microtesla: 1000,
  milligauss: 100,
  gauss: 100_000,
};
/** Between these any ship's horizontal field lies, nT. */
const leastNt = 1_000;
const greatestNt = 60_000;

export function newReading(now: Date): ReadingDraft {
  return {
    at: field(now),
    lat: '',
    lon: '',
    heading: '',
    headingFrom: 'model_reference',
    headingSd: '',
    compass: '',
    unit: 'microtesla',
    forward: '',
    starboard: '',
    down: '',
    magnetometer: 'fluxgate',
    serial: '',
    fieldSd: '',
    heel: '',
    steel: false,
    cargo: false,
    shiftedHeading: '',
    shiftedForward: '',
    shiftedStarboard: '',
  };
}

/** What is typed as a number or not at all. */
const typed = (value: number | null | undefined) => ((value ?? null) === null ? '' : String(value));

/** The reading as it was sent, to which one on another heading is added. */
export function sentDraft(reading: BerthReading, now: Date): ReadingDraft {
  return {
    ...draftOf(reading, now),
    at: field(new Date(reading.at)),
    forward: typed(reading.forward),
    starboard: typed(reading.starboard),
    down: typed(reading.down),
  };
}

/** A reading to be read again: all that does not change from one to the next. */
export function draftOf(reading: BerthReading, now: Date): ReadingDraft {
  return {
    ...newReading(now),
    lat: latitude(reading.lat),
    lon: longitude(reading.lon),
    heading: typed(reading.heading_true_deg),
    headingFrom: reading.heading_from,
    headingSd: typed(reading.heading_sd_deg),
    compass: typed(reading.compass_deg),
    unit: reading.unit,
    magnetometer: reading.magnetometer,
    serial: reading.magnetometer_serial ?? '',
    fieldSd: typed(reading.field_sd_nt),
    heel: reading.heel_deg ? typed(reading.heel_deg) : '',
    steel: reading.steel_nearby ?? false,
    cargo: reading.cargo_on_board ?? false,
  };
}

/** A number as people type it, `null` where it is none. */
export function number(typed: string): number | null {
  const plain = typed.trim().replace(',', '.').replace('−', '-');
  return /^[+-]?(\d+\.?\d*|\.\d+)$/.test(plain) ? Number(plain) : null;
}

/** A heading as people type it: 0 to 360. */
export function headingOf(typed: string): number | null {
  const value = number(typed.replace('°', ''));
  return value !== null && value >= 0 && value <= 360 ? value : null;
}

/** Size of the horizontal field that is typed, nT; `null` until there is one. */
export function horizontalNt(
  draft: Pick<ReadingDraft, 'forward' | 'starboard' | 'unit'>,
): number | null {
  const [forward, starboard] = [number(draft.forward), number(draft.starboard)];
  if (forward === null || starboard === null) return null;
  return Math.hypot(forward, starboard) * nanotesla[draft.unit];
}

/** What is odd about its size: a hint, the server judges. */
export function oddSize(nt: number): string {
  if (nt < leastNt) return text.berth.reading.tooWeak;
  return nt > greatestNt ? text.berth.reading.tooStrong : '';
}

export type Field = keyof ReadingDraft;

/** The first thing that is wrong with a draft. */
export function fault(draft: ReadingDraft): { field: Field; message: string } | null {
  const { wrong, ...t } = text.berth.reading;
  if (instant(draft.at) === null) return { field: 'at', message: wrong.at };
  if (parseAngle(draft.lat, 'lat') === null) return { field: 'lat', message: wrong.lat };
  if (parseAngle(draft.lon, 'lon') === null) return { field: 'lon', message: wrong.lon };
  if (headingOf(draft.heading) === null) {
    return { field: 'heading', message: wrong.heading(t.heading) };
  }
  if (draft.compass.trim() !== '' && headingOf(draft.compass) === null) {
    return { field: 'compass', message: wrong.heading(t.compass) };
  }
  for (const [name, label] of [
    ['forward', t.forward],
    ['starboard', t.starboard],
  ] as const) {
    if (number(draft[name]) === null) return { field: name, message: wrong.number(label) };
  }
  if (draft.down.trim() !== '' && number(draft.down) === null) {
    return { field: 'down', message: wrong.number(t.down) };
  }
  const heel = draft.heel.trim() === '' ? 0 : number(draft.heel);
  if (heel === null || Math.abs(heel) > 30) return { field: 'heel', message: wrong.heel };
  for (const name of ['headingSd', 'fieldSd'] as const) {
    if (draft[name].trim() !== '' && !((number(draft[name]) ?? 0) > 0)) {
      return { field: name, message: wrong.sd };
    }
  }
  return faultOfShifted(draft);
}

/** Part of the reading on another heading: all three figures, or none. */
const shiftedFields = ['shiftedHeading', 'shiftedForward', 'shiftedStarboard'] as const;
const isShifted = (draft: ReadingDraft) => shiftedFields.some((name) => draft[name].trim() !== '');
/** The least that the other heading is off, degrees. */
const leastShiftDeg = 30;

function faultOfShifted(draft: ReadingDraft): { field: Field; message: string } | null {
  if (!isShifted(draft)) return null;
  const { wrong, ...t } = text.berth.reading;
  const [first, other] = [headingOf(draft.heading), headingOf(draft.shiftedHeading)];
  if (other === null) return { field: 'shiftedHeading', message: wrong.heading(t.shiftedHeading) };
  if (Math.abs(wrapped(other - (first ?? 0))) < leastShiftDeg) {
    return { field: 'shiftedHeading', message: wrong.shifted };
  }
  for (const [name, label] of [
    ['shiftedForward', t.shiftedForward],
    ['shiftedStarboard', t.shiftedStarboard],
  ] as const) {
    if (number(draft[name]) === null) return { field: name, message: wrong.number(label) };
  }
  return null;
}

/** The reading that a draft without fault makes. */
export function readingOf(draft: ReadingDraft): BerthReading {
  const optional = (typed: string) => (typed.trim() === '' ? null : number(typed));
  const reading: BerthReading = {
    at: instant(draft.at) ?? '',
    lat: parseAngle(draft.lat, 'lat') ?? 0,
    lon: parseAngle(draft.lon, 'lon') ?? 0,
    heading_true_deg: headingOf(draft.heading) ?? 0,
    heading_from: draft.headingFrom,
    forward: number(draft.forward) ?? 0,
    starboard: number(draft.starboard) ?? 0,
    unit: draft.unit,
    magnetometer: draft.magnetometer,
    heel_deg: optional(draft.heel) ?? 0,
    steel_nearby: draft.steel,
    cargo_on_board: draft.cargo,
  };
  const [down, headingSd, fieldSd] = [draft.down, draft.headingSd, draft.fieldSd].map(optional);
  const compass = draft.compass.trim() === '' ? null : headingOf(draft.compass);
  if (compass !== null) reading.compass_deg = compass;
  if ((down ?? null) !== null) reading.down = down ?? 0;
  if (headingSd) reading.heading_sd_deg = headingSd;
  if (fieldSd) reading.field_sd_nt = fieldSd;
  if (isShifted(draft)) {
    reading.shifted = {
      heading_true_deg: headingOf(draft.shiftedHeading) ?? 0,
      forward: number(draft.shiftedForward) ?? 0,
      starboard: number(draft.shiftedStarboard) ?? 0,
    };
  }
  if (draft.serial.trim() !== '') reading.magnetometer_serial = draft.serial.trim();
  return reading;
}
