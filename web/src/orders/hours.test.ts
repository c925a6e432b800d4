import { describe, expect, test } from 'vitest';
import { hoursFrom, readHours, writtenHours } from './hours';

const morning = {
  planned_at: '2026-12-08T07:00:00.000Z',
  planned_until: '2026-12-08T10:00:00.000Z',
};

describe('hours of a job', () => {
  test('are written and read in the port’s time', () => {
    const written = writtenHours(morning, 'Europe/Amsterdam');
    expect(written).toEqual({ from: '2026-12-08T08:00', until: '2026-12-08T11:00' });
    expect(readHours(written, 'Europe/Amsterdam')).toEqual(morning);
  });

  test('are in UTC where the port’s time is not known', () => {
    const written = writtenHours(morning, undefined);
    expect(written).toEqual({ from: '2026-12-08T07:00', until: '2026-12-08T10:00' });
    expect(readHours(written, undefined)).toEqual(morning);
  });

  test('end after they begin, within a day', () => {
    const read = (until: string) => readHours({ from: '2026-12-08T08:00', until }, undefined);
    expect(read('2026-12-08T08:00')).toBeNull();
    expect(read('2026-12-09T08:01')).toBeNull();
    expect(read('')).toBeNull();
    expect(read('2026-12-09T08:00')?.planned_until).toBe('2026-12-09T08:00:00.000Z');
  });

  test('are an hour shorter on the clock where it is put forward meanwhile', () => {
    const night = { from: '2026-03-29T01:00', until: '2026-03-29T05:00' };
    const read = readHours(night, 'Europe/Amsterdam');
    expect(read).toEqual({
      planned_at: '2026-03-29T00:00:00.000Z',
      planned_until: '2026-03-29T03:00:00.000Z',
    });
  });

  test('keep their length from another beginning', () => {
    const moved = hoursFrom('2026-12-09T09:00:00.000Z', morning);
    expect(moved.planned_until).toBe('2026-12-09T12:00:00.000Z');
    expect(hoursFrom('2026-12-09T09:00:00.000Z', undefined)).toEqual(moved);
  });
});
