import { describe, expect, test } from 'vitest';
import type {
  BerthReading,
  PlanOffer,
  PlanStep,
  WorkOrder,
  WorkOrderEntry,
  WorkOrderSummary,
} from '../api/types';
import { againOf, faultAgain, newAgain } from './again';
import { ahead, expectedDeg, isAsExpected, offBy, wrapped } from './ahead';
import { lineOf } from './log';
import { callNeeds, inOrder, isOpen, stateName, whatNext } from './order';
import { correctorName, standing, written } from './places';
import {
  draftOf,
  fault,
  headingOf,
  horizontalNt,
  newReading,
  number,
  readingOf,
  sentDraft,
} from './reading';
import { feeInWords, feeOf, isFee, termsInWords } from './terms';
import { bearsOut, builtOn, isRefusal, nextToSend, type Content, type Write } from './writes';

const step = (number: number, change_deg: number, tolerance_deg = 1): PlanStep => ({
  number,
  corrector: 'athwartship',
  action: 'move',
  from: { place: 'magnets', hole: 7, magnet: '200 mm', count: 1, red: 'port' },
  to: { place: 'magnets', hole: 3, magnet: '200 mm', count: 1, red: 'port' },
  words: `step ${number}`,
  check: null,
  expected_compass_deg: 0,
  change_deg,
  tolerance_deg,
  seen: true,
  setting_before: {},
  setting_after: {},
});

const plan = (...steps: PlanStep[]) => ({ steps }) as PlanOffer['plans'][number];

const order = (over: Partial<WorkOrder>): WorkOrder =>
  ({
    id: 'o',
    state: 'adjusting',
    plan: { plan: plan(step(1, 5), step(2, -3)) },
    steps_done: 0,
    next_step: step(1, 5),
    compass_deg: 358,
    ...over,
  }) as WorkOrder;

let made = 0;
const write = (content: Content, over: Partial<Write> = {}): Write => ({
  seq: ++made,
  order: 'o',
  user: 'u',
  key: `k${made}`,
  at: '2026-11-22T08:00:00Z',
  content,
  ...over,
});
const read = (number: number, after_deg: number) =>
  write({ kind: 'step', number, body: { after_deg } });
const refused = { status: 409, kind: 'wrong-state', detail: 'no', refusals: [] };

describe('a step', () => {
  test('is judged across north, either way', () => {
    expect(wrapped(-358)).toBe(2);
    expect(wrapped(180)).toBe(180);
    expect(offBy(step(1, 5), 358, 3)).toBeCloseTo(0);
    expect(offBy(step(1, -5), 2, 357.5)).toBeCloseTo(0.5);
    expect(isAsExpected(step(1, 5), 358, 4)).toBe(true);
    expect(isAsExpected(step(1, 5), 358, 4.1)).toBe(false);
    expect(isAsExpected(step(1, 5), 358, 353)).toBe(false);
  });

  test('is expected from what the compass reads now, not from what was planned', () => {
    expect(expectedDeg(step(1, 5), 358)).toBe(3);
    expect(expectedDeg(step(1, -5), 2)).toBe(357);
    expect(expectedDeg({ ...step(1, 5), expected_compass_deg: 12 }, null)).toBe(12);
  });
});

describe('ahead of the server', () => {
  test('a step that read as expected is followed by the next', () => {
    const now = ahead(order({}), [read(1, 3.4)]);
    expect(now).toMatchObject({ stepsDone: 1, compassDeg: 3.4, waitingFor: null });
    expect(now.next?.number).toBe(2);
    expect(ahead(order({}), [read(1, 3.4), read(2, 0.2)])).toMatchObject({
      stepsDone: 2,
      next: null,
    });
  });

  test('a step that read otherwise waits for the server', () => {
    expect(ahead(order({}), [read(1, 10), read(2, 7)])).toMatchObject({
      stepsDone: 0,
      waitingFor: 'step',
    });
  });

  test('a step of another plan waits too', () => {
    expect(ahead(order({}), [read(2, 355)]).waitingFor).toBe('step');
  });

  test('a first step with no compass reading before it needs one', () => {
    const unread = order({ compass_deg: null });
    expect(ahead(unread, [read(1, 3)]).waitingFor).toBe('step');
    const both = write({ kind: 'step', number: 1, body: { before_deg: 358, after_deg: 3 } });
    expect(ahead(unread, [both])).toMatchObject({ stepsDone: 1, compassDeg: 3 });
  });

  test('a plan that was chosen is followed where the offer is at hand', () => {
    const measured = order({ state: 'measured', plan: null, next_step: null });
    const choice = write({ kind: 'plan', plan: 2 });
    const offer = { plans: [plan(step(1, 1)), plan(step(1, 9))] } as PlanOffer;
    expect(ahead(measured, [choice]).waitingFor).toBe('plan');
    const now = ahead(measured, [choice], offer);
    expect(now).toMatchObject({ state: 'adjusting', stepsDone: 0 });
    expect(now.next?.change_deg).toBe(9);
  });

  test('what was refused and what is of other orders counts for nothing', () => {
    const other = { ...read(1, 3), order: 'other' };
    expect(ahead(order({}), [{ ...read(1, 3), refused }, other]).stepsDone).toBe(0);
  });

  test('photographs and remarks hold nothing up', () => {
    const said = write({ kind: 'remark', text: 'crane' });
    expect(ahead(order({}), [said, read(1, 3)]).stepsDone).toBe(1);
  });
});

describe('the queue', () => {
  test('goes in order, past what was refused and what others wrote', () => {
    const [first, second] = [read(1, 3), read(2, 0)];
    expect(nextToSend([first, second], 'u')).toBe(first);
    expect(nextToSend([{ ...first, refused }, second], 'u')).toBe(second);
    expect(nextToSend([first], 'somebody else')).toBeUndefined();
  });

  test('holds what was built upon what did not hold, up to the next reading', () => {
    const failed = read(1, 10);
    const next = read(2, 7);
    const said = write({ kind: 'remark', text: 'crane' });
    const afresh = write({ kind: 'reading', body: {} as never });
    const later = write({ kind: 'plan', plan: 1 });
    expect(builtOn([failed, next, said, afresh, later], failed)).toEqual([next]);
    expect(builtOn([said, next], said)).toEqual([]);
  });

  test('takes a step as borne out only by the verdict', () => {
    const answered = (verdict: string) => ({ last_step: { verdict } }) as WorkOrder;
    expect(bearsOut(read(1, 3).content, answered('confirmed'))).toBe(true);
    expect(bearsOut(read(1, 3).content, answered('not_seen'))).toBe(true);
    expect(bearsOut(read(1, 3).content, answered('wrong_end'))).toBe(false);
    expect(bearsOut({ kind: 'remark', text: 'x' }, answered('wrong_end'))).toBe(true);
  });

  test('takes a second reading as borne out only where it confirms', () => {
    const again = write({ kind: 'second_reading', body: {} as never });
    const answered = (verdict: string) => ({ second_reading: { verdict } }) as WorkOrder;
    expect(bearsOut(again.content, answered('as_planned'))).toBe(true);
    for (const verdict of ['slip', 'replan', 'unexplained']) {
      expect(bearsOut(again.content, answered(verdict))).toBe(false);
    }
    const signed = write({ kind: 'completion', body: {} as never });
    expect(builtOn([again, signed], again)).toEqual([signed]);
    expect(ahead(order({}), [again]).waitingFor).toBe('second_reading');
  });

  test('tells a refusal from a fault on the way', () => {
    expect(isRefusal(409, 'wrong-state')).toBe(true);
    expect(isRefusal(422, 'not-adjustable')).toBe(true);
    for (const status of [0, 401, 408, 425, 429, 500, 502, 503]) {
      expect(isRefusal(status, 'x')).toBe(false);
    }
    // A portal's page in place of ours.
    expect(isRefusal(403, '')).toBe(false);
  });
});

describe('a reading', () => {
  const now = new Date('2026-11-22T08:20:00Z');
  const good = {
    ...newReading(now),
    lat: '43 21.0 N',
    lon: '003 02.4 W',
    heading: '312',
    forward: '17,2',
    starboard: '−14.9',
  };

  test('is made of what is typed, commas and true minus signs too', () => {
    expect(fault(good)).toBeNull();
    const reading = readingOf(good);
    expect(reading).toMatchObject({
      at: '2026-11-22T08:20:00.000Z',
      lat: 43.35,
      heading_true_deg: 312,
      forward: 17.2,
      starboard: -14.9,
      unit: 'microtesla',
    });
    expect(reading.lon).toBeCloseTo(-3.04);
    expect('down' in reading).toBe(false);
    expect('compass_deg' in reading).toBe(false);
    expect(readingOf({ ...good, down: '0', compass: '0' })).toMatchObject({
      down: 0,
      compass_deg: 0,
    });
  });

  test('names the first field that is wrong', () => {
    for (const [field, typed] of [
      ['at', ''],
      ['lat', '91 N'],
      ['lon', 'west'],
      ['heading', '361'],
      ['compass', 'north'],
      ['forward', ''],
      ['starboard', '1.2.3'],
      ['down', 'x'],
      ['heel', '31'],
      ['fieldSd', '0'],
    ] as const) {
      expect(fault({ ...good, [field]: typed })?.field).toBe(field);
    }
  });

  test('has its size in the unit that was chosen', () => {
    expect(horizontalNt(newReading(now))).toBeNull();
    const field = { ...good, forward: '3', starboard: '4' };
    expect(horizontalNt(field)).toBe(5000);
    expect(horizontalNt({ ...field, unit: 'gauss' })).toBe(500_000);
  });

  test('is read again from all that stays, but the field itself', () => {
    const again = draftOf({ ...readingOf(good), compass_deg: 310.5 }, now);
    expect(again).toMatchObject({ heading: '312', compass: '310.5', forward: '', starboard: '' });
    expect(readingOf({ ...again, forward: '1', starboard: '1' }).lon).toBeCloseTo(-3.04);
  });

  test('takes one on another heading whole, beside the first as it was sent', () => {
    const first = { ...readingOf(good), at: '2026-11-22T07:05:00Z' };
    const sent = sentDraft(first, now);
    expect(sent).toMatchObject({ forward: '17.2', starboard: '-14.9' });
    expect(readingOf(sent).at).toBe('2026-11-22T07:05:00.000Z');
    expect('shifted' in readingOf(sent)).toBe(false);
    const shifted = { ...sent, shiftedHeading: '72', shiftedForward: '14', shiftedStarboard: '-2' };
    expect(fault(shifted)).toBeNull();
    expect(readingOf(shifted).shifted).toEqual({
      heading_true_deg: 72,
      forward: 14,
      starboard: -2,
    });
    expect(fault({ ...shifted, shiftedForward: '' })?.field).toBe('shiftedForward');
    expect(fault({ ...shifted, shiftedHeading: '340' })?.field).toBe('shiftedHeading');
  });

  test('takes no half number and no heading beyond 360', () => {
    expect(number('12.')).toBe(12);
    expect(number('')).toBeNull();
    expect(number('1e3')).toBeNull();
    expect(headingOf('042.6°')).toBe(42.6);
    expect(headingOf('360')).toBe(360);
    expect(headingOf('-1')).toBeNull();
  });
});

describe('places', () => {
  test('say where, what, and the red end', () => {
    expect(written(step(1, 1).to, 'athwartship')).toEqual({
      where: 'hole 3',
      what: '1 magnet, 200 mm',
      red: 'red end to PORT',
    });
    expect(written(null, 'athwartship')).toBeNull();
    expect(
      written({ place: 'pair', size: '7 inch', mark_mm: 320, slew_deg: -10 }, 'quadrantal'),
    ).toEqual({
      where: 'mark 320 mm',
      what: '7 inch, slewed 10°, starboard one forward',
      red: '',
    });
    expect(correctorName(step(1, 1))).toBe('Athwartship magnets');
  });

  test('of all correctors are a line each, soft iron first', () => {
    const lines = standing({
      athwartship: [{ hole: 7, magnet: '200 mm', count: 2, red: 'starboard' }],
      flinders: { length_mm: 225, side: 'aft' },
      quadrantal: null,
    });
    expect(lines).toEqual([
      { corrector: 'Flinders bar', words: '225 mm, aft of the card' },
      {
        corrector: 'Athwartship magnets',
        words: 'hole 7, 2 magnets, 200 mm, red end to STARBOARD',
      },
    ]);
    expect(standing({})).toEqual([]);
  });
});

describe('orders', () => {
  test('that are open come first, the next one on top; then the last one that was done', () => {
    const listed = (id: string, state: string, planned_at: string) =>
      ({ id, state, planned_at }) as WorkOrderSummary;
    const all = [
      listed('old', 'closed', '2026-01-01'),
      listed('later', 'planned', '2026-12-02'),
      listed('newer', 'cancelled', '2026-02-01'),
      listed('sooner', 'adjusting', '2026-12-01'),
    ];
    expect(inOrder(all).map((one) => one.id)).toEqual(['sooner', 'later', 'newer', 'old']);
  });

  test('in a state that is new here have the server’s word for it, and are open', () => {
    expect(stateName('planned')).toBe('Planned');
    expect(stateName('waiting_for_tide')).toBe('waiting for tide');
    expect(isOpen('waiting_for_tide')).toBe(true);
    expect(isOpen('cancelled')).toBe(false);
  });
});

test('a fee is typed with a comma or a point, and told with its cents', () => {
  expect(feeOf(' 900,5 ')).toBe(900.5);
  expect(feeOf('')).toBeNull();
  expect(isFee('')).toBe(true);
  for (const wrong of ['a lot', '-1', '1000001']) expect(isFee(wrong), wrong).toBe(false);
  expect(feeInWords(1800)).toBe('€ 1\u202f800');
  expect(feeInWords(900.5)).toBe('€ 900.50');
  expect(feeInWords(0)).toBe('€ 0');
  expect(feeInWords(null)).toBe('');
  const terms = { planned_at: '2026-12-08T13:00:00Z', berth: 'A7', fee_eur: 900 };
  expect(termsInWords(terms)).toBe('8 Dec 2026, 13:00 UTC, A7, € 900');
  expect(termsInWords({ ...terms, planned_until: '2026-12-08T17:30:00Z' })).toBe(
    '8 Dec 2026, 13:00 to 17:30 UTC, A7, € 900',
  );
});

test('a call that moved asks for something only while the order is under way', () => {
  const moved = (call_fit: WorkOrderSummary['call_fit'], state: string) =>
    callNeeds({ call_fit, state } as WorkOrderSummary);
  expect(moved('needs_new_day', 'accepted')).toContain('new day');
  expect(moved('fits', 'accepted')).toBe('');
  expect(moved(null, 'accepted')).toBe('');
  expect(moved('no_call', 'cancelled')).toBe('');
});

describe('a reading after the steps', () => {
  const now = new Date('2026-11-22T10:05:00Z');
  const first = { unit: 'milligauss' } as BerthReading;
  const good = { ...newAgain(first, now), forward: '151', starboard: '−142,5' };

  test('is made of what is typed, in the first reading’s unit', () => {
    expect(faultAgain(good)).toBeNull();
    expect(againOf(good)).toEqual({
      at: '2026-11-22T10:05:00.000Z',
      forward: 151,
      starboard: -142.5,
      unit: 'milligauss',
    });
    const whole = againOf({ ...good, down: '369', compass: '312.5', heading: '40' });
    expect(whole).toMatchObject({ down: 369, compass_deg: 312.5, heading_true_deg: 40 });
    expect(newAgain(null, now).unit).toBe('microtesla');
  });

  test('names the field that is wrong', () => {
    expect(faultAgain({ ...good, forward: '' })?.field).toBe('forward');
    expect(faultAgain({ ...good, starboard: 'x' })?.field).toBe('starboard');
    expect(faultAgain({ ...good, down: 'x' })?.field).toBe('down');
    expect(faultAgain({ ...good, compass: '400' })?.field).toBe('compass');
    expect(faultAgain({ ...good, heading: '-1' })?.field).toBe('heading');
    expect(faultAgain({ ...good, at: '' })?.field).toBe('at');
  });
});

test('what comes next is said to the operator of a firm, and to the firm of itself', () => {
  expect(whatNext('offered')).toMatch(/^A firm was asked/);
  expect(whatNext('offered', 'firm')).toMatch(/^Your firm is asked/);
  expect(whatNext('verified', 'firm')).toBe(whatNext('verified'));
});

describe('a line of the log', () => {
  const line = (entry: unknown) => lineOf({ seq: 1, sha256: '', entry } as WorkOrderEntry);
  const said = (kind: string, content: unknown) =>
    line({ kind, at: '2026-11-22T08:00:00Z', author: { name: 'Ada' }, content });
  const maas = { firm_id: 'm', firm_name: 'Maas Compass' };

  test('names the firm that is asked, and those that the job is offered to', () => {
    expect(said('asked', { ...maas, fee_eur: 1800 }).title).toBe('Maas Compass was asked');
    expect(said('declined', maas).title).toBe('Maas Compass declined');
    expect(said('message', { ...maas, text: 'When?' })).toMatchObject({
      title: 'Message between the operator and Maas Compass',
      words: 'When?',
    });
    const firms = [maas, { firm_id: 'i', firm_name: 'Ibaizabal' }];
    expect(said('offered', { firms }).words).toBe('Maas Compass, Ibaizabal');
  });

  test('has a title where no firm is named, and says nothing of what is withheld', () => {
    expect(said('accepted', {}).title).toBe('A firm accepted');
    expect(said('something_new', {}).title).toBe('something new');
    expect(line({})).toEqual({
      at: null,
      author: null,
      title: 'Between the operator and others: not shown to your firm',
      words: '',
    });
  });
});
