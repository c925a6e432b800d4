/**
 * Views of the fleet that a person saved, in this browser.
 *
 * What always holds: what cannot be read counts as nothing saved, and a browser that
 * keeps nothing is no error.
 */

export interface SavedView {
  name: string;
  /** As in the address bar. */
  search: string;
}

interface Store {
  getItem: (key: string) => string | null;
  setItem: (key: string, value: string) => void;
}

const keyOf = (person: string): string => `binnacle.views.${person}`;

export function savedViews(store: Store, person: string): SavedView[] {
  try {
    const found: unknown = JSON.parse(store.getItem(keyOf(person)) ?? '[]');
    return Array.isArray(found) ? found.filter(isView) : [];
  } catch {
    return [];
  }
}

function isView(value: unknown): value is SavedView {
  if (typeof value !== 'object' || value === null) return false;
  if (!('name' in value) || typeof value.name !== 'string') return false;
  return 'search' in value && typeof value.search === 'string';
}

/** With a view more, in place of one of the same name. */
export function withView(views: readonly SavedView[], view: SavedView): SavedView[] {
  const others = views.filter(({ name }) => name !== view.name);
  return [...others, view].sort((a, b) => a.name.localeCompare(b.name, 'en'));
}

export function saveViews(store: Store, person: string, views: readonly SavedView[]): void {
  try {
    store.setItem(keyOf(person), JSON.stringify(views));
  } catch {
    // A private window may keep nothing: the view holds until the page is left.
  }
}
