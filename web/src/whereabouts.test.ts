import { describe, expect, test } from 'vitest';
import type { FleetVessel, PortCall, SampleDots } from './api/types';
import { atSea } from './format';
import { fromTo, whereabouts, whereNow, withoutItsDay } from './whereabouts';

const dots = {
  unix_s: [Date.parse('2026-11-01T00:00:00Z') / 1000, Date.parse('2026-11-03T00:00:00Z') / 1000],
  lon: [-8.4, -31.2],
} as SampleDots;
const call = (eta: string, etd: string, withdrawn_at: string | null = null) =>
  ({ eta, etd, port: 'NLRTM', withdrawn_at }) as PortCall;

describe('where she was', () => {
  test('is where the nearest sample was taken, before or after', () => {
    const where = whereabouts(dots, []);
    expect(where('2026-11-01T23:59:00Z')).toEqual({ lon: -8.4 });
    expect(where('2026-11-02T00:01:00Z')).toEqual({ lon: -31.2 });
    expect(where('2026-10-31T00:00:00Z')).toEqual({ lon: -8.4 });
    expect(where('2026-11-04T00:00:00Z')).toEqual({ lon: -31.2 });
  });

  test('is not known more than two days from any sample', () => {
    const where = whereabouts(dots, []);
    expect(where('2026-10-29T23:59:00Z')).toBeNull();
    expect(where('2026-11-05T00:01:00Z')).toBeNull();
    expect(whereabouts(undefined, [])('2026-11-01T00:00:00Z')).toBeNull();
  });

  test('is the port while she calls there, unless the call was withdrawn', () => {
    const span = ['2026-11-02T00:00:00Z', '2026-11-02T12:00:00Z'] as const;
    const port = whereabouts(dots, [call(...span)]);
    expect(port('2026-11-02T12:00:00Z')).toEqual({ port: 'NLRTM' });
    expect(port('2026-11-02T12:01:00Z')).toEqual({ lon: -31.2 });
    expect(whereabouts(dots, [call(...span, span[0])])(span[1])).toEqual({ lon: -31.2 });
  });

  test('is now the port that she lies in, or where she was last', () => {
    const position = { lat: 43, lon: -8, at: '2026-11-01T00:00:00Z' };
    const next_call = { port: 'ESBIO', eta: '2026-11-02T00:00:00Z', etd: '2026-11-03T00:00:00Z' };
    const vessel = { position, next_call } as FleetVessel;
    expect(whereNow(vessel, new Date('2026-11-01T12:00:00Z'))).toBe(position);
    expect(whereNow(vessel, new Date('2026-11-02T12:00:00Z'))).toEqual({ port: 'ESBIO' });
    expect(whereNow(undefined, new Date())).toBeNull();
  });
});

describe('a stretch of time', () => {
  const [morning, noon, next] = [
    '2026-11-14T08:30:00Z',
    '2026-11-14T12:00:00Z',
    '2026-11-15T01:00:00Z',
  ];

  test('says a day and a zone once', () => {
    const span = (to: string, clocks: 'utc' | 'ship' | 'both') =>
      fromTo(atSea(morning, 2, clocks), atSea(to, 2, clocks));
    expect(span(noon, 'utc')).toBe('14 Nov 2026, 08:30 – 12:00 UTC');
    expect(span(next, 'utc')).toBe('14 Nov 2026, 08:30 – 15 Nov 2026, 01:00 UTC');
    expect(span(noon, 'ship')).toBe('14 Nov 2026, 10:30 – 14:00 UTC+2');
    expect(span(noon, 'both')).toBe(
      '14 Nov 2026, 08:30 UTC (10:30 UTC+2) – 12:00 UTC (14:00 UTC+2)',
    );
  });

  test('says both zones where she went into another', () => {
    expect(fromTo(atSea(morning, 2, 'ship'), atSea(noon, 1, 'ship'))).toBe(
      '14 Nov 2026, 10:30 UTC+2 – 13:00 UTC+1',
    );
  });

  test('says the day again where it is another', () => {
    expect(withoutItsDay('15 Nov 2026, 01:00 UTC', '14 Nov 2026, 08:30 UTC')).toBe(
      '15 Nov 2026, 01:00 UTC',
    );
  });
});
