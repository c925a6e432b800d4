/** The pages that each role has, in the bar on top and in the search. Pure. */

import type { Me } from './api/types';
import type { Item } from './finder';
import {
  alertsPath,
  binnaclesPath,
  firmsPath,
  helpPath,
  mailPath,
  notificationsPath,
  reportsPath,
  schedulePath,
  settingsPath,
  settingsPaths,
  vesselsPath,
  webhooksPath,
  workOrdersPath,
  type Route,
} from './state/route.svelte';
import * as text from './text';

/** A page of the bar, and the pages that belong to it. */
export interface Entry {
  path: string;
  title: string;
  pages: Route['page'][];
}

type Reader = Pick<Me, 'role' | 'operator_id'>;

const ofSettings: Route['page'][] = [
  ...(['settings', 'people', 'aboard', 'schedule-rules', 'audit', 'signing-keys'] as const),
  ...(['firm-teams', 'mail', 'webhooks'] as const),
];
const ofOrders: Route['page'][] = ['work-orders', 'work-order', 'new-work-order'];

export function entriesOf({ role }: Pick<Reader, 'role'>): Entry[] {
  const p = text.pages;
  const settings: Entry = { path: settingsPath, title: p.settings, pages: ofSettings };
  const orders: Entry = { path: workOrdersPath, title: p.orders, pages: ofOrders };
  if (role === 'platform_admin') {
    return [{ path: vesselsPath, title: p.platform, pages: ['vessels'] }, settings];
  }
  if (role === 'adjuster') {
    return [{ path: vesselsPath, title: p.home, pages: ['vessels'] }, orders, settings];
  }
  return [
    { path: vesselsPath, title: p.fleet, pages: ['vessels', 'vessel'] },
    { path: alertsPath, title: p.alerts, pages: ['alerts'] },
    { path: schedulePath, title: p.schedule, pages: ['schedule'] },
    { path: reportsPath, title: p.reports, pages: ['reports'] },
    orders,
    { path: binnaclesPath, title: p.binnacles, pages: ['binnacles'] },
    { path: firmsPath, title: p.firms, pages: ['firms'] },
    settings,
  ];
}

/** What the search finds of the pages and settings. */
export function pageItems(reader: Reader): Item[] {
  const t = text.settings;
  const isOfFleet = reader.operator_id !== null;
  const isSeen = (page: Route['page']): boolean => {
    switch (page) {
      case 'audit':
        return reader.role !== 'viewer';
      case 'signing-keys':
      case 'firm-teams':
        return reader.role === 'adjuster';
      default:
        return isOfFleet;
    }
  };
  const item = (kind: Item['kind'], label: string, path: string): Item => ({
    kind,
    label,
    detail: '',
    path,
  });
  return [
    ...entriesOf(reader).map(({ title, path }) => item('page', title, path)),
    item('page', text.pages.notifications, notificationsPath),
    item('page', text.pages.help, helpPath),
    ...settingsPaths
      .filter(({ page }) => isSeen(page))
      .map(({ page, path }) => item('setting', t.pages[page], path)),
    ...(isOfFleet ? [item('setting', t.mail, mailPath)] : []),
    ...(reader.role === 'platform_admin' ? [] : [item('setting', t.webhooks, webhooksPath)]),
    ...text.finder.settings.map((part) => item('setting', part, settingsPath)),
  ];
}
