import { expect, test } from 'vitest';
import type { Field } from './rules';
import { figureOf, movedTo, placeOf, positioned } from './sliders';

const weight = (name: string, value: string, urgency: string | null = null): Field => ({
  ...{ part: 'weights', name, urgency, value },
});
const fields = [
  weight('unmet_eur', '20000', 'routine'),
  weight('unmet_eur', '60000', 'overdue'),
  weight('late_eur_day', '500'),
  weight('early_eur_day', '3'),
  weight('changed_eur', '150'),
  weight('withdrawn_eur', '500'),
  weight('job_h', '3'),
];
const values = (of: readonly Field[]) => of.map(({ value }) => value);

test('the usual figures stand in the middle', () => {
  expect(placeOf(fields, 'cost')).toBe(2);
  expect(placeOf(fields, 'punctuality')).toBe(2);
  expect(placeOf(fields, 'stability')).toBe(2);
});

test('a slider moves its figures in their ratio, and no other', () => {
  const punctual = movedTo(fields, 'punctuality', 3);
  expect(values(punctual)).toEqual(['40000', '120000', '1000', '3', '150', '500', '3']);
  expect(placeOf(punctual, 'punctuality')).toBe(3);
  const stable = movedTo(fields, 'stability', 0);
  expect(values(stable).slice(4)).toEqual(['37.5', '125', '3']);
  // And back again.
  expect(values(movedTo(punctual, 'punctuality', 2))).toEqual(values(fields));
});

test('a figure that is no number or nothing does not break the slider', () => {
  const odd = [weight('late_eur_day', '0'), weight('unmet_eur', 'many', 'soon')];
  expect(figureOf([weight('late_eur_day', 'x')], 'punctuality')).toBeUndefined();
  expect(values(movedTo(odd, 'punctuality', 4))).toEqual(['2000', 'many']);
});

test('the way back undoes the way there, past the largest figure and past cents', () => {
  const typed = [
    weight('late_eur_day', '125'),
    weight('unmet_eur', '100000', 'overdue'),
    weight('waiting_eur_day', '0.07'),
    weight('changed_eur', '150'),
  ];
  const far = positioned(typed, { punctuality: 4, stability: 0 });
  expect(values(far)).toEqual(['2000', '1000000', '1.12', '37.5']);
  expect(values(positioned(typed, { punctuality: 0, stability: 2 }))).toEqual(values(typed));
  // Each event from the last one's figures would not come back.
  expect(values(movedTo(far, 'punctuality', 0))).not.toEqual(values(typed));
});
