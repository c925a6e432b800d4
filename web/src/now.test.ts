import { describe, expect, test } from 'vitest';
import type { AdjustmentNeed, Alert, Vessel, WorkOrderSummary } from './api/types';
import { nowFor, type Known } from './now';

const vessel = {
  id: 'v',
  compasses: [{ id: 'c' }],
  model: {},
  last_upload_at: '2026-11-20T00:00:00Z',
} as unknown as Vessel;
const alert = (cause: Alert['cause'], severity: Alert['severity']) =>
  ({
    id: 'a',
    vessel_id: 'v',
    compass_id: 'c',
    cause,
    severity,
    state: 'raised',
    since: '2026-11-19T00:00:00Z',
    advice: 'order an adjustment',
  }) as Alert;
const order = (state: string) =>
  ({ id: 'o', state, port: 'NLRTM', planned_at: '2026-12-01T08:00:00Z' }) as WorkOrderSummary;
const need = (urgency: AdjustmentNeed['urgency']) =>
  ({
    vessel_id: 'v',
    compass_id: 'c',
    due_on: '2026-11-01',
    urgency,
    reason: 'a year has passed',
  }) as AdjustmentNeed;

const known = (of: Partial<Known>): Known => ({
  vessel,
  alerts: [],
  needs: [],
  orders: [],
  writes: true,
  at: (instant) => instant,
  ...of,
});
const first = (of: Partial<Known>) => nowFor(known(of)).ways[0]?.path;

describe('what to do now', () => {
  test('after a strike is to order an adjustment, with the curves before and after beside it', () => {
    const now = nowFor(known({ alerts: [alert('lightning_or_shock', 'critical')] }));
    expect(now.tone).toBe('bad');
    expect(now.ways.map(({ path }) => path)).toEqual([
      '/work-orders/new?vessel=v&compass=c',
      '/vessels/v/changes?compass=c&change=2026-11-19T00%3A00%3A00Z#changes',
      '/alerts#a',
    ]);
  });

  test('is the open order once there is one, but not while the compass is at fault', () => {
    const alerts = [alert('lightning_or_shock', 'critical')];
    expect(first({ alerts, orders: [order('offered')] })).toBe('/work-orders/o');
    const faulty = [alert('compass_fault', 'critical')];
    expect(first({ alerts: faulty, orders: [order('offered')] })).toBe('/alerts#a');
    expect(first({ alerts, orders: [order('closed')] })).toMatch(/^\/work-orders\/new/);
  });

  test('is what is due, the agent that is missing, or nothing', () => {
    expect(nowFor(known({ needs: [need('overdue')] })).title).toMatch(/overdue since 1 Nov 2026/);
    expect(first({ vessel: { ...vessel, last_upload_at: null } })).toBe('/vessels/v/agent');
    const nothing = nowFor(known({ needs: [need('routine')] }));
    expect(nothing).toMatchObject({ tone: 'good', ways: [] });
  });

  test('offers no order to who may not write', () => {
    expect(first({ needs: [need('urgent')], writes: false })).toBe('/schedule#c');
  });
});
