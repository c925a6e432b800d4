import { expect, test } from 'vitest';
import type { FleetVessel } from './api/types';
import { matching, mostFound, portItems, tabItems, vesselItems } from './finder';

const vessel = (id: string, name: string, port?: string) =>
  ({
    id,
    name,
    imo_number: '9462378',
    call_sign: 'SEOJ',
    next_call: port
      ? { port, port_name: 'Rotterdam', eta: '2026-11-28T06:00:00Z', etd: '2026-11-29T06:00:00Z' }
      : null,
  }) as FleetVessel;

const fleet = [vessel('a', 'Nuevo Östersjön'), vessel('b', 'Östersjön', 'NLRTM')];
const labels = (query: string) =>
  matching([...vesselItems(fleet), ...portItems(fleet), ...tabItems(fleet)], query).map(
    ({ label }) => label,
  );

test('a name is found without its accents, one that begins so before others', () => {
  expect(labels('ostersjon').slice(0, 2)).toEqual(['Östersjön', 'Östersjön: Deviation']);
  expect(labels('ostersjon')).toContain('Nuevo Östersjön');
  expect(labels('no such')).toEqual([]);
});

test('numbers, codes of ports and a vessel with one of its tabs are found', () => {
  expect(labels('9462378')).toHaveLength(2);
  expect(labels('nlrtm')).toEqual(['Rotterdam']);
  expect(labels('nuevo changes')).toEqual(['Nuevo Östersjön: Changes']);
});

test('no more are listed than are read at a glance', () => {
  const many = Array.from({ length: 40 }, (_, i) => vessel(String(i), `Ship ${i}`));
  expect(matching(vesselItems(many), 'ship')).toHaveLength(mostFound);
});
