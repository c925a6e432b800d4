import { describe, expect, test } from 'vitest';
import type { AdjustmentNeed, FleetVessel } from './api/types';
import { checklist, isLive, sharedNumbers } from './checklist';

const vessel = (name: string, more: Partial<FleetVessel> = {}) =>
  ({
    ...{ id: name, name, imo_number: null, last_upload_at: null, model: null, next_call: null },
    ...more,
  }) as FleetVessel;
const need = (vessel_id: string, adjusted_on: string | null, compass_name = 'Standard') =>
  ({
    ...{ vessel_id, compass_id: `${vessel_id} ${compass_name}`, compass_name },
    adjusted_on,
    not_known: ['trade'],
  }) as unknown as AdjustmentNeed;
const call = { port: 'NLRTM' } as FleetVessel['next_call'];
const model = { version: 1 } as FleetVessel['model'];

describe('the checklist', () => {
  test('says of a vessel just entered that everything is left to do', () => {
    const [nao] = checklist([vessel('Nao')], [need('Nao', null)]);
    expect(nao).toEqual({
      ...{ id: 'Nao', name: 'Nao', missing: 1, agent: false, model: false, call: false },
      compasses: [{ id: 'Nao Standard', name: 'Standard', adjusted: null }],
    });
    expect(nao && isLive(nao)).toBe(false);
  });

  test('ends when it is measured, its last adjustment is known and it has a port call', () => {
    const sailing = vessel('Nao', {
      last_upload_at: '2026-11-22T05:00:00Z',
      model,
      next_call: call,
    });
    const live = (adjusted: string | null) =>
      checklist([sailing], [need('Nao', adjusted)]).map(isLive);
    expect(live('2025-03-01')).toEqual([true]);
    expect(live(null)).toEqual([false]);
  });

  test('asks for each compass, and counts a fact of the vessel once', () => {
    const needs = [need('Nao', '2025-03-01', 'Steering'), need('Nao', null, 'Standard')];
    const [nao] = checklist([vessel('Nao')], needs);
    expect(nao?.compasses.map(({ name, adjusted }) => [name, adjusted])).toEqual([
      ['Standard', null],
      ['Steering', '2025-03-01'],
    ]);
    expect(nao?.missing).toBe(1);
  });

  test('does not call complete what no rule has asked for yet', () => {
    expect(checklist([vessel('Nao')], [])).toMatchObject([{ compasses: [], missing: null }]);
  });
});

test('vessels with one IMO number are named', () => {
  const fleet = [
    vessel('A', { imo_number: '9074729' }),
    vessel('B', { imo_number: '9074729' }),
    vessel('C', { imo_number: '9211561' }),
    vessel('D'),
    vessel('E'),
  ];
  expect(sharedNumbers(fleet)).toEqual([['9074729', ['A', 'B']]]);
});
