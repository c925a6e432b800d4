import { describe, expect, test } from 'vitest';
import type { Coverage, Model, SamplePicture } from '../api/types';
import { coefficientErrors, exactCoefficients } from './coefficients';
import { headingRange, latitudeRange, widths } from './advice';
import { coverageTable, gaps } from './coverage';
import { arcs, pointAt, rings, sectorPath, shade } from './rose';
import { closed, deviationAt, everyStep, extremes, grade } from './curve';
import { basisOf, parameterRows } from './parameters';
import { dotsOf, intervalsOf, residualsOf, thinned } from './residuals';

const model: Model = {
  version: 1,
  parameters_over_lambda: {
    bx_nt: 2060,
    chi13: -0.0215,
    by_nt: -2930,
    chi23: 0.0022,
    chi11_minus_chi22: 0.0352,
    chi12: 0.0012,
    chi21: 0.0016,
  },
  constant_deg: 0.5,
  covariance: null,
  identifiable: null,
  rms_deg: 0.4,
  samples_used: 100,
  samples_rejected: 2,
};

const row = (compass_deg: number, deviation_deg: number, band95_deg: number | null = 0.5) => ({
  compass_deg,
  deviation_deg,
  band95_deg,
  magnetic_deg: compass_deg + deviation_deg,
});

describe('coefficients', () => {
  test('have the needles’ part of D twice where the field is half as strong', () => {
    const needles = { d_nt: 720, e_nt: 0, reference_h_nt: 36_000, relative_sd: 0.1 };
    const d = (h_nt: number) => exactCoefficients({ ...model, needles }, h_nt, 0).D;
    expect(d(36_000)).toBeCloseTo(exactCoefficients(model, 36_000, 0).D, 9);
    expect(d(18_000) - d(36_000)).toBeCloseTo(0.02 * 57.29578, 6);
  });

  test('follow from the parameters and the field at the place', () => {
    const found = exactCoefficients(model, 24_000, 39_000);
    expect(found.A).toBeCloseTo(0.5 + 0.0002 * 57.29578, 6);
    expect(found.B).toBeCloseTo(((2060 - 0.0215 * 39_000) / 24_000) * 57.29578, 4);
    expect(found.C).toBeCloseTo(((-2930 + 0.0022 * 39_000) / 24_000) * 57.29578, 4);
    expect(found.D).toBeCloseTo(0.0176 * 57.29578, 6);
    expect(found.E).toBeCloseTo(0.0014 * 57.29578, 6);
  });

  test('B changes with magnetic latitude and D does not', () => {
    const north = exactCoefficients(model, 24_000, 39_000);
    const south = exactCoefficients(model, 24_000, -39_000);
    expect(south.B).toBeGreaterThan(north.B);
    expect(south.D).toBe(north.D);
  });

  test('of a sum that is known have a smaller error than its parts', () => {
    const covariance = Array.from({ length: 8 }, () => Array.from({ length: 8 }, () => 0));
    const set = (i: number, j: number, value: number) => {
      for (const [row, column] of [
        [i, j],
        [j, i],
      ] as const) {
        const cells = covariance[row];
        if (cells) cells[column] = value;
      }
    };
    // bx = 400 nT and chi13 = 0.01 uncertain, their sum at Z 40000 nT not at all.
    set(0, 0, 400 ** 2);
    set(1, 1, 0.01 ** 2);
    set(0, 1, -400 * 0.01);
    set(6, 6, 0.004 ** 2);
    set(7, 7, 0.3 ** 2);
    const errors = coefficientErrors({ covariance }, 20_000, 40_000);
    expect(errors.B).toBeCloseTo(0, 6);
    expect(coefficientErrors({ covariance }, 20_000, -40_000).B).toBeCloseTo(
      (800 / 20_000) * 57.29578,
      4,
    );
    expect(errors.A).toBeCloseTo(Math.hypot(0.3, 0.002 * 57.29578), 6);
    expect(errors.E).toBeCloseTo(0.002 * 57.29578, 6);
    expect([errors.C, errors.D]).toEqual([0, 0]);
    expect(coefficientErrors({ covariance: null }, 20_000, 40_000).A).toBeNull();
  });
});

describe('parameters', () => {
  test('have the errors that the covariance gives, in its order', () => {
    const covariance = Array.from({ length: 8 }, (_, i) =>
      Array.from({ length: 8 }, (_, j) => (i === j ? (i + 1) ** 2 : 0)),
    );
    const rows = parameterRows({ ...model, covariance });
    expect(rows.map((r) => r.name)[0]).toBe('bx_nt');
    expect(rows[7]).toMatchObject({ name: 'constant_deg', value: 0.5 });
    expect(rows[7]?.error).toBeCloseTo(8, 9);
  });

  test('without a covariance have no error, not an error of zero', () => {
    expect(parameterRows(model).every((r) => r.error === null)).toBe(true);
    expect(parameterRows(model).every((r) => r.basis === 'unknown')).toBe(true);
  });

  test('are called her own only where her data tell them apart', () => {
    expect([1, 0.9, 0.89, 0.5, 0.49, 0.1, 0.09, 0].map((share) => basisOf(true, share))).toEqual([
      'own',
      'own',
      'mostly',
      'mostly',
      'little',
      'little',
      'ships',
      'ships',
    ]);
    // Its sum with another is well known, itself it is not.
    expect(basisOf(false, 0.95)).toBe('mostly');
    expect([basisOf(true, null), basisOf(false, null)]).toEqual(['own', 'ships']);
  });
});

describe('the curve', () => {
  const rows = [row(0, -3), row(90, 5, 0.2), row(180, 1), row(270, -6, 1.4)];

  test('its extremes have side and heading', () => {
    const found = extremes(rows);
    expect(found?.largest.compass_deg).toBe(270);
    expect(found?.mostEast.compass_deg).toBe(90);
    expect([found?.narrowest95, found?.widest95]).toEqual([0.2, 1.4]);
    expect(extremes([])).toBeNull();
  });

  test('closes at north, so that 359° lies between the last row and the first', () => {
    expect(closed(rows).at(-1)?.compass_deg).toBe(360);
    expect(deviationAt(rows, 315)).toBeCloseTo(-4.5, 9);
    expect(deviationAt(rows, 45)).toBeCloseTo(1, 9);
    expect(deviationAt(rows, 0)).toBe(-3);
    expect(deviationAt([], 45)).toBeNull();
  });

  test('a card has every fifteenth degree and no 360', () => {
    const fine = Array.from({ length: 73 }, (_, i) => row(i * 5, 0));
    expect(everyStep(fine, 15)).toHaveLength(24);
  });

  test('more than five degrees to either side is large', () => {
    expect([2.9, -3.1, 5, -5.1].map(grade)).toEqual(['small', 'notable', 'notable', 'large']);
  });
});

describe('a picture of samples', () => {
  const picture = {
    interval_days: 7,
    intervals: [{ from: '2026-11-01T00:00:00Z', samples: 2, mean_deg: 1, rms_deg: 1.5 }],
    dots: {
      unix_s: [1793491200, 1793491800],
      lon: [4, 4.1],
      compass_deg: [90, 91],
      deviation_deg: [2, 2.5],
      residual_deg: [0.5, null],
      used: [true, false],
    },
  } as SamplePicture;

  test('has rows again, those without a prediction too', () => {
    expect(dotsOf(picture.dots)).toEqual([
      { compassDeg: 90, deviationDeg: 2, residualDeg: 0.5, used: true },
      { compassDeg: 91, deviationDeg: 2.5, residualDeg: null, used: false },
    ]);
  });

  test('has residuals in time where something was predicted', () => {
    expect(residualsOf(picture.dots)).toEqual([
      { time: new Date('2026-11-01T00:00:00Z'), residualDeg: 0.5, used: true },
    ]);
  });

  test('has intervals that end where the next would begin', () => {
    expect(intervalsOf(picture)[0]?.to).toEqual(new Date('2026-11-08T00:00:00Z'));
  });

  test('are thinned evenly and never repeated', () => {
    const values = Array.from({ length: 1000 }, (_, i) => i);
    const few = thinned(values, 300);
    expect(new Set(few).size).toBe(300);
    expect(thinned(values, 2000)).toBe(values);
  });
});

describe('coverage', () => {
  const coverage = (cells: [number, number, number][]): Coverage => ({
    heading_step_deg: 15,
    magnetic_latitude_step_deg: 10,
    bands: [],
    sail_next: null,
    references: null,
    predictions: null,
    cells: cells.map(([magnetic_latitude_from_deg, heading_from_deg, samples]) => ({
      magnetic_latitude_from_deg,
      heading_from_deg,
      samples,
    })),
  });

  test('runs from north to south with the empty bands between', () => {
    const table = coverageTable(
      coverage([
        [-10, 0, 3],
        [20, 345, 4],
        [20, 0, 1],
      ]),
    );
    expect(table.bands.map((band) => [band.fromDeg, band.total])).toEqual([
      [20, 5],
      [10, 0],
      [0, 0],
      [-10, 3],
    ]);
    expect([table.totals[0], table.totals[23], table.most]).toEqual([4, 4, 4]);
  });

  test('missing headings are joined across north', () => {
    const filled = Array.from({ length: 24 }, (_, i): [number, number, number] => [0, i * 15, 1]);
    const holes = new Set([0, 15, 345, 90]);
    const table = coverageTable(coverage(filled.filter(([, heading]) => !holes.has(heading))));
    expect(gaps(table)).toEqual([
      { fromDeg: 90, toDeg: 105 },
      { fromDeg: 345, toDeg: 30 },
    ]);
    expect(gaps(coverageTable(coverage(filled)))).toEqual([]);
  });
});

describe('what to sail next', () => {
  const band = (rms_deg: number) => ({ rms_deg, worst_deg: rms_deg });

  test('widths have as many decimals as show that they differ', () => {
    expect(widths(band(1.2), band(0.9))).toEqual(['±\u00a01.2°', '±\u00a00.9°']);
    expect(widths(band(1.29), band(1.26), band(1.18))).toEqual([
      '±\u00a01.29°',
      '±\u00a01.26°',
      '±\u00a01.18°',
    ]);
  });

  test('a range may pass north, and the whole circle is any heading', () => {
    const range = (from: number, to: number) =>
      headingRange({ heading_from_deg: from, heading_to_deg: to });
    expect(range(30, 75)).toBe('Between 030° and 075°');
    expect(range(330, 15)).toBe('Between 330° and 015°');
    expect(range(300, 360)).toBe('Between 300° and 000°');
    expect(range(0, 360)).toBe('On any heading');
  });

  test('latitudes have their side, the equator none', () => {
    expect(latitudeRange(-60, 0)).toBe('Between 60° S and 0°, magnetic latitude');
    expect(latitudeRange(-10, 20)).toBe('Between 10° S and 20° N, magnetic latitude');
  });
});

describe('the coverage rose', () => {
  const table = coverageTable({
    heading_step_deg: 15,
    magnetic_latitude_step_deg: 10,
    cells: [
      { magnetic_latitude_from_deg: 30, heading_from_deg: 90, samples: 5 },
      { magnetic_latitude_from_deg: 20, heading_from_deg: 0, samples: 1 },
    ],
  } as unknown as Coverage);

  test('has north up and east to the right', () => {
    expect(pointAt(0, 100)).toBe('0 -100');
    expect(pointAt(90, 100)).toBe('100 0');
    expect(pointAt(180, 100)).toBe('0 100');
    expect(pointAt(270, 100)).toBe('-100 0');
  });

  test('has the northernmost band outside, and every sector in each', () => {
    const [outside, inside] = rings(table);
    expect([outside?.fromDeg, outside?.outer, outside?.inner]).toEqual([30, 100, 65]);
    expect([inside?.fromDeg, inside?.outer, inside?.inner]).toEqual([20, 65, 30]);
    expect(outside?.cells).toHaveLength(24);
    expect(outside?.cells[6]?.samples).toBe(5);
  });

  test('draws advice through north the short way, and a whole turn as a turn', () => {
    const range = (heading_from_deg: number, heading_to_deg: number) => ({
      heading_from_deg,
      heading_to_deg,
    });
    expect(arcs([range(345, 15)], 90, 100)[0]).toContain('0 0 1');
    expect(arcs([range(15, 345)], 90, 100)[0]).toContain('0 1 1');
    expect(sectorPath(0, 360, 90, 100).match(/M/g)).toHaveLength(2);
  });

  test('shades the fullest cell whole, a single sample a little, none not at all', () => {
    expect(shade(0, 100)).toBe(0);
    expect(shade(100, 100)).toBeCloseTo(1);
    expect(shade(1, 100)).toBeGreaterThan(0.18);
  });
});
