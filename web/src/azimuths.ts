/**
 * The form of azimuths: what is typed, and the azimuth that it makes. Times are typed in UTC, to
 * the second. Pure functions.
 */

import type { AzimuthKind, AzimuthResult, HorizonSight, NewAzimuth } from './api/types';
import { eastWest, fineHeading, latitude, longitude, parseAngle, type Place } from './format';
import * as text from './text';

/** What stands in the fields; an empty one is no value. */
export interface Draft {
  kind: AzimuthKind;
  time: string;
  lat: string;
  lon: string;
  compass: string;
  compass_heading_deg: string;
  compass_bearing_deg: string;
  gyro_heading_deg: string;
  gyro_bearing_deg: string;
  horizon: HorizonSight;
  height_of_eye_m: string;
  name: string;
  true_bearing_deg: string;
  altitude_deg: string;
  observer: string;
  remark: string;
  confirmed: boolean;
}

export const kinds: AzimuthKind[] = ['sun_azimuth', 'sun_amplitude', 'body', 'transit', 'quay'];
export const horizons: HorizonSight[] = ['celestial', 'upper_limb', 'lower_limb', 'centre'];

/** Fields that are typed as a number, as they come in the form. */
export const numbers = [
  'compass_heading_deg',
  'compass_bearing_deg',
  'gyro_heading_deg',
  'gyro_bearing_deg',
  'height_of_eye_m',
  'true_bearing_deg',
  'altitude_deg',
] as const;
type NumberField = (typeof numbers)[number];

const isTyped = (kind: AzimuthKind): boolean => kind !== 'sun_azimuth' && kind !== 'sun_amplitude';

/** Whether a field counts for what the draft observes. */
export function uses(draft: Draft, field: keyof Draft): boolean {
  switch (field) {
    case 'horizon':
      return draft.kind === 'sun_amplitude';
    case 'height_of_eye_m':
      return draft.kind === 'sun_amplitude' && draft.horizon !== 'celestial';
    case 'name':
    case 'true_bearing_deg':
      return isTyped(draft.kind);
    case 'altitude_deg':
      return draft.kind === 'body';
    case 'compass_bearing_deg':
    case 'gyro_bearing_deg':
      return draft.kind !== 'quay';
    default:
      return true;
  }
}

export function newDraft(now: Date, place: Place | undefined): Draft {
  return {
    kind: 'sun_azimuth',
    time: now.toISOString().slice(0, 19),
    lat: place ? latitude(place.lat) : '',
    lon: place ? longitude(place.lon) : '',
    compass: '',
    compass_heading_deg: '',
    compass_bearing_deg: '',
    gyro_heading_deg: '',
    gyro_bearing_deg: '',
    horizon: 'celestial',
    height_of_eye_m: '',
    name: '',
    true_bearing_deg: '',
    altitude_deg: '',
    observer: '',
    remark: '',
    confirmed: false,
  };
}

/** The number that a field holds; `null` for none, `NaN` for what is no number. */
function numberOf(draft: Draft, field: NumberField): number | null {
  const typed = draft[field].trim().replace(',', '.');
  if (typed === '' || !uses(draft, field)) return null;
  return /^-?\d+(\.\d+)?$/.test(typed) ? Number(typed) : NaN;
}

const instantOf = (typed: string): Date => new Date(`${typed}Z`);

/** What is wrong with a draft; `null` when it can be sent. */
export function fault(draft: Draft): { field: keyof Draft; message: string } | null {
  const t = text.azimuths;
  if (draft.time === '' || Number.isNaN(instantOf(draft.time).getTime())) {
    return { field: 'time', message: t.timeMissing };
  }
  if (parseAngle(draft.lat, 'lat') === null) return { field: 'lat', message: t.latWrong };
  if (parseAngle(draft.lon, 'lon') === null) return { field: 'lon', message: t.lonWrong };
  for (const field of numbers) {
    if (Number.isNaN(numberOf(draft, field))) return { field, message: t.notANumber(t[field]) };
  }
  const needed: (NumberField | 'observer' | 'name')[] = ['compass_heading_deg', 'observer'];
  if (uses(draft, 'name')) needed.push('name', 'true_bearing_deg');
  if (uses(draft, 'height_of_eye_m')) needed.push('height_of_eye_m');
  if (uses(draft, 'compass_bearing_deg') && draft.gyro_bearing_deg.trim() === '') {
    needed.push('compass_bearing_deg');
  }
  const field = needed.find((one) => draft[one].trim() === '');
  return field ? { field, message: t.missing(t[field]) } : null;
}

/** The azimuth that a draft without fault makes. */
export function azimuthOf(draft: Draft): NewAzimuth {
  return {
    kind: draft.kind,
    time: instantOf(draft.time).toISOString(),
    lat: parseAngle(draft.lat, 'lat') ?? NaN,
    lon: parseAngle(draft.lon, 'lon') ?? NaN,
    compass_id: draft.compass === '' ? null : draft.compass,
    compass_heading_deg: numberOf(draft, 'compass_heading_deg') ?? NaN,
    compass_bearing_deg: numberOf(draft, 'compass_bearing_deg'),
    gyro_heading_deg: numberOf(draft, 'gyro_heading_deg'),
    gyro_bearing_deg: numberOf(draft, 'gyro_bearing_deg'),
    horizon: uses(draft, 'horizon') ? draft.horizon : null,
    height_of_eye_m: numberOf(draft, 'height_of_eye_m'),
    name: uses(draft, 'name') ? draft.name.trim() : null,
    true_bearing_deg: numberOf(draft, 'true_bearing_deg'),
    altitude_deg: numberOf(draft, 'altitude_deg'),
    confirmed: draft.confirmed,
    observer: draft.observer.trim(),
    remark: draft.remark.trim(),
  };
}

/** `Compass error 2.3° E · deviation 1.9° E, variation 0.4° E · gyro error 0.3° E` */
export function inWords(result: AzimuthResult): string {
  const t = text.azimuths;
  const { gyro_error_deg: gyro } = result;
  const parts = [
    t.error(eastWest(result.compass_error_deg)),
    t.deviation(eastWest(result.deviation_deg), eastWest(result.variation_deg)),
    ...(gyro === null ? [] : [t.gyro(eastWest(gyro))]),
    t.trueBearing(fineHeading(result.true_bearing_deg)),
  ];
  return parts.join(' · ');
}
