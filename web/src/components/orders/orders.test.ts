import { render } from 'svelte/server';
import { expect, test } from 'vitest';
import type { OrderVerification, PlanStep, WorkOrderSummary } from '../../api/types';
import OrderPanel from './OrderPanel.svelte';
import OrderTable from './OrderTable.svelte';
import Refusals from './Refusals.svelte';
import SeaPanel from './SeaPanel.svelte';
import StepCard from './StepCard.svelte';

/** What a reader without style sheets sees, in one line. */
const words = (rendered: { body: string }): string =>
  rendered.body
    .replace(/<!--.*?-->/gs, '')
    .replace(/<[^>]*>/g, ' ')
    .replace(/\s+/g, ' ')
    .trim();

const until = '2026-11-22T08:00:00Z';
const sea = (verification: OrderVerification['verification']) =>
  words(
    render(SeaPanel, {
      props: { verification: { verification, words: 'it is so', samples: 1200, until } },
    }),
  );

test('the proof at sea says how many headings are still needed, and which are best', () => {
  const needed = { count: 3, compass_deg: [45, 270] };
  const said = sea({ verdict: 'more_needed', headings: 5, needed });
  expect(said).toContain('3 more headings needed. 5 headings agree. Best of all on 045°, 270°.');
  expect(said).toContain('1 200 samples, the last of 22 Nov 2026, 08:00 UTC');
  const last = { count: 1, compass_deg: [] };
  expect(sea({ verdict: 'more_needed', headings: 1, needed: last })).toContain(
    '1 more heading needed. 1 heading agrees.',
  );
  expect(sea({ verdict: 'passed', headings: 8, band95_deg: 0.8, rms_deg: 0.4 })).toContain(
    'Verified: It is so.',
  );
  expect(sea({ verdict: 'alarm', compass_deg: 90, off_deg: 3, standard_error_deg: 0.5 })).toContain(
    'Not confirmed: It is so.',
  );
  expect(words(render(SeaPanel, { props: { verification: null } }))).toContain(
    'No settled heading has come in',
  );
});

test('a refusal says what it could be before what was found, and what would cure it', () => {
  const refusal = {
    refusal: 'inconsistent_berth',
    words: 'the field is 12 degrees off',
    could_be: ['the axes are swapped'],
    cures: ['read_again' as const],
  };
  const said = words(render(Refusals, { props: { refusals: [refusal] } }));
  expect(said).toBe(
    'Each of these alone would explain it: the axes are swapped What was found: the field is 12 degrees off. What would cure it: Read again: heading, axes and unit, and away from steel.',
  );
  const plain = words(render(Refusals, { props: { refusals: [{ ...refusal, could_be: [] }] } }));
  expect(plain).toMatch(/^The field is 12 degrees off\./);
});

test('a step says what to move, from where to where, and what the compass should then read', () => {
  const step: PlanStep = {
    number: 2,
    corrector: 'fore_and_aft',
    action: 'move',
    from: { place: 'magnets', hole: 5, magnet: '200 mm', count: 2, red: 'aft' },
    to: null,
    words: 'all of it',
    check: null,
    expected_compass_deg: 308.5,
    change_deg: -3.2,
    tolerance_deg: 1,
    seen: false,
    setting_before: {},
    setting_after: {},
  };
  const props = { step, count: 4, order: 'o', send: () => Promise.resolve() };
  const said = words(render(StepCard, { props: { ...props, compassDeg: 2 } }));
  expect(said).toContain('Step 2 of 4 Move Fore-and-aft magnets');
  expect(said).toContain('From hole 5 2 magnets, 200 mm red end AFT To out, to the spares');
  expect(said).toContain(
    'should then read 358.8° within 1.0° · it turns by 3.2°, to lower figures',
  );
  expect(said).toContain('On this heading the compass hardly shows this step');
  expect(said).not.toContain('before you move anything');
  const unread = words(render(StepCard, { props: { ...props, compassDeg: null } }));
  expect(unread).toContain('The compass reads now, before you move anything');
  expect(unread).toContain('308.5°');
});

const listed = (state: string): WorkOrderSummary =>
  ({
    id: 'o',
    vessel_name: 'Nao',
    compass_id: 'c',
    compass_name: 'Standard compass',
    state,
    port: 'Bilbao',
    berth: 'A5',
    planned_at: until,
    adjuster_name: null,
    firm: null,
  }) as WorkOrderSummary;

test('the list shows state, port and time, and that nobody is named yet', () => {
  const said = words(render(OrderTable, { props: { orders: [listed('waiting_for_tide')] } }));
  expect(said).toContain(
    'Nao Standard compass waiting for tide Bilbao, A5 22 Nov 2026, 08:00 UTC nobody named yet',
  );
});

test('a compass with an order under way offers no second one', () => {
  const props = { vessel: 'v', compass: 'c', writes: true };
  const busy = words(render(OrderPanel, { props: { ...props, orders: [listed('adjusting')] } }));
  expect(busy).not.toContain('Order an adjustment');
  const free = words(render(OrderPanel, { props: { ...props, orders: [listed('verified')] } }));
  expect(free).toContain('Order an adjustment');
  const viewer = { ...props, writes: false, orders: [] };
  expect(words(render(OrderPanel, { props: viewer }))).toBe('No adjustment is under way.');
});
