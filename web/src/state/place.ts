/**
 * A place and an instant in an address, and which compass, so that a page that is opened
 * again, or sent to somebody, shows the same. What is no place counts as none.
 */

import type { Place } from '../api/client';

/** To some ten metres: `lat=-31.45&lon=15.207&at=2026-11-23T12:00:00.000Z`. */
const digits = 4;
const names = ['lat', 'lon', 'at'] as const;

export function placeInSearch(search: string): Place | undefined {
  const params = new URLSearchParams(search);
  const [lat, lon] = [angleOf(params.get('lat'), 90), angleOf(params.get('lon'), 180)];
  const at = new Date(params.get('at') ?? '');
  if (lat === undefined || lon === undefined || Number.isNaN(at.getTime())) return undefined;
  return { lat, lon, at: at.toISOString() };
}

function angleOf(text: string | null, most: number): number | undefined {
  if (text === null || text.trim() === '') return undefined;
  const value = Number(text);
  return Math.abs(value) <= most ? value : undefined;
}

/** Which of her compasses the address names, if it names one. */
export const compassInSearch = (search: string): string | undefined =>
  new URLSearchParams(search).get('compass') ?? undefined;

/** The instant of the change that the address names, if it names one. */
export const changeInSearch = (search: string): string | null =>
  new URLSearchParams(search).get('change');

/** What the address's search carries to another tab: all but the one change. */
export function withoutChange(search: string): string {
  const params = new URLSearchParams(search);
  params.delete('change');
  const left = params.toString();
  return left === '' ? '' : `?${left}`;
}

/** The address's search with this compass; all else in it stays. */
export function withCompass(search: string, compass: string): string {
  const params = new URLSearchParams(search);
  params.set('compass', compass);
  return `?${params.toString()}`;
}

/** The address's search with this place and no other; all else in it stays. */
export function withPlace(search: string, place: Place | undefined): string {
  const params = new URLSearchParams(search);
  for (const name of names) params.delete(name);
  if (place) {
    params.set('lat', String(Number(place.lat.toFixed(digits))));
    params.set('lon', String(Number(place.lon.toFixed(digits))));
    params.set('at', place.at);
  }
  const said = params.toString();
  return said === '' ? '' : `?${said}`;
}
