import { describe, expect, test } from 'vitest';
import type { AdjustmentNeed, Alert, Vessel, WorkOrderSummary } from './api/types';
import { nowFor, type Asked } from './now';

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
    snoozed_until: null,
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

const known = (of: Partial<Asked>): Asked => ({
  vessel,
  alerts: [],
  needs: [],
  orders: [],
  now: new Date('2026-11-22T00:00:00Z'),
  writes: true,
  at: (instant) => instant,
  ...of,
});
const first = (of: Partial<Asked>) => nowFor(known(of)).ways[0]?.path;

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

  test('is not known while alerts, due dates or orders are missing', () => {
    for (const part of ['alerts', 'needs', 'orders']) {
      const now = nowFor(known({ [part]: undefined }));
      expect(now).toMatchObject({ tone: 'plain', title: 'Not known yet', ways: [] });
    }
  });

  test('leaves out an alert while it is snoozed, and says that there is one', () => {
    const snoozed = (until: string) => [
      { ...alert('drift', 'critical'), snoozed_until: until } as Alert,
    ];
    const now = nowFor(known({ alerts: snoozed('2026-11-23T00:00:00Z') }));
    expect(now.tone).toBe('good');
    expect(now.why).toMatch(/^One alert is snoozed\. No alert asks/);
    expect(nowFor(known({ alerts: snoozed('2026-11-21T00:00:00Z') })).tone).toBe('bad');
  });

  test('is to record the last adjustment where none is, without a date that moves each day', () => {
    const now = nowFor(known({ needs: [need('unknown')] }));
    expect(now).toMatchObject({ title: 'No adjustment on record', tone: 'plain' });
    expect(now.ways.map(({ path }) => path)).toEqual(['/start']);
    expect(first({ needs: [need('unknown'), need('overdue')] })).toMatch(/^\/work-orders\/new/);
  });

  test('offers no order to who may not write', () => {
    expect(first({ needs: [need('urgent')], writes: false })).toBe('/schedule#c');
  });
});
