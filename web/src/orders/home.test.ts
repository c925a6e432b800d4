import { describe, expect, test } from 'vitest';
import type { WorkOrderSummary } from '../api/types';
import { grouped } from './home';

const now = new Date(2026, 10, 22, 9, 0);
const order = (id: string, state: string, planned: Date, completed_at: string | null = null) =>
  ({ id, state, planned_at: planned.toISOString(), completed_at }) as WorkOrderSummary;
const ids = (orders: WorkOrderSummary[]) => orders.map((one) => one.id);

describe('an adjuster’s orders', () => {
  test('are today’s where the day is this one, was before, or someone is on board', () => {
    const groups = grouped(
      [
        order('tonight', 'accepted', new Date(2026, 10, 22, 23, 0)),
        order('tomorrow', 'accepted', new Date(2026, 10, 23, 0, 30)),
        order('yesterday', 'planned', new Date(2026, 10, 21, 9, 0)),
        order('begun', 'adjusting', new Date(2026, 10, 25, 9, 0)),
      ],
      now,
    );
    expect(ids(groups.today)).toEqual(['yesterday', 'tonight', 'begun']);
    expect(ids(groups.coming)).toEqual(['tomorrow']);
  });

  test('that are offered wait for an answer, whatever their day', () => {
    const groups = grouped([order('asked', 'offered', new Date(2026, 10, 22, 12, 0))], now);
    expect(ids(groups.answer)).toEqual(['asked']);
    expect(groups.today).toEqual([]);
  });

  test('that are completed are done, the latest first', () => {
    const groups = grouped(
      [
        order('older', 'closed', new Date(2026, 9, 1)),
        order('newer', 'adjusted', new Date(2026, 10, 1), '2026-11-01T12:00:00Z'),
      ],
      now,
    );
    expect(ids(groups.done)).toEqual(['newer', 'older']);
  });
});
