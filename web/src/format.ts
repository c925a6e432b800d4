/**
 * How values are written for people: angles with one decimal and E or W,
 * headings in three figures, positions in degrees and minutes, times in UTC.
 * Pure functions but for the language of the page, which says the month's name and the
 * decimal mark; what is unknown is a dash, never a zero.
 */

import * as text from './text';
import { aheadMs, type Zone } from './zone';

export const unknown = '–';

/** A figure with so many decimals, and the decimal mark of the language. */
export const fixed = (value: number, digits: number): string =>
  value.toFixed(digits).replace('.', text.formats.decimal);

const month = (index: number): string => text.formats.months[index] ?? '';

/** East-positive angle as `3.4° W`; what rounds to zero has no side. */
export function eastWest(degrees: number | null | undefined, digits = 1): string {
  if (degrees === null || degrees === undefined || !Number.isFinite(degrees)) return unknown;
  const size = fixed(Math.abs(degrees), digits);
  if (isZero(size)) return `${size}°`;
  return `${size}° ${degrees < 0 ? 'W' : 'E'}`;
}

/** A size without a side: `0.4°`. */
export function degrees(value: number | null | undefined, digits = 1): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return unknown;
  return `${plain(value, digits)}°`;
}

/** Half the width of an interval: `± 0.4°`. */
export function plusMinus(value: number | null | undefined, digits = 1): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return unknown;
  return `± ${fixed(Math.abs(value), digits)}°`;
}

/** A direction in three figures: `045°`; north is `000°`. */
export function heading(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return unknown;
  return `${threeFigures(value, 0)}°`;
}

/** A direction in three figures and a tenth: `041.6°`. */
export function fineHeading(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return unknown;
  return `${threeFigures(value, 1)}°`;
}

function threeFigures(value: number, digits: number): string {
  const wrapped = ((value % 360) + 360) % 360;
  const rounded = Number(wrapped.toFixed(digits)) % 360;
  return fixed(rounded, digits).padStart(digits > 0 ? 4 + digits : 3, '0');
}

/** A signed number with a true minus sign; never `-0`. */
export function signed(value: number, digits: number): string {
  const size = fixed(Math.abs(value), digits);
  if (isZero(size)) return size;
  return `${value < 0 ? '−' : '+'}${size}`;
}

function plain(value: number, digits: number): string {
  const size = fixed(Math.abs(value), digits);
  return value < 0 && !isZero(size) ? `−${size}` : size;
}

const isZero = (size: string): boolean => !/[1-9]/.test(size);

export interface Place {
  lat: number;
  lon: number;
}

/** `54° 30.2′ N, 018° 40.0′ E` */
export function position(place: Place | null | undefined): string {
  if (!place) return unknown;
  return `${latitude(place.lat)}, ${longitude(place.lon)}`;
}

export function latitude(value: number): string {
  return `${degreesAndMinutes(value, 2)} ${value < 0 ? 'S' : 'N'}`;
}

export function longitude(value: number): string {
  return `${degreesAndMinutes(value, 3)} ${value < 0 ? 'W' : 'E'}`;
}

function degreesAndMinutes(value: number, figures: number): string {
  // Tenths of a minute are rounded first, so that 59.96′ carries into the degree.
  const tenths = Math.round(Math.abs(value) * 600);
  const whole = Math.floor(tenths / 600);
  const minutes = fixed((tenths % 600) / 10, 1).padStart(4, '0');
  return `${String(whole).padStart(figures, '0')}° ${minutes}′`;
}

/** `14 Nov 2026, 08:30 UTC` */
export function time(value: string | Date | null | undefined): string {
  const date = toDate(value);
  if (!date) return unknown;
  return `${day(date)}, ${clock(date)}`;
}

/** `14 Nov 2026` */
export function day(value: string | Date | null | undefined): string {
  const date = toDate(value);
  if (!date) return unknown;
  return `${date.getUTCDate()} ${month(date.getUTCMonth())} ${date.getUTCFullYear()}`;
}

/** `08:30 UTC` */
export function clock(value: string | Date | null | undefined): string {
  const date = toDate(value);
  if (!date) return unknown;
  return `${date.toISOString().slice(11, 16)} UTC`;
}

/** How far clocks are from UTC: `UTC+2`, `UTC+5:30`. */
export function ahead(ms: number): string {
  const minutes = Math.round(Math.abs(ms) / 60_000);
  if (minutes === 0) return 'UTC';
  const beside = minutes % 60 === 0 ? '' : `:${String(minutes % 60).padStart(2, '0')}`;
  return `UTC${ms < 0 ? '−' : '+'}${Math.floor(minutes / 60)}${beside}`;
}

/** By which clocks an instant is written where those of the place are known. */
export type Clocks = 'utc' | 'ship' | 'both';

/**
 * An instant where clocks keep a zone, as two hours ahead of UTC: `14 Nov 2026, 08:30 UTC`,
 * `14 Nov 2026, 10:30 UTC+2`, or both, with the day where it is another one there:
 * `14 Nov 2026, 23:30 UTC (15 Nov, 01:30 UTC+2)`.
 */
export function atSea(
  value: string | Date | null | undefined,
  zone: Zone | undefined,
  clocks: Clocks,
): string {
  const date = toDate(value);
  if (!date) return unknown;
  const aheadBy = zone === undefined ? 0 : aheadMs(zone, date.getTime());
  if (!aheadBy || clocks === 'utc') return time(date);
  const there = new Date(date.getTime() + aheadBy);
  const hour = `${there.toISOString().slice(11, 16)} ${ahead(aheadBy)}`;
  if (clocks === 'ship') return `${day(there)}, ${hour}`;
  const on = `${there.getUTCDate()} ${month(there.getUTCMonth())}, `;
  return `${time(date)} (${day(there) === day(date) ? '' : on}${hour})`;
}

/**
 * Hours from one instant to another where clocks keep a zone:
 * `8 Dec 2026, 07:00 to 10:00 UTC (08:00 to 11:00 UTC+1)`, each with its day where that differs.
 */
export function hoursAtSea(
  from: string | Date | null | undefined,
  until: string | Date | null | undefined,
  zone: Zone | undefined,
  clocks: Clocks,
): string {
  const [begin, end] = [toDate(from), toDate(until)];
  if (!begin || !end) return atSea(from, zone, clocks);
  const utc = hoursBy(begin, end, 'UTC');
  const aheadBy = zone === undefined ? 0 : aheadMs(zone, begin.getTime());
  if (zone === undefined || !aheadBy || clocks === 'utc') return utc;
  const endAheadBy = aheadMs(zone, end.getTime()) ?? aheadBy;
  const there = new Date(begin.getTime() + aheadBy);
  const hours = hoursBy(there, new Date(end.getTime() + endAheadBy), ahead(aheadBy));
  if (clocks === 'ship') return hours;
  return `${utc} (${day(there) === day(begin) ? hours.replace(/^[^,]*, /, '') : hours})`;
}

function hoursBy(begin: Date, end: Date, zone: string): string {
  const [first, last] = [begin, end].map((date) => date.toISOString().slice(11, 16));
  const on = day(begin) === day(end) ? '' : `${day(end)}, `;
  return `${day(begin)}, ${first ?? ''} ${text.formats.to} ${on}${last ?? ''} ${zone}`;
}

/** The nautical zone of a longitude: hours ahead of UTC. */
export const zoneOf = (lon: number): number => Math.sign(lon) * Math.round(Math.abs(lon) / 15) || 0;

/** `14 Nov, 10:30` by the clock of the device that shows it. */
export function localTime(value: string): string {
  const date = toDate(value);
  if (!date) return unknown;
  const two = (n: number) => String(n).padStart(2, '0');
  const on = `${date.getDate()} ${month(date.getMonth())}`;
  return `${on}, ${two(date.getHours())}:${two(date.getMinutes())}`;
}

function toDate(value: string | Date | null | undefined): Date | null {
  if (value === null || value === undefined) return null;
  const date = typeof value === 'string' ? new Date(value) : value;
  return Number.isNaN(date.getTime()) ? null : date;
}

/** How long ago, roughly: `just now`, `12 min ago`, `3 h ago`, `5 days ago`. */
export function ago(value: string | null | undefined, now: Date): string {
  const date = toDate(value);
  if (!date) return unknown;
  const seconds = (now.getTime() - date.getTime()) / 1000;
  return seconds < 60 ? text.formats.justNow : text.formats.ago(lasting(seconds));
}

/** How long something takes: `7 min`, `5 h`, `3 days`. */
export function lasting(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  if (minutes < 1) return '< 1 min';
  if (minutes < 60) return `${minutes} min`;
  const hours = Math.floor(minutes / 60);
  if (hours < 48) return `${hours} h`;
  return text.formats.days(Math.floor(hours / 24));
}

/** Nanotesla, written for people: `24.1 µT`, kept on one line. */
export function microtesla(nanotesla: number | null | undefined): string {
  if (nanotesla === null || nanotesla === undefined || !Number.isFinite(nanotesla)) return unknown;
  return `${plain(nanotesla / 1000, 1)}\u00a0µT`;
}

/** A count where there is room for few figures: `7`, `99+`. */
export const atMost = (value: number, most: number): string =>
  value > most ? `${most}+` : String(value);

/** A field to a hundredth of a microtesla: what a magnetometer shows. */
export function microteslaFine(nanotesla: number | null | undefined): string {
  if (nanotesla === null || nanotesla === undefined || !Number.isFinite(nanotesla)) return unknown;
  return `${plain(nanotesla / 1000, 2)}\u00a0µT`;
}

/** `2026-11-21`, or an instant as `2026-11-21T07:00:00Z` or `2026-11-21 07:00 UTC`. */
const dates =
  /(?<![\w/-])(\d{4}-\d\d-\d\d)(?:[T\s]+(\d\d:\d\d(?::\d\d(?:\.\d+)?)?)(?:Z|\s?UTC))?(?![\w/-]|\.\w)/g;

/** The server's words with their instants and days as they are written here. */
export function dated(words: string, at: (instant: string) => string = time): string {
  return words.replace(dates, (found, on: string, clock: string | undefined) => {
    // What only looks like a day, as the 31st of February, stays.
    if (toDate(on)?.toISOString().slice(0, 10) !== on) return found;
    return clock === undefined
      ? day(on)
      : toDate(`${on}T${clock}Z`)
        ? at(`${on}T${clock}Z`)
        : found;
  });
}

/** A server's clause as a sentence, its dates as elsewhere, a true minus before figures. */
export function sentence(clause: string, at?: (instant: string) => string): string {
  const trimmed = dated(clause.trim(), at).replace(/(^|[\s(])-(?=\d)/g, '$1−');
  const ended = /[.!?]$/.test(trimmed) ? trimmed : `${trimmed}.`;
  return ended.charAt(0).toUpperCase() + ended.slice(1);
}

/** A figure as it was typed, with a true minus sign: `−17.43`. */
export const typed = (value: number): string =>
  String(value).replace(/^-/, '−').replace('.', text.formats.decimal);

/** A count with thin spaces between thousands: `12 480`. */
export function count(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return unknown;
  return String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** Euros, whole: `€ 1 800`, kept on one line. */
export function euros(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return unknown;
  const whole = count(Math.abs(value));
  return text.formats.euros(value < 0 && whole !== '0' ? '−' : '', whole);
}

/** `64 %`, and `< 1 %` for what is there but small. */
export function percent(part: number, whole: number): string {
  if (whole <= 0) return unknown;
  const share = (100 * part) / whole;
  if (share > 0 && share < 1) return '< 1 %';
  return `${Math.round(share)} %`;
}

const points = 'N NNE NE ENE E ESE SE SSE S SSW SW WSW W WNW NW NNW'.split(' ');

/** The nearest of sixteen points: 45 is `NE`. */
export function compassPoint(value: number): string {
  const wrapped = ((value % 360) + 360) % 360;
  return points[Math.round(wrapped / 22.5) % 16] ?? '';
}

/**
 * Reads a latitude or longitude as officers write it: `54.5`, `-54.5`,
 * `54 30.2 N`, `54° 30.2′ S`, `018°40'12"E`. `null` when it cannot be one.
 */
export function parseAngle(input: string, axis: 'lat' | 'lon'): number | null {
  const sides = axis === 'lat' ? 'NS' : 'EW';
  const match =
    /^\s*([+−-]?)\s*(\d+(?:\.\d+)?)\s*°?\s*(?:(\d+(?:\.\d+)?)\s*[′']?\s*)?(?:(\d+(?:\.\d+)?)\s*[″"]?\s*)?([NSEW]?)\s*$/i.exec(
      input.replace(',', '.'),
    );
  if (!match) return null;
  const [, sign, whole = '', minutes = '0', seconds = '0', side = ''] = match;
  if (Number(minutes) >= 60 || Number(seconds) >= 60) return null;
  if (side !== '' && !sides.includes(side.toUpperCase())) return null;
  if (side !== '' && sign !== '') return null;
  const size = Number(whole) + Number(minutes) / 60 + Number(seconds) / 3600;
  if (size > (axis === 'lat' ? 90 : 180)) return null;
  const negative = sign === '-' || sign === '−' || 'SW'.includes(side.toUpperCase() || ' ');
  return negative && size !== 0 ? -size : size;
}
