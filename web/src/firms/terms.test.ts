import { describe, expect, test } from 'vitest';
import type { FirmTerms } from '../api/types';
import { readTerms, writtenAs } from './terms';

const terms: FirmTerms = {
  fee_eur: 1800,
  extra_compass_eur: 400,
  teams: 2,
  jobs_a_team_day: 1,
  first_hour: 7.5,
  last_hour: 18,
  lead_time_h: 72,
  working_days: ['Mon', 'Sat'],
  ports: [
    { port: 'NLRTM', travel_eur: 150 },
    { port: 'BEANR', travel_eur: 0 },
  ],
  flags: ['PA', 'NL'],
  licences: ['NL-114'],
  closed: ['2026-12-25'],
};

describe('a firm’s terms', () => {
  test('written in the form and read again are the same', () => {
    expect(readTerms(writtenAs(terms))).toEqual(terms);
  });

  test('begin with a working week and the hours that are usual', () => {
    expect(writtenAs(null)).toMatchObject({ fee: '', teams: '1', first: '8', last: '18' });
    expect(writtenAs(null).days).toEqual(['Mon', 'Tue', 'Wed', 'Thu', 'Fri']);
  });

  test('name the figure that is none', () => {
    expect(readTerms({ ...writtenAs(terms), fee: '' })).toEqual({ field: 'fee' });
    expect(readTerms({ ...writtenAs(terms), lead: '-3' })).toEqual({ field: 'lead' });
  });

  test('take a port with or without a space and travel, and name the line that is none', () => {
    const read = (ports: string) => readTerms({ ...writtenAs(terms), ports });
    expect(read('nl rtm 150\n\nBEANR')).toMatchObject({
      ports: [
        { port: 'NLRTM', travel_eur: 150 },
        { port: 'BEANR', travel_eur: 0 },
      ],
    });
    expect(read('NLRTM 150\nRotterdam 100')).toEqual({ line: 2 });
  });
});
