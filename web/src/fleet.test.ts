import { describe, expect, it } from 'vitest';
import type {
  AdjustmentNeed,
  FleetVessel,
  PlannedJob,
  SchedulePlan,
  Urgency,
  WorkOrderState,
} from './api/types';
import { pressing, reasonsOf, settledBy, withDues, worstAhead } from './attention';
import {
  arranged,
  countsOf,
  fromSearch,
  longestSilentFirst,
  quality,
  sortedBy,
  tagsOf,
  toSearch,
  usual,
  withNews,
} from './fleet';
import { withView } from './views';

const now = new Date('2026-11-22T06:00:00Z');

function vessel(name: string, more: Partial<FleetVessel> = {}): FleetVessel {
  return {
    id: name,
    name,
    imo_number: null,
    call_sign: null,
    last_upload_at: '2026-11-22T05:00:00Z',
    position: null,
    track: [],
    interference: [],
    tags: [],
    model: { version: 1, rms_deg: 0.4, data_until: '2026-11-22T04:00:00Z', cautions: 0 },
    worst: { compass_deg: 90, deviation_deg: 2, band95_deg: 0.5 },
    open_alerts: 0,
    next_call: null,
    alert: null,
    ...more,
  };
}

const alert = (severity: 'notice' | 'warning' | 'critical', state: 'raised' | 'acknowledged') => ({
  alert: { id: 'a', cause: 'drift', severity, state, summary: 'It drifts.' } as const,
  open_alerts: state === 'raised' ? 1 : 0,
});

const fleet = [
  vessel('Anna', { call_sign: 'EAVN' }),
  vessel('Berta', { ...alert('warning', 'raised'), imo_number: '9074729' }),
  vessel('Carl', {
    ...alert('critical', 'acknowledged'),
    worst: { compass_deg: 0, deviation_deg: -7, band95_deg: 2 },
  }),
  vessel('Dora', { model: null, worst: null, last_upload_at: null }),
];

const names = (query: Partial<typeof usual>) =>
  arranged(fleet, { ...usual, ...query }, now).map(({ name }) => name);

describe('the fleet', () => {
  it('begins with who needs someone most', () => {
    expect(names({})).toEqual(['Carl', 'Berta', 'Anna', 'Dora']);
    expect(pressing(vessel('x', alert('warning', 'raised')))).toBeGreaterThan(
      pressing(vessel('x', alert('warning', 'acknowledged'))),
    );
  });

  it('is searched by name, number and call sign, all words at once', () => {
    expect(names({ search: 'eavn' })).toEqual(['Anna']);
    expect(names({ search: '9074 ber' })).toEqual(['Berta']);
    expect(names({ search: 'anna berta' })).toEqual([]);
  });

  it('is counted by what the search and the tag find', () => {
    const tagged = [vessel('Anna', { tags: ['reefer'] }), vessel('Anja'), vessel('Berta')];
    const all = (query: Partial<typeof usual>) =>
      countsOf(tagged, { ...usual, filter: 'silent', ...query }, now).all;
    expect(all({})).toBe(3);
    expect(all({ search: 'an' })).toBe(2);
    expect(all({ search: 'an', tag: 'reefer' })).toBe(1);
  });

  it('is searched without accents and capitals, on either side', () => {
    const ships = [
      vessel('Östersjön'),
      vessel('Baía de Santos'),
      vessel('Søløven'),
      vessel('Fjord'),
    ];
    const found = (search: string) =>
      arranged(ships, { ...usual, search }, now).map(({ name }) => name);
    expect(found('ostersjon')).toEqual(['Östersjön']);
    expect(found('ÖSTERSJÖN')).toEqual(['Östersjön']);
    expect(found('baia')).toEqual(['Baía de Santos']);
    expect(found('solov')).toEqual(['Søløven']);
    expect(found('fjörd')).toEqual(['Fjord']);
  });

  it('is filtered', () => {
    expect(names({ filter: 'attention' })).toEqual(['Carl', 'Berta']);
    expect(names({ filter: 'unacknowledged' })).toEqual(['Berta']);
    expect(names({ filter: 'large' })).toEqual(['Carl']);
    expect(names({ filter: 'weak' })).toEqual(['Dora']);
    expect(names({ filter: 'silent' })).toEqual(['Dora']);
  });

  it('is sorted by each column, and back', () => {
    expect(names({ sort: 'name', reversed: true })[0]).toBe('Dora');
    expect(names({ sort: 'worst' })).toEqual(['Carl', 'Anna', 'Berta', 'Dora']);
    expect(names({ sort: 'quality' })[0]).toBe('Dora');
    expect(names({ sort: 'upload' })[0]).toBe('Dora');
    expect(sortedBy(sortedBy(usual, 'name'), 'name')).toMatchObject({ reversed: true });
    expect(sortedBy({ ...usual, reversed: true }, 'name').reversed).toBe(false);
  });

  it('looks ahead to the next port, where the deviation may be larger', () => {
    const worst = { compass_deg: 10, deviation_deg: -5.5, band95_deg: 0.8 };
    const next_call = {
      port: 'FIHEL',
      port_name: 'Helsinki',
      eta: '2026-11-24T06:00:00Z',
      etd: '2026-11-25T06:00:00Z',
      worst,
    };
    expect(worstAhead(vessel('x', { next_call }))).toEqual({ worst, port: 'Helsinki' });
    expect(worstAhead(vessel('x'))).toMatchObject({ port: null });
    const small = { ...next_call, worst: { ...worst, deviation_deg: 1 } };
    expect(worstAhead(vessel('x', { next_call: small }))).toMatchObject({ port: null });
    const calls = [vessel('late', { next_call }), vessel('never'), vessel('soon')];
    calls[2] = vessel('soon', { next_call: { ...next_call, eta: '2026-11-23T06:00:00Z' } });
    const order = arranged(calls, { ...usual, sort: 'call' }, now).map(({ name }) => name);
    expect(order).toEqual(['soon', 'late', 'never']);
  });

  it('knows a firm model from a weak one', () => {
    const band = (band95_deg: number | null) => ({
      worst: { compass_deg: 0, deviation_deg: 3, band95_deg },
    });
    expect(quality(vessel('x', band(0.9)))).toBe('firm');
    expect(quality(vessel('x', band(2)))).toBe('fair');
    expect(quality(vessel('x', band(3.1)))).toBe('weak');
    expect(quality(vessel('x', band(null)))).toBe('weak');
    expect(quality(vessel('x', { model: null }))).toBe('none');
  });

  it('takes news of one vessel without asking for the others', () => {
    const later = vessel('Anna', { open_alerts: 3 });
    expect(withNews(fleet, 'Anna', later)[0]).toBe(later);
    expect(withNews(fleet, 'Anna', undefined).length).toBe(3);
    expect(withNews(fleet, 'Emil', vessel('Emil')).length).toBe(5);
  });
});

describe('a view', () => {
  it('stands in the address bar and comes back from it', () => {
    const query = {
      ...usual,
      search: 'nao',
      filter: 'silent',
      sort: 'worst',
      reversed: true,
    } as const;
    expect(fromSearch(toSearch(query))).toEqual(query);
    expect(toSearch(usual)).toBe('');
    expect(fromSearch('?show=nonsense&sort=x')).toEqual(usual);
  });

  it('replaces a saved view of the same name', () => {
    const one = withView([], { name: 'Mine', search: '?q=a' });
    const two = withView(withView(one, { name: 'All', search: '' }), {
      name: 'Mine',
      search: '?q=b',
    });
    expect(two).toEqual([
      { name: 'All', search: '' },
      { name: 'Mine', search: '?q=b' },
    ]);
  });

  it('asks for the vessels with a tag, and keeps it in the address', () => {
    const tagged = [vessel('A', { tags: ['tanker'] }), vessel('B', { tags: ['ferry', 'tanker'] })];
    const query = { ...usual, tag: 'ferry' };
    expect(arranged(tagged, query, now).map(({ name }) => name)).toEqual(['B']);
    expect(fromSearch(toSearch(query))).toEqual(query);
    expect(tagsOf(tagged)).toEqual(['ferry', 'tanker']);
  });
});

describe('what is due next', () => {
  const need = (vessel_id: string, due_on: string) =>
    ({ vessel_id, due_on, urgency: 'soon', reason: 'r', order: null }) as AdjustmentNeed;

  it('is the first of her needs, and puts the earliest first and the unknown last', () => {
    const vessels = ['A', 'B', 'C'].map((id) => ({ id, name: id }) as FleetVessel);
    const needs = [need('B', '2027-01-01'), need('A', '2027-03-01'), need('B', '2026-12-01')];
    const lines = withDues(vessels, needs, null);
    expect(lines.map((line) => line.due?.on)).toEqual(['2027-03-01', '2026-12-01', undefined]);
    const sorted = arranged(lines, { ...usual, sort: 'due' }, new Date());
    expect(sorted.map((line) => line.name)).toEqual(['B', 'A', 'C']);
  });
});

describe('who needs someone', () => {
  const need = (vessel_id: string, urgency: Urgency, more: Partial<AdjustmentNeed> = {}) =>
    ({
      ...{ vessel_id, compass_id: vessel_id, due_on: '2026-11-23', urgency },
      ...{ reason: 'r', order: null, ...more },
    }) as AdjustmentNeed;
  const order = (state: WorkOrderState): Pick<AdjustmentNeed, 'order'> => ({
    order: {
      ...{ id: `order-${state}`, state, port: 'NLRTM' },
      ...{ from: '2026-11-28T08:00:00Z', until: '2026-11-28T11:00:00Z' },
    },
  });
  const job = (compass_id: string) =>
    ({ compasses: [{ compass_id }], day: '2026-11-28', state: 'proposed' }) as PlannedJob;
  const large = { compass_deg: 55, deviation_deg: 5.8, band95_deg: 0.7 };
  const ships = [
    vessel('Acknowledged', alert('warning', 'acknowledged')),
    vessel('Calm'),
    vessel('Large', { worst: large }),
    vessel('Never'),
    vessel('Offered'),
    vessel('On board'),
    vessel('Planned'),
    vessel('Proposed'),
    vessel('Raised', alert('warning', 'raised')),
    vessel('Soon'),
    vessel('Unplanned'),
  ];
  const needs = [
    need('Calm', 'routine'),
    need('Never', 'unknown'),
    need('Offered', 'overdue', order('offered')),
    need('On board', 'overdue', order('on_board')),
    need('Planned', 'overdue'),
    need('Proposed', 'routine', order('proposed')),
    need('Soon', 'soon'),
    need('Unplanned', 'overdue'),
  ];
  const jobs = [job('Planned')];
  const lines = withDues(ships, needs, { jobs } as unknown as SchedulePlan);
  const of = (name: string) => {
    const found = lines.find((line) => line.name === name);
    if (!found) throw new Error(name);
    return found;
  };

  it('is a ship with an alert, an adjustment not in hand, or a large deviation: today’s first', () => {
    const asked = { ...usual, filter: 'attention' } as const;
    expect(arranged(lines, asked, now).map(({ name }) => name)).toEqual([
      'Raised',
      'Planned',
      'Unplanned',
      'Large',
      'Acknowledged',
      'Proposed',
      'Soon',
      'Never',
    ]);
    // All of them stand before who needs nobody.
    const all = arranged(lines, usual, now).map(({ name }) => name);
    expect(all.slice(-3)).toEqual(['Calm', 'Offered', 'On board']);
  });

  it('says why', () => {
    const due = { kind: 'due', urgency: 'overdue', on: '2026-11-23' };
    expect(reasonsOf(of('Unplanned'))).toMatchObject([{ ...due, day: null }]);
    expect(reasonsOf(of('Planned'))).toMatchObject([{ ...due, day: '2026-11-28' }]);
    expect(reasonsOf(of('Large'))).toEqual([{ kind: 'deviation', port: null }]);
    expect(reasonsOf(of('Offered'))).toEqual([]);
    expect(of('Offered').inHand).toMatchObject({ order: 'order-offered', state: 'offered' });
    expect(reasonsOf(of('Never'))).toMatchObject([{ kind: 'due', urgency: 'unknown' }]);
    expect(reasonsOf(of('Proposed'))).toMatchObject([{ kind: 'order', state: 'proposed' }]);
  });

  it('keeps the cause of an alert that somebody acknowledged', () => {
    const cause = { kind: 'alert', cause: 'drift', known: true };
    expect(reasonsOf(of('Acknowledged'))).toMatchObject([cause]);
  });

  it('takes a vessel with the adjuster on board to be in hand, however late it is', () => {
    expect(reasonsOf(of('On board'))).toEqual([]);
    expect(of('On board').inHand).toMatchObject({ state: 'on_board' });
  });

  it('takes only what is due of the compass in hand to be settled', () => {
    const steering = { ...need('Nao', 'overdue'), compass_id: 'steering' };
    const standard = { ...need('Nao', 'soon', order('offered')), compass_id: 'standard' };
    const late = { ...standard, due_on: '2027-06-01' };
    const settled = (needs: AdjustmentNeed[]) =>
      withDues([vessel('Nao')], needs, null).map(settledBy);
    expect(settled([steering, late])).toEqual([undefined]);
    expect(settled([standard])).toEqual(['offered']);
  });

  it('lets a new need stand beside an adjustment that is done', () => {
    const again = [need('Offered', 'urgent', order('adjusted'))];
    const [line] = withDues([vessel('Offered')], again, null);
    expect(line?.inHand).toMatchObject({ state: 'adjusted' });
    expect(line && settledBy(line)).toBeUndefined();
    expect(line && reasonsOf(line)).toMatchObject([{ kind: 'due', urgency: 'urgent' }]);
  });

  it('counts the other alerts, and names a large deviation once', () => {
    const over = {
      alert: {
        id: 'a',
        cause: 'deviation_over_limit',
        severity: 'critical',
        state: 'raised',
        summary: 's',
      },
      open_alerts: 3,
      worst: large,
    } as const;
    expect(reasonsOf(vessel('x', over))).toMatchObject([{ kind: 'alert', id: 'a', more: 2 }]);
  });

  it('looks at each of her compasses', () => {
    const [line] = withDues(
      [vessel('Offered')],
      [
        need('Offered', 'overdue', order('offered')),
        need('Offered', 'urgent', { compass_id: 'steering' }),
      ],
      { jobs } as unknown as SchedulePlan,
    );
    expect(line && reasonsOf(line)).toMatchObject([{ kind: 'due', urgency: 'urgent', day: null }]);
  });
});

it('puts who never sent anything first, then who has been silent longest', () => {
  const sent = (name: string, last_upload_at: string | null) => ({ name, last_upload_at });
  const vessels = [
    sent('Lately', '2026-11-23T10:00:00Z'),
    sent('Never B', null),
    sent('Silent', '2026-11-01T10:00:00+02:00'),
    sent('Never A', null),
  ];
  expect(longestSilentFirst(vessels).map(({ name }) => name)).toEqual([
    'Never A',
    'Never B',
    'Silent',
    'Lately',
  ]);
});
