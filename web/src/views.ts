/** Views of the fleet that a person saved, on the server. */

import type { FleetView } from './api/types';

/** With a view more, in place of one of the same name. */
export function withView(views: readonly FleetView[], view: FleetView): FleetView[] {
  const others = views.filter(({ name }) => name !== view.name);
  return [...others, view].sort((a, b) => a.name.localeCompare(b.name, 'en'));
}

type Store = Pick<Storage, 'getItem' | 'removeItem'>;
interface Server {
  list: () => Promise<FleetView[]>;
  put: (views: FleetView[]) => Promise<FleetView[]>;
}

/** So many views the server keeps of a person. */
const mostViews = 50;
const keyOf = (person: string): string => `binnacle.views.${person}`;

/**
 * The views on the server. Those that a browser kept before they were kept there are sent to a
 * server that has none; if that fails, the next time.
 */
export async function broughtOver(
  store: Store,
  person: string,
  { list, put }: Server,
): Promise<FleetView[]> {
  const views = await list();
  const kept = keptViews(store, person);
  if (kept.length === 0 || views.length > 0) return views;
  const brought = await put(kept.slice(0, mostViews)).catch(() => undefined);
  if (!brought) return views;
  store.removeItem(keyOf(person));
  return brought;
}

function keptViews(store: Store, person: string): FleetView[] {
  try {
    const found: unknown = JSON.parse(store.getItem(keyOf(person)) ?? '[]');
    return Array.isArray(found) ? found.filter(isView) : [];
  } catch {
    return [];
  }
}

function isView(value: unknown): value is FleetView {
  if (typeof value !== 'object' || value === null) return false;
  if (!('name' in value) || typeof value.name !== 'string') return false;
  return 'search' in value && typeof value.search === 'string';
}
