import { describe, expect, test } from 'vitest';
import { aheadMs, dayAt, instantAt, isKnown, shownAt } from './zone';

const at = (text: string) => Date.parse(text);
const hoursAhead = (zone: string | number, text: string) =>
  (aheadMs(zone, at(text)) ?? Number.NaN) / 3_600_000;
const instant = (written: string, zone: string | number) => instantAt(written, zone).toISOString();

describe('a zone', () => {
  test('is as far ahead as its law says on that day', () => {
    for (const [zone, december, july] of [
      ['Pacific/Apia', 13, 13],
      ['Europe/Madrid', 1, 2],
      ['Atlantic/Azores', -1, 0],
      ['America/Anchorage', -9, -8],
      ['Asia/Kolkata', 5.5, 5.5],
      ['Australia/Adelaide', 10.5, 9.5],
      ['Pacific/Chatham', 13.75, 12.75],
      ['Etc/GMT-5', 5, 5],
    ] as const) {
      expect(hoursAhead(zone, '2026-12-01T00:00:00Z'), zone).toBe(december);
      expect(hoursAhead(zone, '2027-07-01T00:00:00.250Z'), zone).toBe(july);
    }
    expect(hoursAhead(-4, '2026-12-01T00:00:00Z')).toBe(-4);
  });

  test('is UTC, and known not to be known, where the browser has none of its name', () => {
    expect(isKnown('Europe/Atlantis')).toBe(false);
    expect(isKnown('Europe/Madrid')).toBe(true);
    expect(shownAt(at('2026-12-01T00:00:00Z'), 'Europe/Atlantis').toISOString()).toBe(
      '2026-12-01T00:00:00.000Z',
    );
  });

  test('has its own day on its side of the date line', () => {
    const noon = at('2026-12-08T12:00:00Z');
    expect(dayAt(noon, 'Pacific/Apia')).toBe('2026-12-09');
    expect(dayAt(noon, 'Pacific/Kiritimati')).toBe('2026-12-09');
    expect(dayAt(noon, 'Pacific/Pago_Pago')).toBe('2026-12-08');
    expect(dayAt(noon, -12)).toBe('2026-12-08');
  });
});

describe('a time that was written', () => {
  test('is the instant at which clocks show it', () => {
    expect(instant('2026-12-08T06:00', 9)).toBe('2026-12-07T21:00:00.000Z');
    expect(instant('2026-12-08T06:00', -4)).toBe('2026-12-08T10:00:00.000Z');
    expect(instant('2026-07-15T08:00', 'Europe/Madrid')).toBe('2026-07-15T06:00:00.000Z');
    expect(instant('2026-12-08T08:00', 'Europe/Madrid')).toBe('2026-12-08T07:00:00.000Z');
    expect(instant('2026-12-08T08:00', 'Pacific/Apia')).toBe('2026-12-07T19:00:00.000Z');
    expect(instant('2026-12-08T08:00', 'Asia/Kolkata')).toBe('2026-12-08T02:30:00.000Z');
  });

  test('is the first instant after it, where clocks skip it', () => {
    for (const skipped of ['2026-03-29T02:00', '2026-03-29T02:30', '2026-03-29T02:59']) {
      expect(instant(skipped, 'Europe/Madrid')).toBe('2026-03-29T01:00:00.000Z');
    }
    expect(instant('2026-03-29T01:59', 'Europe/Madrid')).toBe('2026-03-29T00:59:00.000Z');
    expect(instant('2026-03-29T03:00', 'Europe/Madrid')).toBe('2026-03-29T01:00:00.000Z');
  });

  test('is the first, where clocks show it twice', () => {
    expect(instant('2026-10-25T02:30', 'Europe/Madrid')).toBe('2026-10-25T00:30:00.000Z');
    expect(instant('2026-10-25T03:00', 'Europe/Madrid')).toBe('2026-10-25T02:00:00.000Z');
    expect(instant('2026-11-01T01:30', 'America/New_York')).toBe('2026-11-01T05:30:00.000Z');
  });

  test('is found again from every hour around a change of clocks', () => {
    for (const [zone, days] of [
      ['Europe/Madrid', ['2026-03-28', '2026-10-24']],
      ['Australia/Lord_Howe', ['2026-04-03', '2026-10-02']],
      ['America/St_Johns', ['2027-03-13', '2027-11-06']],
    ] as const) {
      for (let n = 0; n < days.length * 72; n += 1) {
        const atMs = at(`${days[Math.floor(n / 72)] ?? ''}T00:00:00Z`) + (n % 72) * 3_600_000;
        const found = instantAt(shownAt(atMs, zone).toISOString().slice(0, 16), zone).getTime();
        expect(atMs - found === 0 || (atMs > found && atMs - found <= 3_600_000)).toBe(true);
        expect(shownAt(found, zone)).toEqual(shownAt(atMs, zone));
      }
    }
  });
});
