import { render } from 'svelte/server';
import { expect, test } from 'vitest';
import type {
  AdjustmentNeed,
  Alert,
  FleetVessel,
  SchedulePlan,
  WorkOrderSummary,
} from '../api/types';
import NeedsPanel from './NeedsPanel.svelte';
import { words } from './testing';

const alert = (id: string, severity: Alert['severity']) =>
  ({ id, severity, cause: 'reported_aboard' }) as Alert;
const need = (due_on: string, urgency: AdjustmentNeed['urgency']) =>
  ({ due_on, urgency, reason: `because of ${due_on}` }) as AdjustmentNeed;
const glance = {
  next_call: {
    ...{ port: 'PECLL', port_name: 'Callao' },
    ...{ eta: '2026-11-27T12:00:00Z', etd: '2026-11-30T12:00:00Z' },
    worst: { compass_deg: 255, deviation_deg: 0.93, band95_deg: 1 },
  },
} as FleetVessel;
const order = (id: string, state: string) =>
  ({
    id,
    state,
    port: 'PEPAI',
    berth: null,
    planned_at: '2026-11-23T13:00:00Z',
  }) as WorkOrderSummary;

test('what she needs is told with the ways there: alerts, what is due, her next call, her order', () => {
  const rendered = render(NeedsPanel, {
    props: {
      alerts: [alert('x', 'critical'), alert('y', 'warning'), alert('z', 'notice')],
      needs: [need('2027-05-01', 'routine'), need('2026-12-01', 'urgent')],
      glance,
      orders: [order('open', 'adjusted'), order('done', 'closed')],
    },
  });
  const shown = words(rendered);
  expect(shown).toMatch(/Open alerts Critical .* Warning .* and 1 more/);
  expect(shown).toContain('1 Dec 2026');
  expect(shown).not.toContain('1 May 2027');
  expect(shown).toContain('Callao 27 Nov 2026, 12:00');
  expect(shown).toContain('up to 0.9° E there, on 255°');
  expect(rendered.body).toContain('href="/alerts#x"');
  expect(rendered.body).toContain('href="/work-orders/open"');
  expect(rendered.body).not.toContain('href="/work-orders/done"');
});

test('what is proposed for her is told where it is due, or that nothing could be', () => {
  const of = { compasses: [{ compass_id: 'c' }] };
  const job = {
    ...of,
    ...{ day: '2026-11-28', port_name: 'Callao', firm_name: 'Maas Compass', state: 'proposed' },
  };
  const shown = (plan: object, orders: WorkOrderSummary[] = []) =>
    render(NeedsPanel, {
      props: {
        alerts: [],
        needs: [{ ...need('2026-12-01', 'urgent'), compass_id: 'c' }],
        glance: undefined,
        orders,
        plan: plan as SchedulePlan,
      },
    });
  const proposed = shown({ jobs: [job], unscheduled: [] });
  expect(words(proposed)).toContain('Proposed: 28 Nov 2026, Callao, Maas Compass');
  expect(proposed.body).toContain('href="/schedule#c"');
  const nowhere = shown({ jobs: [], unscheduled: [of] });
  expect(words(nowhere)).toContain('Not scheduled: why');
  expect(words(shown({ jobs: [], unscheduled: [] }))).toContain('Schedule');
  // An order that is under way is further on than any proposal.
  const ordered = shown({ jobs: [job], unscheduled: [] }, [order('open', 'agreed')]);
  expect(words(ordered)).not.toContain('Proposed');
});

test('what has not come yet is said to be not known', () => {
  const none = { alerts: undefined, needs: undefined, glance: undefined, orders: undefined };
  const shown = words(render(NeedsPanel, { props: none }));
  const unknown = 'not known yet';
  expect(shown).toBe(
    `Open alerts ${unknown} Next adjustment due ${unknown} Next port call ${unknown} Work order ${unknown}`,
  );
  const empty = { alerts: [], needs: [], glance: { next_call: null } as FleetVessel, orders: [] };
  expect(words(render(NeedsPanel, { props: empty }))).toBe(
    'Open alerts none Next adjustment due nothing is due Next port call none is known Work order none is open',
  );
});
