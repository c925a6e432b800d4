/**
 * The papers that an inspector asks for: where the server has them, and whose they
 * are. Pure functions; the server makes the papers.
 */

import type { Place } from './api/client';

/** The forms of a deviation card. */
export const cardForms = ['pdf', 'svg', 'csv', 'json'] as const;
export type CardForm = (typeof cardForms)[number];

/** Where a compass's deviation card is; at the last position without a place. */
export function cardPath(vessel: string, form: CardForm, compass?: string, place?: Place): string {
  const query = new URLSearchParams();
  if (compass !== undefined) query.set('compass', compass);
  if (place) {
    query.set('lat', String(place.lat));
    query.set('lon', String(place.lon));
    query.set('at', place.at);
  }
  return path(vessel, `card.${form}`, query);
}

/** Where a compass's deviation book is, from a day to another, both in it. */
export function bookPath(
  vessel: string,
  form: 'pdf' | 'csv',
  compass?: string,
  from?: string,
  to?: string,
): string {
  const query = new URLSearchParams();
  if (compass !== undefined) query.set('compass', compass);
  if (from) query.set('from', `${from}T00:00:00Z`);
  if (to) query.set('to', dayAfter(to));
  return path(vessel, `deviation-book.${form}`, query);
}

function path(vessel: string, what: string, query: URLSearchParams): string {
  const asked = query.toString();
  return `/api/v1/vessels/${vessel}/${what}${asked === '' ? '' : `?${asked}`}`;
}

function dayAfter(day: string): string {
  const date = new Date(`${day}T00:00:00Z`);
  date.setUTCDate(date.getUTCDate() + 1);
  return date.toISOString();
}
