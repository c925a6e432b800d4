import { describe, expect, test } from 'vitest';
import * as format from './format';

describe('angles', () => {
  test('deviation is written with its side, and east is positive', () => {
    expect(format.eastWest(3.44)).toBe('3.4° E');
    expect(format.eastWest(-3.44)).toBe('3.4° W');
  });

  test('what rounds to zero has neither side nor sign', () => {
    expect(format.eastWest(-0.04)).toBe('0.0°');
    expect(format.eastWest(0)).toBe('0.0°');
    expect(format.signed(-0.0004, 3)).toBe('0.000');
  });

  test('the unknown is a dash and never zero', () => {
    for (const missing of [null, undefined, NaN]) {
      expect(format.eastWest(missing)).toBe('–');
      expect(format.heading(missing)).toBe('–');
      expect(format.microtesla(missing)).toBe('–');
      expect(format.count(missing)).toBe('–');
    }
    expect(format.time('not a time')).toBe('–');
  });

  test('headings have three figures and north is 000', () => {
    expect(format.heading(5)).toBe('005°');
    expect(format.heading(359.7)).toBe('000°');
    expect(format.heading(-90)).toBe('270°');
    expect(format.fineHeading(41.62)).toBe('041.6°');
    expect(format.fineHeading(359.97)).toBe('000.0°');
  });

  test('the nearest compass point wraps at north', () => {
    expect(['N', 'NE', 'S', 'N']).toEqual([0, 45, 180, 355].map(format.compassPoint));
  });
});

describe('positions', () => {
  test('are in degrees and minutes with all four quadrants', () => {
    expect(format.position({ lat: 54.5, lon: 18.6667 })).toBe('54° 30.0′ N, 018° 40.0′ E');
    expect(format.position({ lat: -33.9, lon: -70.25 })).toBe('33° 54.0′ S, 070° 15.0′ W');
  });

  test('sixty minutes carry into the degree', () => {
    expect(format.latitude(53.9999)).toBe('54° 00.0′ N');
  });

  test('are read as officers write them', () => {
    expect(format.parseAngle('54.5', 'lat')).toBe(54.5);
    expect(format.parseAngle('-54.5', 'lat')).toBe(-54.5);
    expect(format.parseAngle('−54.5', 'lat')).toBe(-54.5);
    expect(format.parseAngle('54 30 N', 'lat')).toBe(54.5);
    expect(format.parseAngle("54°30'S", 'lat')).toBe(-54.5);
    expect(format.parseAngle('018° 40.2′ W', 'lon')).toBeCloseTo(-18.67, 9);
    expect(format.parseAngle('018°40\'12"E', 'lon')).toBeCloseTo(18.67, 9);
  });

  test('what cannot be a position is refused', () => {
    for (const wrong of [
      '',
      'north',
      '95',
      '54 61 N',
      '54.5 E',
      '-54 S',
      '*54',
      ')54',
      '5 5 5 5',
    ]) {
      expect(format.parseAngle(wrong, 'lat'), wrong).toBeNull();
    }
    expect(format.parseAngle('181', 'lon')).toBeNull();
    expect(format.parseAngle('18 N', 'lon')).toBeNull();
  });

  test('every written position reads back as itself', () => {
    for (const lat of [-90, -33.9, -0.005, 0, 0.5, 89.995]) {
      expect(format.parseAngle(format.latitude(lat), 'lat')).toBeCloseTo(lat, 2);
    }
  });
});

describe('times where a ship is', () => {
  const at = '2026-11-14T23:30:00Z';

  test('are UTC’s, hers, or both, with the day where it is another one there', () => {
    expect(format.atSea(at, 2, 'utc')).toBe('14 Nov 2026, 23:30 UTC');
    expect(format.atSea(at, 2, 'ship')).toBe('15 Nov 2026, 01:30 UTC+2');
    expect(format.atSea(at, 2, 'both')).toBe('14 Nov 2026, 23:30 UTC (15 Nov, 01:30 UTC+2)');
    expect(format.atSea(at, -5, 'both')).toBe('14 Nov 2026, 23:30 UTC (18:30 UTC−5)');
  });

  test('are UTC’s where her clocks are not known or show the same', () => {
    expect(format.atSea(at, undefined, 'ship')).toBe('14 Nov 2026, 23:30 UTC');
    expect(format.atSea(at, 0, 'both')).toBe('14 Nov 2026, 23:30 UTC');
    expect(format.atSea(null, 3, 'both')).toBe('–');
  });
});

describe('hours of a job', () => {
  const [from, until] = ['2026-12-08T07:00:00Z', '2026-12-08T10:00:00Z'];

  test('are UTC’s, the port’s, or both', () => {
    expect(format.hoursAtSea(from, until, 1, 'utc')).toBe('8 Dec 2026, 07:00 to 10:00 UTC');
    expect(format.hoursAtSea(from, until, 1, 'ship')).toBe('8 Dec 2026, 08:00 to 11:00 UTC+1');
    expect(format.hoursAtSea(from, until, 1, 'both')).toBe(
      '8 Dec 2026, 07:00 to 10:00 UTC (08:00 to 11:00 UTC+1)',
    );
    expect(format.hoursAtSea(from, until, undefined, 'both')).toBe(
      '8 Dec 2026, 07:00 to 10:00 UTC',
    );
  });

  test('name each day where it is another one', () => {
    expect(format.hoursAtSea(from, until, 15, 'both')).toBe(
      '8 Dec 2026, 07:00 to 10:00 UTC (22:00 to 9 Dec 2026, 01:00 UTC+15)',
    );
    expect(format.hoursAtSea(from, until, -8, 'both')).toBe(
      '8 Dec 2026, 07:00 to 10:00 UTC (7 Dec 2026, 23:00 to 8 Dec 2026, 02:00 UTC−8)',
    );
  });

  test('are a beginning alone where no end is known', () => {
    expect(format.hoursAtSea(from, null, undefined, 'both')).toBe('8 Dec 2026, 07:00 UTC');
  });
});

describe('times and counts', () => {
  test('times are UTC whatever the zone of the reader', () => {
    expect(format.time('2026-11-14T08:30:59Z')).toBe('14 Nov 2026, 08:30 UTC');
    expect(format.time('2026-11-14T01:30:00+02:00')).toBe('13 Nov 2026, 23:30 UTC');
  });

  test('ages are rounded down to what still matters', () => {
    const now = new Date('2026-11-14T12:00:00Z');
    expect(format.ago('2026-11-14T11:59:30Z', now)).toBe('just now');
    expect(format.ago('2026-11-14T11:48:00Z', now)).toBe('12 min ago');
    expect(format.ago('2026-11-14T08:30:00Z', now)).toBe('3 h ago');
    expect(format.ago('2026-11-09T08:30:00Z', now)).toBe('5 days ago');
  });

  test('counts, shares and fields are short', () => {
    expect(format.count(12480)).toBe('12\u202f480');
    expect(format.percent(1, 1000)).toBe('< 1 %');
    expect(format.percent(64, 100)).toBe('64 %');
    expect(format.percent(0, 0)).toBe('–');
    expect(format.microtesla(-24_130)).toBe('−24.1\u00a0µT');
  });
});

test('the server’s words have their instants and days as they are written here', () => {
  for (const [words, written] of [
    [
      'call 2026-11-21T07:00:00Z to 2026-11-22T07:30:12.5Z',
      'call 21 Nov 2026, 07:00 UTC to 22 Nov 2026, 07:30 UTC',
    ],
    ['since 2026-10-30 12:46 UTC they agree', 'since 30 Oct 2026, 12:46 UTC they agree'],
    ['about 2026-10-12\n  03:00 UTC', 'about 12 Oct 2026, 03:00 UTC'],
    [
      'due 2026-11-21, a Saturday (by 2026-11-23).',
      'due 21 Nov 2026, a Saturday (by 23 Nov 2026).',
    ],
    ['free on 2026-11-21–2026-11-24', 'free on 21 Nov 2026–24 Nov 2026'],
  ] as const)
    expect(format.dated(words)).toBe(written);
});

test('what is no day in the server’s words stays', () => {
  for (const words of [
    'ISO 25862:2019, Annex G',
    'Marine Notice 19/2016',
    'order WO-2026-11-21 and 2026-11-21-b, file 2026-11-21.pdf, /reports/2026-11-21',
    '2026-02-31 and 2026-13-01',
    '01a207db-8d7b-7526-853d-a49b4e42311f',
    'headings 015-240, IMO 9299733, 2026-11',
    'signed 2026-11-21T07:00:00+02:00 and 2026-11-21T25:61:00Z',
  ])
    expect(format.dated(words)).toBe(words);
});

test('instants in a sentence are by the reader’s clocks, days are as they are', () => {
  const there = (instant: string) => format.atSea(instant, 2, 'ship');
  expect(format.sentence('due 2026-11-23: since 2026-11-21 23:30 UTC', there)).toBe(
    'Due 23 Nov 2026: since 22 Nov 2026, 01:30 UTC+2.',
  );
});

test('a server’s clause becomes a sentence, with true minus signs', () => {
  expect(format.sentence('it began at sea')).toBe('It began at sea.');
  expect(format.sentence('Is it? ')).toBe('Is it?');
  expect(format.sentence('compass less gyro is -3.7°')).toBe('Compass less gyro is −3.7°.');
  expect(format.sentence('since 2026-11-23, in 015-240')).toBe('Since 23 Nov 2026, in 015-240.');
});

test('a count beyond what there is room for says that it is more', () => {
  expect(format.atMost(99, 99)).toBe('99');
  expect(format.atMost(1033, 99)).toBe('99+');
});

test('a figure is written as it was typed, with a true minus', () => {
  expect(format.typed(-17.43)).toBe('−17.43');
  expect(format.typed(22.05)).toBe('22.05');
  expect(format.typed(0)).toBe('0');
});
