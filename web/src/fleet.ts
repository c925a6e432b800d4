/**
 * How a fleet is searched, filtered and put in order, and what is said of a vessel in a
 * line. Pure functions: the page holds the query, the address bar repeats it.
 */

import type { FleetVessel } from './api/types';
import { pressing, reasonsOf, worstAhead, type FleetLine } from './attention';
import { plainly } from './plainly';
import { grade } from './science/curve';

export const filters = ['all', 'attention', 'unacknowledged', 'large', 'weak', 'silent'] as const;
export type Filter = (typeof filters)[number];

export const sorts = ['needs', 'name', 'worst', 'quality', 'upload', 'due', 'call'] as const;
export type Sort = (typeof sorts)[number];

export interface Query {
  search: string;
  filter: Filter;
  sort: Sort;
  /** Only vessels with this tag; all where it is empty. */
  tag: string;
  /** Against the column's usual order. */
  reversed: boolean;
}

export const usual: Query = {
  search: '',
  filter: 'all',
  sort: 'needs',
  tag: '',
  reversed: false,
};

const dayMs = 86_400_000;

/** The vessels that a query asks for, in its order; equals by name. */
export function arranged(vessels: readonly FleetLine[], query: Query, now: Date): FleetLine[] {
  const sign = query.reversed ? -1 : 1;
  return named(vessels, query)
    .filter((vessel) => passes(vessel, query.filter, now))
    .sort((a, b) => sign * compare(a, b, query.sort) || byName(a, b));
}

/** How many vessels each filter finds among those with the words and the tag asked for. */
export function countsOf(
  vessels: readonly FleetLine[],
  query: Query,
  now: Date,
): Record<Filter, number> {
  const among = named(vessels, query);
  return Object.fromEntries(
    filters.map((filter) => [filter, among.filter((one) => passes(one, filter, now)).length]),
  ) as Record<Filter, number>;
}

/** Those with the words and the tag that a query asks for. */
function named(vessels: readonly FleetLine[], { search, tag }: Query): FleetLine[] {
  const words = plainly(search).split(/\s+/).filter(Boolean);
  return vessels.filter(
    (vessel) => (tag === '' || vessel.tags.includes(tag)) && says(vessel, words),
  );
}

function says(vessel: FleetVessel, words: string[]): boolean {
  const hay = plainly([vessel.name, vessel.imo_number, vessel.call_sign].join(' '));
  return words.every((word) => hay.includes(word));
}

function passes(vessel: FleetLine, filter: Filter, now: Date): boolean {
  switch (filter) {
    case 'all':
      return true;
    case 'attention':
      return reasonsOf(vessel).length > 0;
    case 'unacknowledged':
      return vessel.open_alerts > 0;
    case 'large':
      return grade(worstAhead(vessel)?.worst.deviation_deg ?? 0) === 'large';
    case 'weak':
      return ['weak', 'none'].includes(quality(vessel));
    case 'silent':
      return now.getTime() - uploadedAt(vessel) > dayMs;
  }
}

const byName = (a: FleetVessel, b: FleetVessel): number => a.name.localeCompare(b.name, 'en');

/** What wants to be looked at first is less. */
function compare(a: FleetLine, b: FleetLine, sort: Sort): number {
  switch (sort) {
    case 'name':
      return byName(a, b);
    case 'needs':
      return pressing(b) - pressing(a) || size(b) - size(a);
    case 'worst':
      return size(b) - size(a);
    case 'quality':
      return qualities.indexOf(quality(a)) - qualities.indexOf(quality(b)) || rms(b) - rms(a);
    case 'upload':
      return uploadedAt(a) - uploadedAt(b);
    case 'due':
      return dueAt(a) - dueAt(b);
    case 'call':
      return arrivesAt(a) - arrivesAt(b);
  }
}

const uploadedAt = (vessel: FleetVessel): number =>
  vessel.last_upload_at === null ? 0 : Date.parse(vessel.last_upload_at);

const dueAt = ({ due }: FleetLine): number => (due ? Date.parse(due.on) : Number.MAX_VALUE);

const arrivesAt = ({ next_call }: FleetVessel): number =>
  next_call === null ? Number.MAX_VALUE : Date.parse(next_call.eta);

/** Nothing is less than the least deviation. */
const size = (vessel: FleetVessel): number => {
  const ahead = worstAhead(vessel);
  return ahead ? Math.abs(ahead.worst.deviation_deg) : -1;
};

const rms = (vessel: FleetVessel): number => vessel.model?.rms_deg ?? 0;

export type Quality = 'firm' | 'fair' | 'weak' | 'none';
const qualities: readonly Quality[] = ['none', 'weak', 'fair', 'firm'];

const firmBandDeg = 1;
const fairBandDeg = 3;

/** How far her model can be trusted on the heading where it matters most. */
export function quality(vessel: FleetVessel): Quality {
  const { model } = vessel;
  if (!model) return 'none';
  const band = worstAhead(vessel)?.worst.band95_deg ?? Infinity;
  if (band <= firmBandDeg && model.cautions === 0) return 'firm';
  return band <= fairBandDeg ? 'fair' : 'weak';
}

/** A query as it stands in the address bar; the usual one is nothing. */
export function toSearch({ search, filter, sort, tag, reversed }: Query): string {
  const params = new URLSearchParams();
  if (search.trim() !== '') params.set('q', search.trim());
  if (filter !== usual.filter) params.set('show', filter);
  if (sort !== usual.sort) params.set('sort', sort);
  if (tag !== '') params.set('tag', tag);
  if (reversed) params.set('order', 'reversed');
  const text = params.toString();
  return text === '' ? '' : `?${text}`;
}

/** The query in an address; what is not understood is as usual. */
export function fromSearch(text: string): Query {
  const params = new URLSearchParams(text);
  return {
    search: params.get('q') ?? '',
    filter: filters.find((known) => known === params.get('show')) ?? usual.filter,
    sort: sorts.find((known) => known === params.get('sort')) ?? usual.sort,
    tag: params.get('tag') ?? '',
    reversed: params.get('order') === 'reversed',
  };
}

/** The tags that any of the vessels has. */
export const tagsOf = (vessels: readonly FleetVessel[]): string[] =>
  [...new Set(vessels.flatMap(({ tags }) => tags))].sort((a, b) => a.localeCompare(b, 'en'));

/** Another column's usual order first, and then its reverse. */
export const sortedBy = (query: Query, sort: Sort): Query => ({
  ...query,
  sort,
  reversed: query.sort === sort ? !query.reversed : false,
});

/** The fleet with news of one vessel: hers replaced, hers added, or hers gone. */
export function withNews(
  fleet: readonly FleetVessel[],
  id: string,
  news: FleetVessel | undefined,
): FleetVessel[] {
  if (!news) return fleet.filter((vessel) => vessel.id !== id);
  if (!fleet.some((vessel) => vessel.id === id)) return [...fleet, news];
  return fleet.map((vessel) => (vessel.id === id ? news : vessel));
}

/** Who never sent anything comes first, then who has been silent longest. */
export const longestSilentFirst = <V extends { name: string; last_upload_at: string | null }>(
  vessels: readonly V[],
): V[] =>
  [...vessels].sort(
    (a, b) =>
      Date.parse(a.last_upload_at ?? '1970-01-01') - Date.parse(b.last_upload_at ?? '1970-01-01') ||
      a.name.localeCompare(b.name, 'en'),
  );
