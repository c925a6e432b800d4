import { expect, test } from 'vitest';
import type { PortCall } from '../api/types';
import { amendmentOf, writtenOf } from './calls';

const call = {
  eta: '2026-11-28T06:00:42Z',
  etd: '2026-11-29T18:30:07Z',
  berth: 'Waalhaven 4',
} as PortCall;
const zone = 'Europe/Amsterdam';
const opened = writtenOf(call, zone);

test('a form is in the port’s time, to the minute', () => {
  expect(opened).toEqual({
    eta: '2026-11-28T07:00',
    etd: '2026-11-29T19:30',
    berth: 'Waalhaven 4',
  });
  expect(writtenOf({ ...call, berth: null }, 0).berth).toBe('');
});

test('only what was amended is sent', () => {
  expect(amendmentOf(opened, { ...opened }, zone)).toEqual({});
  expect(amendmentOf(opened, { ...opened, berth: ' 5 ' }, zone)).toEqual({ berth: '5' });
  expect(amendmentOf(opened, { ...opened, berth: '' }, zone)).toEqual({ berth: null });
  expect(amendmentOf(opened, { ...opened, etd: '2026-11-30T00:00' }, zone)).toEqual({
    etd: '2026-11-29T23:00:00.000Z',
  });
});
