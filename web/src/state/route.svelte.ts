/** Which page the address names, and moving between pages without reloading. */

import { tabNamed, tabOf, type VesselPanel, type VesselTab } from '../vessel-tabs';

/** Pages that are known by the first word of their address alone. */
const plain = [
  'alerts',
  'mail',
  'webhooks',
  'schedule',
  'binnacles',
  'firms',
  'reports',
  'notifications',
  'invitation',
  'start',
] as const;

/** The settings' pages, by the second word. */
const ofSettings = {
  people: 'people',
  agents: 'aboard',
  schedule: 'schedule-rules',
  audit: 'audit',
  keys: 'signing-keys',
  teams: 'firm-teams',
} as const;

export type Route =
  | { page: (typeof plain)[number] | (typeof ofSettings)[keyof typeof ofSettings] | 'settings' }
  | { page: 'vessels' | 'work-orders' | 'new-work-order' | 'not-found' }
  | { page: 'vessel'; id: string; tab: VesselTab }
  | { page: 'work-order'; id: string }
  | { page: 'help'; topic: string };

export function parseRoute(path: string): Route {
  const [first, second, ...rest] = path.split('/').filter((part) => part !== '');
  if (first === undefined) return { page: 'vessels' };
  if (first === 'work-orders' && rest.length === 0) return workOrderRoute(second);
  if (first === 'settings' && rest.length === 0) return settingsRoute(second);
  if (first === 'help' && rest.length === 0) return { page: 'help', topic: second ?? '' };
  const known = plain.find((page) => page === first);
  if (known && second === undefined) return { page: known };
  return first === 'vessels' ? vesselRoute(second, rest) : { page: 'not-found' };
}

function vesselRoute(id: string | undefined, [tab, ...rest]: string[]): Route {
  if (id === undefined) return { page: 'vessels' };
  if (tab === undefined) return { page: 'vessel', id, tab: 'overview' };
  const named = rest.length === 0 ? tabNamed(tab) : undefined;
  return named ? { page: 'vessel', id, tab: named } : { page: 'not-found' };
}

function settingsRoute(second: string | undefined): Route {
  if (second === undefined) return { page: 'settings' };
  const known = Object.entries(ofSettings).find(([word]) => word === second);
  return { page: known ? known[1] : 'not-found' };
}

function workOrderRoute(id: string | undefined): Route {
  if (id === undefined) return { page: 'work-orders' };
  return id === 'new' ? { page: 'new-work-order' } : { page: 'work-order', id };
}

export const vesselPath = (id: string): string => `/vessels/${encodeURIComponent(id)}`;
export const vesselTabPath = (id: string, tab: VesselTab): string =>
  tab === 'overview' ? vesselPath(id) : `${vesselPath(id)}/${tab}`;
/** A panel of a vessel's page, on the tab that has it. */
export const vesselPanelPath = (id: string, panel: VesselPanel): string =>
  `${vesselTabPath(id, tabOf(panel) ?? 'overview')}#${panel}`;
/** What changed at an instant, before and after, for one of the vessel's compasses. */
export const changePath = (id: string, compass: string, at: string): string =>
  `${vesselTabPath(id, 'changes')}?${new URLSearchParams({ compass, change: at }).toString()}#changes`;
export const vesselsPath = '/';
export const alertsPath = '/alerts';
/** An alert among the others. */
export const alertPath = (id: string): string => `${alertsPath}#${id}`;
export const mailPath = '/mail';
export const webhooksPath = '/webhooks';
export const schedulePath = '/schedule';
/** What is planned for a compass, or why nothing is. */
export const plannedPath = (compass: string): string => `${schedulePath}#${compass}`;
export const binnaclesPath = '/binnacles';
/** The binnacle of a vessel's compass, on the vessel's page. */
export const binnaclePath = (vessel: string, compass: string): string =>
  `${vesselTabPath(vessel, 'adjustment')}?${new URLSearchParams({ compass }).toString()}#binnacle`;
export const firmsPath = '/firms';
export const startPath = '/start';
export const reportsPath = '/reports';
export const notificationsPath = '/notifications';
export const settingsPath = '/settings';
/** The pages of the settings besides one's own. */
export const settingsPaths = Object.entries(ofSettings).map(([word, page]) => ({
  page,
  path: `/settings/${word}`,
}));
export const helpPath = '/help';
/** A topic of the help, or one of its sections. */
export const helpTopicPath = (topic: string, section?: string): string =>
  `${helpPath}/${topic}${section === undefined ? '' : `#${section}`}`;
export const workOrdersPath = '/work-orders';
export const workOrderPath = (id: string): string => `/work-orders/${encodeURIComponent(id)}`;
/** Where an adjustment is ordered, perhaps of a compass that is already known. */
export function newWorkOrderPath(vessel?: string, compass?: string): string {
  const query = new URLSearchParams({
    ...(vessel === undefined ? {} : { vessel }),
    ...(compass === undefined ? {} : { compass }),
  }).toString();
  return query === '' ? '/work-orders/new' : `/work-orders/new?${query}`;
}

class RouteState {
  current = $state<Route>({ page: 'vessels' });
  /** The address's search, as a page was gone to or wrote it there. */
  search = $state('');

  /** Goes to a page as if a link to it had been followed. */
  go(path: string): void {
    const before = this.current;
    history.pushState(null, '', path);
    this.#read();
    const { current } = this;
    // From tab to tab of one vessel the keyboard stays where it is.
    if (before.page === 'vessel' && current.page === 'vessel' && before.id === current.id) return;
    scrollTo(0, 0);
    // As after a real change of page, the keyboard starts from the top again.
    document.getElementById('content')?.focus({ preventScroll: true });
  }

  /** Takes over what the address names. */
  #read(): void {
    const named = parseRoute(location.pathname);
    if (named.page === 'vessel') {
      // Addresses from before the tabs name the panel alone.
      const tab = tabOf(location.hash.slice(1)) ?? named.tab;
      if (tab !== named.tab) {
        named.tab = tab;
        const path = vesselTabPath(named.id, tab);
        history.replaceState(null, '', `${path}${location.search}${location.hash}`);
      }
    }
    // A link within a page leads nowhere else: the page stays as it is.
    if (JSON.stringify(named) !== JSON.stringify(this.current)) this.current = named;
    this.search = location.search;
  }

  /** Writes another search into the address of the present page. */
  replaceSearch(search: string): void {
    history.replaceState(null, '', `${location.pathname}${search}${location.hash}`);
    this.search = search;
  }

  /** Follows the address bar, and takes over clicks on links within the dashboard. */
  start(): () => void {
    const read = () => {
      this.#read();
    };
    const click = (event: MouseEvent) => {
      if (event.defaultPrevented || event.button !== 0) return;
      if (event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
      const link = event.target instanceof Element ? event.target.closest('a') : null;
      if (link?.target !== '' || link.origin !== location.origin) return;
      const { pathname, search } = location;
      if (link.hash !== '' && link.pathname === pathname && link.search === search) return;
      if (link.pathname.startsWith('/api/') || link.hasAttribute('download')) return;
      event.preventDefault();
      this.go(link.href);
    };
    read();
    addEventListener('popstate', read);
    document.addEventListener('click', click);
    return () => {
      removeEventListener('popstate', read);
      document.removeEventListener('click', click);
    };
  }
}

export const route = new RouteState();
