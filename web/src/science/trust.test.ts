import { readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import type { Caution, Model, Prior, References, Refusal } from '../api/types';
import { band95, standardError, widestBand } from './band';
import { goodRanges, magneticLatitudeOf, watersOf, worstWaters, type Waters } from './reach';
import { refusalWords } from './refusal';
import {
  cautionWords,
  dropped,
  elsewhere,
  here,
  predictions,
  references,
  startedFrom,
  worth,
} from './trust';

/** The page that says what a model is, with a worked example. */
const page = readFileSync(new URL('../../../docs/model.md', import.meta.url), 'utf8');
const example = JSON.parse(page.split('```json')[1]?.split('```')[0] ?? '') as Model;
const biscay = { h_nt: 24_000, z_nt: 38_500 };
const cape = { h_nt: 12_000, z_nt: -25_000 };

describe('the band', () => {
  test('is as the worked example of a model has it, at both places', () => {
    const heading = '| compass | deviation, Biscay | band | deviation, Cape | band |\n';
    const rows = (page.split(heading)[1] ?? '')
      .split('\n')
      .slice(1)
      .filter((line) => line.startsWith('|'))
      .map((line) => line.split('|').map((cell) => Number(cell)));
    expect(rows).toHaveLength(8);
    for (const [, compass = NaN, , atBiscay = NaN, , atCape = NaN] of rows) {
      expect(band95(example, compass, biscay)?.toFixed(2)).toBe(atBiscay.toFixed(2));
      expect(band95(example, compass, cape)?.toFixed(2)).toBe(atCape.toFixed(2));
    }
    expect(band95(example, 120, biscay)).toBeCloseTo(0.845, 3);
  });

  test('is widest where what is not known acts most', () => {
    const there = widestBand(example, cape);
    expect([85, 90, 95, 265, 270, 275]).toContain(there?.compass_deg);
    expect(there?.band95_deg).toBeCloseTo(6.28, 1);
  });

  test('is none without a covariance, and where headings are ambiguous', () => {
    expect(band95({ ...example, covariance: null }, 0, biscay)).toBeNull();
    expect(widestBand({ ...example, covariance: null }, biscay)).toBeNull();
    expect(widestBand(example, { h_nt: 1_500, z_nt: 58_000 })).toBeNull();
    expect(standardError([[-1]], [1])).toBeNull();
  });
});

describe('what a model started from', () => {
  const atLarge: Prior = {
    compass_id: 'c',
    estimator: 'e',
    chosen_at: '2026-11-20T07:00:00Z',
    basis: null,
    refused: [],
  };
  const basis = { method: 1, published_at: '2026-11-03T09:00:00Z', ships: 12 };

  test('names the class of sister ships, their number and the publication', () => {
    const sisters = { kind: 'sisters', name: 'Handy' } as const;
    const { figure, meaning } = startedFrom({ ...atLarge, basis: { ...basis, class: sisters } });
    expect(figure).toBe('12 sister ships');
    expect(meaning).toContain('Class “Handy”, as published on 3 Nov 2026.');
    const fleet = { ...basis, class: { kind: 'operator' } as const };
    expect(startedFrom({ ...atLarge, basis: fleet }).figure).toBe('12 ships of this fleet');
  });

  test('says when too few other vessels were known', () => {
    expect(startedFrom(atLarge).meaning).toContain('usual in ships');
    const alone = { class: { kind: 'operator' } as const, ships: 1, needed: 2 };
    expect(startedFrom({ ...atLarge, refused: [alone] }).meaning).toMatch(/^Too few/);
  });
});

describe('where a model is good', () => {
  const met = {
    magnetic_latitude_from_deg: 30,
    ...{ h_nt_from: 23_000, h_nt_to: 25_000, z_nt_from: 37_500, z_nt_to: 39_500, samples: 100 },
  };

  test('is looked for from 60° N to 60° S, by the fields she met where she was', () => {
    const waters = watersOf(example, [met]);
    expect(waters.map(({ fromDeg }) => fromDeg)).toEqual([
      50, 40, 30, 20, 10, 0, -10, -20, -30, -40, -50, -60,
    ]);
    const own = waters.find(({ sailed }) => sailed);
    expect(own?.fromDeg).toBe(30);
    expect(own?.widest).toEqual(widestBand(example, biscay));
    expect(worstWaters(waters)?.fromDeg).toBe(-60);
    const beyond = watersOf(example, [{ ...met, magnetic_latitude_from_deg: 60 }]);
    expect(beyond.map(({ fromDeg }) => fromDeg).slice(0, 2)).toEqual([60, 50]);
    // Her sum is known off Biscay: the further from there, the wider.
    const [good] = goodRanges(waters);
    expect(good?.toDeg).toBeGreaterThanOrEqual(40);
    expect(good?.fromDeg).toBeGreaterThan(-30);
  });

  test('the magnetic latitude has the dip’s side', () => {
    expect(magneticLatitudeOf({ h_nt: 20_000, z_nt: 40_000 })).toBeCloseTo(45, 9);
    expect(magneticLatitudeOf({ h_nt: 20_000, z_nt: -40_000 })).toBeCloseTo(-45, 9);
    expect(magneticLatitudeOf({ h_nt: 30_000, z_nt: 0 })).toBe(0);
  });
});

const water = (fromDeg: number, band: number | null): Waters => ({
  fromDeg,
  toDeg: fromDeg + 10,
  sailed: false,
  widest: band === null ? null : { compass_deg: 90, band95_deg: band },
});
/** Without the spaces that keep a figure on one line. */
const plain = (words: string | undefined) => words?.replaceAll('\u00a0', ' ');

describe('in words', () => {
  test('the band here names its worst and its best heading', () => {
    const row = (compass_deg: number, band95_deg: number | null) => ({
      ...{ compass_deg, band95_deg, magnetic_deg: compass_deg, deviation_deg: 0 },
    });
    const found = here([row(0, 0.71), row(90, 1.42), row(180, 0.9), row(270, null)]);
    expect(plain(found?.figure)).toBe('± 1.4°');
    expect(plain(found?.meaning)).toBe('at worst, on 090°; ± 0.7° at best, on 000°.');
    expect(here([row(0, 1.01), row(90, 1.04)])?.meaning).toBe('on every heading.');
    expect(here([row(0, null)])).toBeNull();
  });

  test('other waters are good in a range, in several, everywhere or nowhere', () => {
    const found = elsewhere([water(40, 1.2), water(30, 2), water(20, 2.6), water(10, 6.3)]);
    expect(plain(found?.figure)).toBe('± 6.3°');
    expect(plain(found?.meaning)).toBe(
      'About ± 2° or better on every heading between 30° N and 50° N magnetic latitude; elsewhere up to ± 6.3°, at worst between 10° N and 20° N.',
    );
    expect(plain(elsewhere([water(0, 1), water(-10, 4), water(-20, 1)])?.meaning)).toContain(
      'between 20° S and 10° S and between 0° and 10° N magnetic latitude',
    );
    expect(plain(elsewhere([water(0, 1), water(-10, 2)])?.meaning)).toContain(
      'wherever ships sail: between 10° S and 10° N',
    );
    expect(elsewhere([water(0, 3), water(-10, 4)])?.meaning).toContain('No magnetic latitude');
    // Where a compass would not steer, it is not good.
    expect(elsewhere([water(50, null), water(40, 1)])?.meaning).toContain('elsewhere up to');
    expect(elsewhere([water(50, null)])).toBeNull();
  });

  test('samples are worth fewer, and a model that came without says nothing', () => {
    const found = worth({ ...example, samples_used: 7_282 });
    expect(found?.figure).toBe('61');
    expect(found?.meaning).toContain('7\u202f282 samples, worth 61 with independent errors');
    const { quality, ...without } = example;
    expect(quality?.cautions.map(cautionWords)[0]).toContain('what is usual in ships');
    expect(worth(without)).toBeNull();
    expect(plain(cautionWords({ caution: 'weak_field', h_nt: 4_130 }))).toContain('only 4.1 µT');
  });

  test('every caution has words of its own', () => {
    const cautions: Caution[] = [
      { caution: 'one_magnetic_latitude' },
      { caution: 'few_samples' },
      { caution: 'no_times' },
      { caution: 'large_residuals', residual_deg: 2.43 },
      { caution: 'long_gap', days: 3_652.6, last: '2025-03-20T23:50:00Z' },
      { caution: 'weak_field', h_nt: 4_130 },
      { caution: 'variation_unproven', mistake: 'missing', zero_deg: -13.9 },
      { caution: 'moonlight' } as unknown as Caution,
    ];
    const words = cautions.map(cautionWords);
    expect(new Set(words).size).toBe(cautions.length);
    expect(words[3]).toContain('differ by 2.4°');
    expect(plain(words[4])).toContain('none for 3\u202f653 days');
    expect(words[4]).toContain('2025');
    expect(words[6]).toContain('off by 13.9°');
  });

  test('references differ by an angle with its side, and what was dropped is counted', () => {
    const found: References = {
      ...{ pairs: 4_120, offset_deg: -0.32, failed_beyond_deg: 2.14, constant_sd_deg: 0.354 },
      ...{ gyro_dropped: 12, satellite_dropped: 0 },
    };
    expect(references(found).figure).toBe('0.3° apart');
    expect(references(found).meaning).toContain('usually reads 0.3° less than the satellite');
    expect(plain(references(found).meaning)).toContain('± 0.7° for that is in every band');
    expect(references({ ...found, offset_deg: 0.32 }).meaning).toContain('0.3° more than');
    expect(dropped(found)).toContain('left out in 12 samples, the satellite compass in 0.');
    expect(dropped(found)).toContain('further than 2.1° from');
    expect(dropped({ ...found, gyro_dropped: 0 })).toBe('');
    expect(references({ ...found, pairs: 5, offset_deg: null }).figure).toBe('Not compared');
    const single = { ...found, pairs: 0, offset_deg: null };
    expect(references(single).figure).toBe('Only one');
    expect(dropped(single)).not.toContain('further than');
  });

  test('predictions say how many came true, and by how much the band was widened', () => {
    const found = {
      rows: 4210,
      rows_inside: 4003,
      watches: 100,
      watches_inside: 94,
      expected_from: 90,
      expected_to: 99,
      watches_disturbed: 2,
      mean_square: 1.05,
      widening: 1,
    };
    expect(predictions(found)?.figure).toBe('94 of 100');
    expect(predictions(found)?.meaning).toContain('Of an honest band, 90 to 99 do.');
    const short = predictions({ ...found, watches_inside: 81, widening: 1.42 });
    expect(short?.meaning).toContain('1.4 times as wide');
    expect(predictions({ ...found, watches: 19, watches_inside: 19 })).toBeNull();
  });

  test('every refusal says what is missing and what to do', () => {
    const refusals: Refusal[] = [
      { reason: 'too_few_samples', found: 3, needed: 20 },
      ...[{ reason: 'too_few_headings' as const, found: 5, needed: 12 }].map((refusal) => ({
        ...refusal,
        ...{ widest_gap_deg: 211.4, allowed_gap_deg: 90 },
        missing_deg: [
          [90, 135],
          [345, 390],
        ] as [number, number][],
      })),
      { reason: 'field_too_weak', strongest_nt: 1_900, needed_nt: 3_000 },
      { reason: 'ambiguous_headings', h_nt: 5_000 },
      { reason: 'one_magnetic_latitude' },
      { reason: 'references_disagree', offset_deg: -12.04, allowed_deg: 6 },
      { reason: 'reference_stuck', readings: 1_400 },
      { reason: 'not_converged' },
      { reason: 'no_reference', readings: 40 },
      { reason: 'no_weight', samples: 40 },
      { reason: 'contradictory', residual_deg: 10.52, allowed_deg: 3 },
      { reason: 'reference_is_compass', samples: 400, scatter_deg: 0.03, least_deg: 0.082 },
      { reason: 'few_samples_used', used: 12, found: 400 },
      { reason: 'model_does_not_explain', residual_deg: 9.66, allowed_deg: 5 },
      {
        reason: 'no_steady_course',
        ...{ readings: 1_440, found: 3, needed: 12 },
        ...{ too_slow: 1_400, turning: 37, least_sog_kn: 4 },
      },
      {
        reason: 'variation_mistaken',
        ...{ mistake: 'wrong_sign', residual_deg: 5.92, explained_deg: 0.71 },
      },
    ];
    const found = refusals.map((refusal) => refusalWords(refusal));
    expect(new Set(found.map((words) => words?.todo)).size).toBe(refusals.length);
    expect(found[0]?.missing).toContain('3 samples can be used so far; at least 20');
    expect(found[1]?.missing).toContain('5 of 24 sectors of 15°, with a gap of 211°');
    expect(plain(found[2]?.missing)).toContain('at most 1.9 µT; a magnetic compass needs 3.0 µT');
    expect(found[5]?.missing).toContain('differ by 12.0° throughout; 6° is the most');
    expect(plain(found[1]?.missing)).toContain('Missing: 090° – 135°, 345° – 030°.');
    expect(found[10]?.missing).toContain(
      'differ by 10.5°, where no instruments leave more than 3°',
    );
    expect(found[11]?.missing).toContain('scatters by only 0.03°');
    expect(found[12]?.missing).toContain('Only 12 of 400 samples');
    expect(found[13]?.missing).toContain('misses its own samples by 9.7°');
    expect(plain(found[14]?.missing)).toContain('below 4 knots, 37 in a turn');
    expect(found[15]?.missing).toContain('with the wrong sign');
    expect(refusalWords({ reason: 'moonlight' } as unknown as Refusal)).toBeNull();
  });
});
