import { expect, test } from 'vitest';
import type { Me } from './api/types';
import { entriesOf, pageItems } from './navigation';

const reader = (role: Me['role'], operator_id: string | null = null) => ({ role, operator_id });
const paths = (items: { path: string }[]) => items.map(({ path }) => path);

test('each role has the pages of its work in the bar', () => {
  expect(paths(entriesOf(reader('viewer')))).toContain('/schedule');
  expect(paths(entriesOf(reader('adjuster')))).toEqual(['/', '/work-orders', '/settings']);
  expect(paths(entriesOf(reader('platform_admin')))).toEqual(['/', '/settings']);
});

test('the search finds every page of the bar, and only settings that the reader may open', () => {
  for (const role of ['admin', 'viewer', 'adjuster', 'platform_admin'] as const) {
    const one = reader(role, role === 'admin' || role === 'viewer' ? 'o' : null);
    const found = paths(pageItems(one));
    for (const path of paths(entriesOf(one))) expect(found).toContain(path);
    expect(found.includes('/settings/audit')).toBe(role !== 'viewer');
    expect(found.includes('/settings/teams')).toBe(role === 'adjuster');
    expect(found.includes('/settings/people')).toBe(one.operator_id !== null);
    expect(found.includes('/webhooks')).toBe(role !== 'platform_admin');
  }
});
