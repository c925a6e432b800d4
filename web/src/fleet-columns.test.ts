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

test('each kind of reason has its word, and a call without a port name its code', () => {
  const due = { compass: 'c', on: '2026-12-01', urgency: 'overdue', reason: '', day: null };
  const all = {
    ...vessel('Nao'),
    alert: { id: 'a', severity: 'critical', cause: 'drift', summary: '', state: 'raised' },
    unoffered: due,
    waiting: { order: 'o', state: 'declined', from: '2026-12-01', urgency: 'urgent' },
    next_call: { port: 'NLRTM', port_name: '', eta: 'then', etd: 'later', worst: null },
  } as unknown as FleetLine;
  const [, line] = fleetCsv([all]).split('\r\n');
  const words = line?.split(',')[4]?.split(' ').sort();
  expect(words).toEqual(['adjustment_overdue', 'drift', 'large_deviation', 'order_declined']);
  expect(line).toContain(',NLRTM,then,later,');
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
