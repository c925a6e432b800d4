import { expect, test } from 'vitest';
import type { FleetLine } from './attention';
import { fleetCsv, hiddenColumns, hideColumns } from './fleet-columns';

const vessel = (name: string) =>
  ({
    name,
    imo_number: '9444039',
    call_sign: null,
    tags: ['tanker', 'pool'],
    open_alerts: 1,
    alert: null,
    worst: { deviation_deg: -6.8, compass_deg: 325, band95_deg: 0.8 },
    next_call: null,
    model: null,
    last_upload_at: '2026-11-27T10:00:00Z',
    position: null,
    due: { compass: 'c', on: '2026-12-01', urgency: 'soon', reason: '' },
  }) as unknown as FleetLine;

test('the file has a line for each vessel, and a name stays one field and no formula', () => {
  const [head, first, second] = fleetCsv([vessel('Ana, "La Bella"'), vessel('=1+1')]).split('\r\n');
  expect(head?.split(',')).toHaveLength(21);
  expect(first).toBe(
    '"Ana, ""La Bella""",9444039,,tanker pool,large_deviation,1,-6.8,325,0.8,,,2026-11-27T10:00:00Z,2026-12-01,soon,,,,,,,',
  );
  expect(second).toMatch(/^'=1\+1,/);
});

test('what is left out is kept in the browser, and what is unknown there is ignored', () => {
  const kept = new Map<string, string>();
  const store = {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, value: string) => void kept.set(key, value),
  };
  hideColumns(store, ['quality', 'upload']);
  expect(hiddenColumns(store)).toEqual(['quality', 'upload']);
  kept.set('binnacle.fleet.hidden', 'name,nothing,due');
  expect(hiddenColumns(store)).toEqual(['due']);
});
