import { describe, expect, test } from 'vitest';
import type { PortCall } from '../api/types';
import type { Zone } from '../zone';
import { beside, bestBegin, callsAhead } from './calls';

const call = (id: string, eta: string, etd: string, withdrawn_at: string | null = null) =>
  ({ id, eta, etd, withdrawn_at }) as PortCall;
const now = new Date('2026-12-01T10:20:00Z');
const begin = (eta: string, etd: string, zone: Zone = 0) =>
  bestBegin({ eta, etd }, zone, now).toISOString();

describe('the calls of an order', () => {
  test('are those that are not over, the next one first', () => {
    const calls = [
      call('later', '2026-12-20T06:00:00Z', '2026-12-21T06:00:00Z'),
      call('over', '2026-11-20T06:00:00Z', '2026-11-21T06:00:00Z'),
      call('off', '2026-12-05T06:00:00Z', '2026-12-06T06:00:00Z', '2026-11-30T00:00:00Z'),
      call('alongside', '2026-11-30T06:00:00Z', '2026-12-02T06:00:00Z'),
    ];
    expect(callsAhead(calls, now).map(({ id }) => id)).toEqual(['alongside', 'later']);
  });

  test('begin in working hours of the port’s time', () => {
    expect(begin('2026-12-08T03:00:00Z', '2026-12-09T18:00:00Z')).toBe('2026-12-08T08:00:00.000Z');
    expect(begin('2026-12-08T03:00:00Z', '2026-12-09T18:00:00Z', 8)).toBe(
      '2026-12-08T03:00:00.000Z',
    );
    expect(begin('2026-12-08T22:30:00Z', '2026-12-10T18:00:00Z', -5)).toBe(
      '2026-12-09T13:00:00.000Z',
    );
    // Vigo's eight o'clock in December, and the day after clocks went back.
    const vigo = 'Europe/Madrid';
    expect(begin('2026-12-08T03:00:00Z', '2026-12-09T18:00:00Z', vigo)).toBe(
      '2026-12-08T07:00:00.000Z',
    );
    expect(begin('2027-07-08T03:00:00Z', '2027-07-09T18:00:00Z', vigo)).toBe(
      '2027-07-08T06:00:00.000Z',
    );
    expect(begin('2027-10-30T18:00:00Z', '2027-11-02T18:00:00Z', vigo)).toBe(
      '2027-10-31T07:00:00.000Z',
    );
  });

  test('begin when she comes, as long as the port’s time is not known', () => {
    const call = { eta: '2026-12-08T02:30:00Z', etd: '2026-12-09T18:00:00Z' };
    expect(bestBegin(call, undefined, now).toISOString()).toBe('2026-12-08T03:00:00.000Z');
  });

  test('begin when she comes, where she leaves before anybody works', () => {
    expect(begin('2026-12-08T20:10:00Z', '2026-12-09T04:00:00Z')).toBe('2026-12-08T21:00:00.000Z');
  });

  test('begin at the next full hour, where she is alongside', () => {
    expect(begin('2026-11-30T06:00:00Z', '2026-12-02T06:00:00Z')).toBe('2026-12-01T11:00:00.000Z');
  });

  test('hold a time, or it lies before or after', () => {
    const at = { eta: '2026-12-08T06:00:00Z', etd: '2026-12-09T06:00:00Z' };
    expect(beside(at, '2026-12-08T06:00:00Z')).toBeUndefined();
    expect(beside(at, '2026-12-08T05:59:00Z')).toBe('before');
    expect(beside(at, '2026-12-09T06:01:00Z')).toBe('after');
  });
});
