import { describe, expect, test } from 'vitest';
import type { FirmTeam, FirmTerms, FirmWithTerms } from '../api/types';
import { candidates, type Job } from './serving';

const now = new Date('2026-12-01T00:00:00Z');
/** A Tuesday, ten o'clock on board. */
const job: Job = {
  port: 'NLRTM',
  at: '2026-12-08T10:00:00Z',
  hours: 3,
  zone: 0,
  flag: 'PA',
  licence: null,
};
const firm = (name: string, terms: Partial<FirmTerms> | null, problems: string[] = []) =>
  ({
    firm_id: name,
    firm_name: name,
    terms: terms && { fee_eur: 1800, ports: [{ port: 'NLRTM', travel_eur: 100 }], ...terms },
    teams: [],
    problems,
  }) as FirmWithTerms;
const against = (terms: Partial<FirmTerms> | null, asked: Partial<Job> = {}) =>
  candidates([firm('one', terms)], { ...job, ...asked }, now).others[0]?.against ?? [];

describe('firms for a job', () => {
  test('are first those that can do it, the cheapest with travel before', () => {
    const { able, others } = candidates(
      [
        firm('elsewhere', { fee_eur: 1, ports: [{ port: 'BEANR' }] }),
        firm('dear', { ports: [{ port: 'NLRTM', travel_eur: 900 }] }),
        firm('cheap', {}),
        firm('unknown', null),
      ],
      job,
      now,
    );
    expect(able.map(({ name, fee }) => [name, fee])).toEqual([
      ['cheap', 1900],
      ['dear', 2700],
    ]);
    expect(others.map(({ name }) => name)).toEqual(['elsewhere', 'unknown']);
  });

  test('that cannot say why', () => {
    expect(against(null)).toEqual(['No terms are said.']);
    expect(against({ ports: [] })).toEqual(['Does not serve this port.']);
    expect(against({ flags: ['NL'] })).toEqual(['Is not accepted by the flag PA.']);
    expect(against({}, { licence: 'NL-114' })).toEqual(['Does not hold the licence NL-114.']);
    expect(against({ closed: ['2026-12-08'] })).toEqual(['Is closed on that day.']);
    expect(against({ working_days: ['Mon'] })).toEqual(['Does not work on a Tuesday.']);
    expect(against({ lead_time_h: 240 })).toEqual(['Asks for 240 h of notice.']);
  });

  test('work in the port’s time', () => {
    expect(against({}, { zone: 9 })).toEqual(['Works from 08:00 to 18:00 the port’s time.']);
    expect(against({ first_hour: 9.5 }, { zone: -1 })).toEqual([
      'Works from 09:30 to 18:00 the port’s time.',
    ]);
    expect(against({}, { at: '2026-12-04T20:00:00Z', zone: 12 })).toEqual([
      'Does not work on a Saturday.',
    ]);
  });

  test('end their work in time', () => {
    expect(against({ last_hour: 13 })).toEqual([]);
    expect(against({ last_hour: 12.5 })).toEqual(['Works from 08:00 to 12:30 the port’s time.']);
  });

  test('can do it if one of their teams can', () => {
    const late = { name: 'late', first_hour: 12 };
    const elsewhere = { name: 'elsewhere', ports: ['BEANR'] };
    const able = (teams: FirmTeam[]) =>
      candidates([{ ...firm('one', {}), teams }], job, now).others[0]?.against ?? [];
    expect(able([late])).toEqual(['Works from 12:00 to 18:00 the port’s time.']);
    expect(able([elsewhere])).toEqual(['Does not serve this port.']);
    expect(able([late, elsewhere, { name: 'any' }])).toEqual([]);
  });

  test('are not judged by hours and days where the port’s time is not known', () => {
    const night = { at: '2026-12-06T02:00:00Z', zone: undefined };
    expect(against({ closed: ['2026-12-06'] }, { ...night, zone: 0 })).toHaveLength(3);
    expect(against({ closed: ['2026-12-06'] }, night)).toEqual([]);
    expect(against({ lead_time_h: 240 }, night)).toEqual(['Asks for 240 h of notice.']);
  });

  test('are told what the schedule finds wrong with their terms', () => {
    const { others } = candidates([firm('one', {}, ['working_days: none'])], job, now);
    expect(others[0]?.against).toEqual(['working_days: none']);
  });

  test('are not left out for what nobody knows', () => {
    expect(
      against({ flags: ['NL'], ports: [] }, { port: undefined, at: null, flag: null }),
    ).toEqual([]);
  });
});
