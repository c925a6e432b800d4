import { describe, expect, test } from 'vitest';
import type { WorkOrder, WorkOrderSummary } from '../api/types';
import { grouped, isToKeep, onDevice } from './home';
import type { Kept } from './shelf';
import type { Write } from './writes';

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

describe('what is kept on the device', () => {
  const kept = (id: string, user: string, last_seq = 3): Kept => ({
    id,
    user,
    order: { id, state: 'accepted', plan: null, steps_done: 0, last_seq } as WorkOrder,
    offeredFor: '',
    at: '2026-11-22T08:00:00Z',
  });
  const boarded = {
    order: 'a',
    content: { kind: 'on_board', at: '2026-11-22T09:00:00Z' },
  } as Write;

  test('is the reader’s own, and stands as it was left', () => {
    const shown = onDevice([kept('a', 'me'), kept('b', 'me'), kept('c', 'other')], [boarded], 'me');
    expect(shown.map(({ order: { id, state }, waiting }) => [id, state, waiting])).toEqual([
      ['a', 'on_board', 1],
      ['b', 'accepted', 0],
    ]);
    expect(shown[0]?.at).toBe('2026-11-22T08:00:00Z');
    expect(onDevice([kept('a', 'me')], [], undefined)).toEqual([]);
  });

  test('is fetched anew when the server has more, or it was kept for another', () => {
    const now = { id: 'a', last_seq: 4 } as WorkOrderSummary;
    expect(isToKeep(now, [kept('a', 'me', 4)], 'me')).toBe(false);
    expect(isToKeep(now, [kept('a', 'me', 3)], 'me')).toBe(true);
    expect(isToKeep(now, [kept('a', 'other', 4)], 'me')).toBe(true);
    expect(isToKeep(now, [], 'me')).toBe(true);
  });
});
