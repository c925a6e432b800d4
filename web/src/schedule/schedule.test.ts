import { describe, expect, test } from 'vitest';
import type { AdjustmentNeed, PlannedJob, PortCall, SchedulePlan } from '../api/types';
import { atX, shown, spanFrom, ticks, xOf } from './axis';
import { daysWith, inMonth, keyedDay, weeksOf } from './month';
import * as text from '../text';
import { callAt, daysOf, plannedFor, realChanges, rowsOf, unmetBy } from './plan';

const dayMs = 86_400_000;

describe('the days of a call', () => {
  const call = { eta: '2026-12-08T20:00:00Z', etd: '2026-12-10T02:00:00Z' };

  test('are the port’s days, not UTC’s', () => {
    expect(daysOf(call, 0)).toEqual(['2026-12-08', '2026-12-09', '2026-12-10']);
    expect(daysOf(call, 9)).toEqual(['2026-12-09', '2026-12-10']);
    expect(daysOf(call, -5)).toEqual(['2026-12-08', '2026-12-09']);
    expect(daysOf(call, 'Pacific/Apia')).toEqual(['2026-12-09', '2026-12-10']);
    const july = { eta: '2026-07-15T20:00:00Z', etd: '2026-07-15T22:30:00Z' };
    expect(daysOf(july, 'Europe/Madrid')).toEqual(['2026-07-15', '2026-07-16']);
  });

  test('are one where she comes and goes on the same day', () => {
    const short = { eta: '2026-12-08T01:00:00Z', etd: '2026-12-08T05:00:00Z' };
    expect(daysOf(short, 1)).toEqual(['2026-12-08']);
  });
});

describe('a job that is dropped', () => {
  const calls = [
    { id: 'a', eta: '2026-12-01T00:00:00Z', etd: '2026-12-02T00:00:00Z' },
    { id: 'b', eta: '2026-12-04T00:00:00Z', etd: '2026-12-05T00:00:00Z' },
  ];
  const at = (time: string, slackH = 0) => callAt(calls, Date.parse(time), slackH)?.id;

  test('belongs into the call in which it falls', () => {
    expect(at('2026-12-04T12:00:00Z')).toBe('b');
    expect(at('2026-12-03T00:00:00Z')).toBeUndefined();
  });

  test('beside a call belongs into the nearer one', () => {
    expect(at('2026-12-02T20:00:00Z', 24)).toBe('a');
    expect(at('2026-12-03T10:00:00Z', 24)).toBe('b');
    expect(at('2026-12-08T00:00:00Z', 24)).toBeUndefined();
  });
});

describe('the time line', () => {
  test('begins on a Monday before today', () => {
    const span = spanFrom(new Date('2026-11-22T15:00:00Z'), 28);
    expect(new Date(span.fromMs).toISOString()).toBe('2026-11-16T00:00:00.000Z');
    const onMonday = spanFrom(new Date('2026-11-23T00:30:00Z'), 28);
    expect(new Date(onMonday.fromMs).toISOString()).toBe('2026-11-16T00:00:00.000Z');
  });

  test('places an instant and finds it again', () => {
    const span = { fromMs: 0, days: 10 };
    expect(xOf(span, 5 * dayMs, 800)).toBe(400);
    expect(atX(span, 400, 800)).toBe(5 * dayMs);
  });

  test('cuts what reaches beyond it, and leaves out what lies beside it', () => {
    const span = { fromMs: 0, days: 10 };
    expect(shown(span, -dayMs, dayMs, 1000)).toEqual({ x: 0, width: 100 });
    expect(shown(span, 9 * dayMs, 20 * dayMs, 1000)).toEqual({ x: 900, width: 100 });
    expect(shown(span, 11 * dayMs, 12 * dayMs, 1000)).toBeNull();
  });

  test('writes fewer dates where there is less room', () => {
    const span = spanFrom(new Date('2026-11-22T00:00:00Z'), 182);
    expect(ticks(span, 2_000)).toHaveLength(26);
    expect(ticks(span, 320).length).toBeLessThanOrEqual(5);
  });
});

describe('the vessels of a plan', () => {
  const vessel = (name: string) => ({ vessel_id: name, vessel_name: name });
  const job = (name: string, day: string) =>
    ({ ...vessel(name), day, compasses: [{ compass_id: name }], state: 'offered' }) as PlannedJob;
  const plan = {
    jobs: [job('Late', '2026-12-20'), job('Early', '2026-12-01')],
    unscheduled: [{ ...vessel('Nowhere') }],
  } as unknown as SchedulePlan;
  const needs = [{ ...vessel('Due'), due_on: '2026-12-10', order: null } as AdjustmentNeed];
  const calls = [{ ...vessel('Calls') } as PortCall, { ...vessel('Late') } as PortCall];

  test('come in the order in which someone must think of them', () => {
    const rows = rowsOf(plan, needs, calls);
    expect(rows.map((row) => row.vesselName)).toEqual(['Nowhere', 'Early', 'Due', 'Late', 'Calls']);
    expect(rows.map((row) => row.met)).toEqual(['not', ...Array<string>(4).fill('in time')]);
  });

  test('that the plan has late are said to be late, not left out', () => {
    const late = {
      jobs: [{ ...job('Late', '2026-12-20'), late_days: 3 }, job('Early', '2026-12-01')],
      unscheduled: [
        { ...vessel('Late'), planned_late: true },
        { ...vessel('Nowhere'), planned_late: false },
      ],
    } as unknown as SchedulePlan;
    expect(rowsOf(late, [], []).map(({ vesselName, met }) => [vesselName, met])).toEqual([
      ['Nowhere', 'not'],
      ['Late', 'late'],
      ['Early', 'in time'],
    ]);
  });

  test('show an order that is being done, which the plan no longer holds', () => {
    const order = (id: string) => ({ id, state: 'on_board', from: '2026-12-01T08:00:00Z' });
    const need = (name: string) =>
      ({
        ...{ ...vessel(name), compass_id: name, due_on: '2026-12-10' },
        order: order(name),
      }) as AdjustmentNeed;
    const rows = rowsOf(plan, [need('Early'), need('On board')], []);
    const work = rows.flatMap((row) => row.work.map(({ vessel_name }) => vessel_name));
    expect(work).toEqual(['On board']);
  });

  test('are there without a plan', () => {
    expect(rowsOf(null, needs, calls).map((row) => row.vesselName)).toEqual([
      'Due',
      'Calls',
      'Late',
    ]);
  });
});

describe('what is planned for a compass', () => {
  const of = (...ids: string[]) => ({ compasses: ids.map((compass_id) => ({ compass_id })) });
  const plan = {
    jobs: [{ ...of('a', 'b'), day: '2026-12-01' }],
    unscheduled: [of('b'), of('c')],
  } as unknown as SchedulePlan;

  test('is its job, also where it is late, or why it has none', () => {
    expect(plannedFor(plan, 'b').job?.day).toBe('2026-12-01');
    expect(plannedFor(plan, 'b').unmet).toBeUndefined();
    expect(plannedFor(plan, 'c')).toEqual({ job: undefined, unmet: plan.unscheduled[1] });
    expect(plannedFor(plan, 'd')).toEqual({ job: undefined, unmet: undefined });
    expect(plannedFor(null, 'a')).toEqual({ job: undefined, unmet: undefined });
  });
});

describe('what a plan does not do in time', () => {
  const plan = (lateDays: number[], plannedLate: boolean[]) =>
    ({
      jobs: lateDays.map((late_days) => ({ late_days })),
      unscheduled: plannedLate.map((planned_late) => ({ planned_late })),
    }) as unknown as SchedulePlan;

  test('is what is not in it, and the jobs that are in it late, each once', () => {
    expect(unmetBy(plan([0, 0], []))).toEqual({ unscheduled: 0, late: 0 });
    expect(unmetBy(plan([3, 0, 9], [false, true]))).toEqual({ unscheduled: 1, late: 2 });
  });

  test('is said in words that tell the one from the other', () => {
    const { unmetWhich } = text.schedule.facts;
    expect(unmetWhich(1, 7)).toBe('1 not scheduled, 7 in the plan after their due dates');
    expect(unmetWhich(0, 0)).toBe('everything that is due is in the plan, in time');
  });
});

describe('what changed', () => {
  const job = (compass: string, day: string, pinned = false) =>
    ({
      compasses: [{ compass_id: compass }],
      call_id: 'c',
      firm_id: 'f',
      day,
      from: `${day}T08:00:00Z`,
      pinned,
    }) as PlannedJob;
  const change = (compass: string, what: string) =>
    ({ compasses: [{ compass_id: compass }], what }) as SchedulePlan['changes'][number];
  const plan = (jobs: PlannedJob[], changes: SchedulePlan['changes'] = []) =>
    ({ jobs, changes }) as unknown as SchedulePlan;

  test('is without what stayed, dropped jobs first', () => {
    const changes = ['kept', 'new', 'moved', 'dropped'].map((what) => change(what, what));
    const found = realChanges(null, plan([], changes));
    expect(found.map((line) => line.what)).toEqual(['dropped', 'moved', 'new']);
  });

  test('has a job that was pinned elsewhere, which the server calls kept', () => {
    const before = plan([job('a', '2026-12-01'), job('b', '2026-12-01')]);
    const now = [job('a', '2026-12-08', true), job('b', '2026-12-01')];
    const found = realChanges(before, plan(now, [change('a', 'kept'), change('b', 'kept')]));
    expect(found.map((line) => [line.what, line.from?.day, line.to?.day])).toEqual([
      ['moved', '2026-12-01', '2026-12-08'],
    ]);
  });

  test('has a job once, in the server’s words where it has them', () => {
    const told = { ...change('a', 'moved'), why: 'the call is cancelled' };
    const before = plan([job('a', '2026-12-01')]);
    const found = realChanges(before, plan([job('a', '2026-12-08')], [told]));
    expect(found).toEqual([told]);
  });
});

describe('the month', () => {
  test('has whole weeks from Monday on', () => {
    const weeks = weeksOf('2026-11');
    expect(weeks).toHaveLength(6);
    expect(weeks[0]?.[0]).toBe('2026-10-26');
    expect(weeks.at(-1)?.[0]).toBe('2026-11-30');
    expect(weeksOf('2027-02')).toHaveLength(4);
  });

  test('is walked by keys, by its last day where another month is shorter', () => {
    expect(keyedDay('2026-11-30', 'ArrowRight')).toBe('2026-12-01');
    expect(keyedDay('2026-11-22', 'ArrowUp')).toBe('2026-11-15');
    expect(keyedDay('2026-11-18', 'Home')).toBe('2026-11-16');
    expect(keyedDay('2026-11-22', 'End')).toBe('2026-11-22');
    expect(keyedDay('2026-11-22', 'Enter')).toBeNull();
    expect(inMonth('2027-01-31', 1)).toBe('2027-02-28');
    expect(inMonth('2026-12-15', 1)).toBe('2027-01-15');
    expect(inMonth('2027-01-15', -1)).toBe('2026-12-15');
  });

  test('has a call on each of its days, the first as an arrival, and only what falls into it', () => {
    const call = { id: 'c', eta: '2026-11-20T22:00:00Z', etd: '2026-11-22T03:00:00Z' } as PortCall;
    const long = { id: 'l', eta: '2026-10-01T00:00:00Z', etd: '2026-11-20T03:00:00Z' } as PortCall;
    const row = {
      calls: [call, long],
      needs: [{ due_on: '2026-11-21' }, { due_on: '2026-12-21' }] as AdjustmentNeed[],
      jobs: [{ day: '2026-11-22' }] as PlannedJob[],
      work: [{ order: { from: '2026-11-21T23:59:59Z' } }],
    };
    const found = daysWith([row as never], '2026-11-20', '2026-11-30');
    expect([...found.keys()].sort()).toEqual(['2026-11-20', '2026-11-21', '2026-11-22']);
    expect(found.get('2026-11-20')?.arriving).toEqual([call]);
    expect(found.get('2026-11-20')?.inPort).toEqual([long]);
    expect(found.get('2026-11-21')?.inPort).toEqual([call]);
    expect(found.get('2026-11-21')?.dues).toHaveLength(1);
    expect(found.get('2026-11-21')?.work).toHaveLength(1);
    expect(found.get('2026-11-22')?.jobs).toHaveLength(1);
  });
});
