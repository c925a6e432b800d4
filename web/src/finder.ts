/** What the search over everything finds: pages, settings, vessels, ports, orders. Pure. */

import type { FleetVessel, WorkOrderSummary } from './api/types';
import { day } from './format';
import { stateName } from './orders/order';
import { plainly } from './plainly';
import { vesselPath, vesselTabPath, workOrderPath } from './state/route.svelte';
import * as text from './text';

export type Kind = keyof typeof text.finder.kinds;

export interface Item {
  kind: Kind;
  label: string;
  detail: string;
  path: string;
  /** What else it is found by. */
  also?: string;
}

/** So many are listed: who needs more writes another letter. */
export const mostFound = 12;

export function vesselItems(vessels: readonly FleetVessel[]): Item[] {
  return vessels.map(({ id, name, imo_number, call_sign }) => ({
    kind: 'vessel',
    label: name,
    detail: [imo_number && `IMO ${imo_number}`, call_sign].filter((part) => part).join(' · '),
    path: vesselPath(id),
  }));
}

/** The ports that vessels call at next, each with the vessel that comes first. */
export function portItems(vessels: readonly FleetVessel[]): Item[] {
  const calls = vessels
    .flatMap(({ id, name, next_call: call }) => (call ? [{ id, name, call }] : []))
    .sort((a, b) => a.call.eta.localeCompare(b.call.eta));
  return calls.map(({ id, name, call }) => ({
    kind: 'port',
    label: call.port_name || call.port,
    detail: text.finder.call(name, day(call.eta)),
    path: vesselPath(id),
    also: call.port,
  }));
}

export function orderItems(orders: readonly WorkOrderSummary[]): Item[] {
  return orders.map(({ id, vessel_name, port, planned_at, state, firm }) => ({
    kind: 'order',
    label: text.finder.order(vessel_name),
    detail: [stateName(state), port, day(planned_at)].join(' · '),
    path: workOrderPath(id),
    also: firm ?? '',
  }));
}

/** The tabs of the vessels, found with the vessel's name and the tab's. */
export function tabItems(vessels: readonly FleetVessel[]): Item[] {
  const tabs = ['deviation', 'changes', 'adjustment', 'agent', 'settings'] as const;
  return vessels.flatMap(({ id, name }) =>
    tabs.map((tab) => ({
      kind: 'vessel' as const,
      label: `${name}: ${text.vesselTabs[tab]}`,
      detail: '',
      path: vesselTabPath(id, tab),
    })),
  );
}

/**
 * Those with every word of the query in them, the best first: a label that begins with the
 * query, then one with a word that does, then the rest, each in the order given.
 */
export function matching(items: readonly Item[], query: string): Item[] {
  const sought = plainly(query).trim();
  const words = sought.split(/\s+/).filter((word) => word !== '');
  const rank = (item: Item): number => {
    const label = plainly(item.label);
    if (label.startsWith(sought)) return 0;
    return label.split(/[\s,.:()-]+/).some((word) => word.startsWith(sought)) ? 1 : 2;
  };
  return items
    .filter((item) => {
      const all = plainly([item.label, item.detail, item.also ?? ''].join(' '));
      return words.every((word) => all.includes(word));
    })
    .map((item, place) => ({ item, place, rank: rank(item) }))
    .sort((a, b) => a.rank - b.rank || a.place - b.place)
    .slice(0, mostFound)
    .map(({ item }) => item);
}
