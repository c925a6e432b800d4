import { render } from 'svelte/server';
import { describe, expect, test } from 'vitest';
import { Problem } from '../api/problem';
import type { Coverage, DeviationTable as Table, ModelVersion } from '../api/types';
import CoefficientPanel from './CoefficientPanel.svelte';
import CoveragePanel from './CoveragePanel.svelte';
import DeviationTable from './DeviationTable.svelte';
import ParameterPanel from './ParameterPanel.svelte';
import NoModel from './NoModel.svelte';
import TrustPanel from './TrustPanel.svelte';
import { version, words } from './testing';

describe('the parameters', () => {
  test('say in words what each rests on, with its error', () => {
    const shown = words(render(ParameterPanel, { props: { version } }));
    expect(shown).toContain(
      'Permanent fore-and-aft magnetism P, forward positive +2.06 ± 0.10 µT her own headings',
    );
    expect(shown).toContain('c −0.0215 ± 0.0010 ships at large');
    expect(shown).toContain('Her own headings tell 5 of the 8 apart');
    expect(shown).toContain('A (includes alignment, reference and variation offsets)');
  });

  test('that are only in part her own say so', () => {
    const from_data = {
      ...{ bx_nt: 0.93, chi13: 0.23, by_nt: 1, chi23: 0.97, chi11_minus_chi22: 1 },
      ...{ chi12: 0.75, chi21: 0.75, constant_deg: 0.05 },
    };
    const quality = { effective_samples: 31.4, condition: 46.2, from_data, cautions: [] };
    const told = { ...version, model: { ...version.model, quality } };
    const shown = words(render(ParameterPanel, { props: { version: told } }));
    expect(shown).toContain('c −0.0215 ± 0.0010 mostly ships at large');
    expect(shown).toContain('+0.0012 ± 0.0010 mostly her own');
    expect(shown).toMatch(/offsets \+0\.30 ± 0\.00° ships at large/);
    expect(shown).toContain('46 times less certain');
  });

  test('without a covariance show no error of zero', () => {
    const bare = { ...version, model: { ...version.model, covariance: null, identifiable: null } };
    const shown = words(render(ParameterPanel, { props: { version: bare } }));
    expect(shown).toContain('+2.06 µT not stated');
    expect(shown).not.toContain('± 0');
  });
});

describe('how far to trust the curve', () => {
  const coverage: Coverage = {
    heading_step_deg: 15,
    magnetic_latitude_step_deg: 10,
    bands: [],
    cells: [],
    sail_next: null,
    references: {
      pairs: 800,
      offset_deg: 0.5,
      failed_beyond_deg: 2,
      constant_sd_deg: 0.354,
      gyro_dropped: 0,
      satellite_dropped: 3,
    },
    predictions: null,
  };
  const from_data = {
    ...{ bx_nt: 0.9, chi13: 0.2, by_nt: 1, chi23: 1, chi11_minus_chi22: 1 },
    ...{ chi12: 0.7, chi21: 0.7, constant_deg: 1 },
  };
  const quality: ModelVersion['model']['quality'] = {
    effective_samples: 31.4,
    condition: null,
    from_data,
    cautions: [{ caution: 'weak_field', h_nt: 4_100 }],
  };
  const told = { ...version, model: { ...version.model, quality } };
  const table: Table = {
    ...{ lat: 54, lon: 10, at: '2026-11-01T00:00:00Z', variation_deg: 3 },
    ...{ h_nt: 18_000, z_nt: 46_000, model_id: 'm', model_version: 3 },
    rows: [0, 90, 180, 270].map((compass_deg) => ({
      ...{ compass_deg, magnetic_deg: compass_deg, deviation_deg: 1 },
      band95_deg: compass_deg === 90 ? 1.4 : 0.6,
    })),
  };

  test('is said for here and elsewhere, with what it rests on and the cautions', () => {
    const shown = words(
      render(TrustPanel, { props: { version: told, table, moved: false, coverage } }),
    );
    expect(shown).toContain('horizontal field of only 4.1 µT');
    expect(shown).toContain('In these waters ± 1.4° at worst, on 090°; ± 0.6° at best, on 000°.');
    expect(shown).toContain('900 samples, worth 31 with independent errors');
    expect(shown).toContain('0.5° apart');
    expect(shown).toContain('the satellite compass in 3.');
    expect(shown).toMatch(/50° N to 60° N here ± \d/);
    expect(shown.match(/ here ± /g)).toHaveLength(1);
  });

  test('follows the place, and claims nothing for a model that came without errors', () => {
    const moved = words(
      render(TrustPanel, { props: { version: told, table, moved: true, coverage } }),
    );
    expect(moved).toContain('At the place chosen ± 1.4°');
    const bare = { ...version, model: { ...version.model, covariance: null, identifiable: null } };
    const shown = words(
      render(TrustPanel, {
        props: { version: bare, table: undefined, moved: false, coverage: undefined },
      }),
    );
    expect(shown).toBe('This model came without errors: how far it may be off is not known.');
  });
});

test('without a model it is said what is missing, and what to do', () => {
  const shown = (problem: Problem) => words(render(NoModel, { props: { problem } }));
  const few = { reason: 'too_few_samples', found: 3, needed: 20 } as const;
  expect(shown(new Problem(404, 'no-model-yet', '3 samples', few))).toMatch(
    /3 samples can be used so far; at least 20 are needed\. What to do: Keep sailing/,
  );
  expect(shown(new Problem(404, 'no-model-yet', 'none'))).toContain('No sample has been analysed');
  const since = '2026-11-18T06:00:00Z';
  const adjusted = new Problem(404, 'no-model-yet', 'x', few, { since, reason: 'dry_docking' });
  expect(shown(adjusted)).toContain(
    'The last card has not held since 18 Nov 2026, 06:00 UTC (dry-docking): do not steer by it.',
  );
  const loaded = { magnetic_cargo: 288, berth: 0 };
  const excluded = new Problem(404, 'no-model-yet', 'x', few, undefined, loaded);
  expect(shown(excluded)).toContain(
    'Entries of the logbook leave out further samples: 288 for “magnetic cargo”. If one',
  );
  const later = { reason: 'moonlight' } as unknown as typeof few;
  expect(shown(new Problem(404, 'no-model-yet', 'too much moonlight', later))).toContain(
    'too much moonlight',
  );
});

test('the coefficients stand beside the handbook’s, which may be missing', () => {
  expect(words(render(CoefficientPanel, { props: { version } }))).toMatch(
    /east and west \+3\.4° ± 0\.4° \+3\.1°/,
  );
  const without = { ...version, handbook: null };
  expect(words(render(CoefficientPanel, { props: { version: without } }))).toMatch(
    /east and west \+3\.4° ± 0\.4° –/,
  );
  const shown = words(render(CoefficientPanel, { props: { version } }));
  expect(shown).toContain('intercardinals +1.0° ± &lt; 0.1°');
});

test('the table of deviations has every fifteenth degree with side and band', () => {
  const table: Table = {
    lat: 54,
    lon: 10,
    at: '2026-11-01T00:00:00Z',
    variation_deg: 3,
    h_nt: 18_000,
    z_nt: 46_000,
    model_id: 'm',
    model_version: 3,
    rows: Array.from({ length: 72 }, (_, i) => ({
      compass_deg: i * 5,
      magnetic_deg: (i * 5 + 357.7) % 360,
      deviation_deg: i === 0 ? -2.3 : 1.04,
      band95_deg: i === 0 ? null : 0.42,
    })),
  };
  const rendered = render(DeviationTable, { props: { table } });
  const shown = words(rendered);
  expect(shown).toContain('at 54° 00.0′ N, 010° 00.0′ E on 1 Nov 2026');
  expect(shown).toContain('000° N 2.3° W – 357.7°');
  expect(shown).toContain('345° 1.0° E ± 0.4° 342.7°');
  expect(rendered.body.match(/scope="row"/g)).toHaveLength(24);
});

test('coverage names the headings that are missing, and says when one band is all there is', () => {
  const coverage: Coverage = {
    heading_step_deg: 15,
    magnetic_latitude_step_deg: 10,
    bands: [],
    sail_next: null,
    references: null,
    predictions: null,
    cells: Array.from({ length: 20 }, (_, i) => ({
      heading_from_deg: i * 15,
      magnetic_latitude_from_deg: 40,
      samples: 3,
    })),
  };
  const shown = words(render(CoveragePanel, { props: { coverage } }));
  expect(shown).toContain('No samples yet on compass headings 300°–000°.');
  expect(shown).toContain('All samples are from one band of magnetic latitude');
  expect(words(render(CoveragePanel, { props: { coverage: { ...coverage, cells: [] } } }))).toBe(
    'No samples yet.',
  );
});
