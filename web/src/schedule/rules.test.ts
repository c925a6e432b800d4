import { expect, test } from 'vitest';
import type { ScheduleSettings } from '../api/types';
import { fieldsOf, settingsOf } from './rules';

const settings = {
  horizon_days: 180,
  weights: {
    unmet_eur: { routine: 20000, soon: 30000 },
    late_eur_day: 500,
    late_days: null,
    job_h: 3,
  },
  terms: { urgent_days: 14 },
} as unknown as ScheduleSettings;

test('the schedule’s figures as fields, read again, are the same', () => {
  expect(settingsOf('180', fieldsOf(settings))).toEqual(settings);
});

test('hundredths of a degree are degrees in the form', () => {
  const counts = { horizon_days: 180, weights: {}, terms: { change_centideg: 29 } };
  const fields = fieldsOf(counts as unknown as ScheduleSettings);
  expect(fields).toMatchObject([{ name: 'change_centideg', value: '0.29' }]);
  expect(settingsOf('180', fields)).toEqual(counts);
});

test('a changed figure is changed and no other', () => {
  const fields = fieldsOf(settings).map((field) =>
    field.urgency === 'soon' ? { ...field, value: '31000.5' } : field,
  );
  expect(settingsOf('90', fields)).toEqual({
    ...settings,
    horizon_days: 90,
    weights: { ...settings.weights, unmet_eur: { routine: 20000, soon: 31000.5 } },
  });
});

test('what is no number is named', () => {
  const fields = fieldsOf(settings).map((field) =>
    field.name === 'job_h' ? { ...field, value: 'three' } : field,
  );
  expect(settingsOf('180', fields)).toMatchObject({ wrong: { name: 'job_h' } });
  expect(settingsOf(' ', fieldsOf(settings))).toEqual({ wrong: null });
});
