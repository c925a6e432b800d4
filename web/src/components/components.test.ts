import { render } from 'svelte/server';
import { describe, expect, test } from 'vitest';
import { Problem } from '../api/problem';
import type {
  AgentStream,
  Change,
  Coverage,
  DeviationTable as Table,
  ModelVersion,
  SailNext,
  FleetVessel,
  Timeline,
} from '../api/types';
import AgentPanel from './AgentPanel.svelte';
import CoefficientPanel from './CoefficientPanel.svelte';
import CoveragePanel from './CoveragePanel.svelte';
import DeviationTable from './DeviationTable.svelte';
import ParameterPanel from './ParameterPanel.svelte';
import NoModel from './NoModel.svelte';
import SailNextPanel from './SailNextPanel.svelte';
import TimelinePanel from './TimelinePanel.svelte';
import TrustPanel from './TrustPanel.svelte';
import FleetRow from './fleet/FleetRow.svelte';
import Worst from './Worst.svelte';

/** What a reader without style sheets sees, in one line. */
function words(rendered: { body: string }): string {
  return rendered.body
    .replace(/<!--.*?-->/gs, '')
    .replace(/<[^>]*>/g, ' ')
    .replace(/\s+/g, ' ')
    .trim();
}

const version: ModelVersion = {
  id: 'm',
  foretold_by: null,
  version: 3,
  compass_id: 'c',
  epoch_from: null,
  epoch_to: null,
  data_from: '2026-09-01T00:00:00Z',
  data_until: '2026-11-01T00:00:00Z',
  created_at: '2026-11-01T00:10:00Z',
  input_hash: '0123456789abcdef',
  estimator: 'robust-1',
  lat: 54,
  lon: 10,
  h_nt: 18_000,
  z_nt: 46_000,
  handbook: { A: 0.3, B: 3.1, C: -2.2, D: 1, E: 0.1 },
  model: {
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
    constant_deg: 0.3,
    covariance: Array.from({ length: 8 }, (_, i) =>
      Array.from({ length: 8 }, (_, j) => (i !== j ? 0 : i === 0 ? 100 ** 2 : 0.001 ** 2)),
    ),
    identifiable: {
      bx_nt: true,
      chi13: false,
      by_nt: true,
      chi23: false,
      chi11_minus_chi22: true,
      chi12: true,
      chi21: true,
      constant_deg: false,
    },
    rms_deg: 0.4,
    samples_used: 900,
    samples_rejected: 4,
  },
};

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

describe('what to sail next', () => {
  const band = (rms_deg: number) => ({ rms_deg, worst_deg: 2 * rms_deg });
  const advice: SailNext = {
    watch_hours: 4,
    floor_deg: 0.98,
    here: {
      band: band(1.2),
      narrows_at_most_deg: 0.22,
      suggestions: [
        {
          heading_from_deg: 30,
          heading_to_deg: 75,
          after_one: band(0.9),
          after_three: band(0.8),
        },
      ],
    },
    elsewhere: {
      band: band(2.9),
      narrows_at_most_deg: 1.92,
      suggestions: [
        {
          magnetic_latitude_from_deg: -60,
          magnetic_latitude_to_deg: 20,
          headings: [
            { heading_from_deg: 90, heading_to_deg: 105 },
            { heading_from_deg: 345, heading_to_deg: 360 },
            { heading_from_deg: 90, heading_to_deg: 105 },
          ],
          after_one: band(2),
          after_three: band(1.3),
        },
      ],
    },
  };

  test('is headings here and magnetic latitudes for elsewhere, with what they would do', () => {
    const shown = words(render(SailNextPanel, { props: { advice } }));
    expect(shown).toContain(
      'Between 030° and 075° A watch would narrow the band from ± 1.2° to ± 0.9°, three watches on one of these headings to ± 0.8°.',
    );
    expect(shown).toContain('the band is ± 2.9° as a mean, ± 5.8° at worst');
    expect(shown).toContain(
      'Between 60° S and 20° N, magnetic latitude A watch on about 100° there would narrow the band in other waters from ± 2.9° to ± 2.0°, three watches (100° and 350°) to ± 1.3°.',
    );
    expect(shown).not.toContain('Neither');
  });

  test('is nothing where only the reference’s own error is left, and that is said', () => {
    const known: SailNext = {
      ...advice,
      here: { band: band(1.01), narrows_at_most_deg: 0.03, suggestions: [] },
      elsewhere: null,
    };
    const shown = words(render(SailNextPanel, { props: { advice: known } }));
    expect(shown).toContain(
      'It is ± 1.01°, and the reference’s own constant error, which no heading shows, is ± 0.98°',
    );
    expect(shown).toContain('narrows the band by more than 0.03°');
    expect(shown).toContain('check the gyro');
    expect(shown).not.toContain('For other waters');
  });
});

describe('the installations', () => {
  const agent: AgentStream = {
    agent_id: '0190a000-0000-7000-8000-000000000800',
    revoked_at: null,
    stream: '0190a000-0000-7000-8000-000000000900',
    compass_id: 'c',
    compass_name: 'Standard compass',
    agent_version: '0.1.0',
    opened_at: '2026-09-01T00:00:00Z',
    last_upload_at: null,
    contiguous_seq: 4,
    batches: 6,
    samples: 12_000,
    tally: { turning: 25, accepted: 70, moonlight_too_bright: 5 },
  };

  test('are revoked by whom may, one by one, and say so', () => {
    const revoked = { ...agent, agent_id: 'r', stream: 'r', revoked_at: '2026-09-02T10:00:00Z' };
    const earlier = { ...agent, stream: 'earlier' };
    const props = { agents: [earlier, agent, revoked] };
    const buttons = (shown: string) => shown.match(/Revoke…/g)?.length ?? 0;
    expect(buttons(words(render(AgentPanel, { props })))).toBe(0);
    const shown = words(
      render(AgentPanel, { props: { ...props, revoke: () => Promise.resolve() } }),
    );
    expect(buttons(shown)).toBe(1);
    expect(shown).toMatch(/Revoked 2 Sep 2026, 10:00 UTC: this agent may not send/);
  });

  test('count windows by reason, accepted first, and name reasons that are new', () => {
    const shown = words(render(AgentPanel, { props: { agents: [agent] } }));
    expect(shown).toMatch(
      /accepted 70 % 70 refused: turning 25 % 25 refused: moonlight too bright 5 % 5/,
    );
    expect(shown).toContain('A batch before the latest is missing');
    expect(shown).toContain('waiting for the first batch');
  });

  test('none yet is said', () => {
    expect(words(render(AgentPanel, { props: { agents: [] } }))).toContain(
      'No agent has been enrolled',
    );
  });
});

test('the list shows side, heading and band, and what is not there yet', () => {
  const vessel: FleetVessel = {
    id: 'v',
    name: 'MV Arcturus',
    imo_number: null,
    call_sign: 'EAVN',
    last_upload_at: null,
    position: { lat: -33.9, lon: 18.4, at: '2026-11-01T06:00:00Z' },
    track: [],
    model: { version: 2, rms_deg: 0.42, data_until: '2026-11-01T06:00:00Z', cautions: 1 },
    worst: { compass_deg: 45, deviation_deg: -6.2, band95_deg: 0.4 },
    open_alerts: 3,
    next_call: null,
    alert: {
      cause: 'deviation_over_limit',
      severity: 'critical',
      state: 'raised',
      summary: 'The deviation exceeds 5°.',
    },
  };
  const row = { vessel, chosen: false, choose: () => undefined };
  const shown = words(render(FleetRow, { props: row }));
  expect(shown).toContain('MV Arcturus EAVN Critical Deviation over the limit and 2 more');
  expect(shown).toContain('6.2° W large on 045°, ± 0.4° (95 %)');
  expect(shown).toContain('fair residuals 0.4°');
  expect(shown).toContain('nothing uploaded yet');
  const calm = { ...vessel, alert: null, open_alerts: 0, worst: null, model: null };
  const said = words(render(FleetRow, { props: { ...row, vessel: calm } }));
  expect(said).toContain('nothing No model yet none yet');
});

test('a worst deviation without a band claims none', () => {
  const shown = words(
    render(Worst, { props: { worst: { compass_deg: 0, deviation_deg: 1, band95_deg: null } } }),
  );
  expect(shown).toBe('1.0° E small on 000°');
});

describe('the timeline', () => {
  const calm: Timeline = {
    compass_id: 'c',
    analysed_at: '2026-11-11T00:00:00Z',
    place: null,
    changes: [],
    epochs: [
      {
        from: null,
        to: null,
        begun_by: null,
        begun_by_change: null,
        resumes: null,
        data_from: '2026-10-20T00:00:00Z',
        data_until: '2026-11-10T00:00:00Z',
        model_version: 1,
        rms_deg: 0.31,
        samples_used: 412,
        curve: [],
        refusal: null,
      },
    ],
  };
  const struck: Change = {
    from: '2026-11-09T00:00:00Z',
    from_earliest: '2026-11-08T23:40:00Z',
    from_latest: '2026-11-09T00:10:00Z',
    detected_at: '2026-11-09T02:00:00Z',
    confirmed: true,
    cause: 'lightning_or_shock',
    causes: [
      { cause: 'lightning_or_shock', probability: 0.96 },
      { cause: 'magnetic_cargo', probability: 0.04 },
      { cause: 'drift', probability: 0.0001 },
    ],
    evidence: ['it began at sea'],
    deviation_change_deg: -6.24,
    step: { bx_nt: 3000, by_nt: -2000, bx_se_nt: 120, by_se_nt: 95 },
    ended: null,
    epoch_before: 0,
    epoch_after: null,
    epoch_ended: null,
  };
  const shown = (timeline: Timeline) =>
    words(render(TimelinePanel, { props: { timeline, entries: [] } }));

  test('says since when no change was found', () => {
    const calmly = shown(calm);
    expect(calmly).toContain('No change found since 20 Oct 2026');
    expect(calmly).toContain('Model of 412 samples, residuals 0.3° rms.');
    const [only] = calm.epochs;
    const adjusted = '2026-10-01T00:00:00Z';
    const begun =
      only === undefined
        ? []
        : [
            { ...only, to: adjusted, data_from: null, data_until: null, curve: null },
            { ...only, from: adjusted, begun_by: 'adjustment' as const },
          ];
    expect(shown({ ...calm, epochs: begun })).toContain('No change found since 20 Oct 2026');
    const nothing = { ...calm, analysed_at: null, epochs: [] };
    expect(shown(nothing)).toContain('Nothing has been analysed yet');
  });

  test('says what changed, how much, and why', () => {
    const said = shown({ ...calm, changes: [struck] });
    for (const part of [
      'Lightning or a shock some time between 8 Nov 2026, 23:40 UTC and 9 Nov 2026, 00:10 UTC',
      'Deviation changed by 6.2° on the heading where it changed most.',
      '+3.0 ± 0.1 µT fore-and-aft',
      '−2.0 ± 0.1 µT athwartships',
      'Found 2 h after that.',
      'It began at sea.',
      'Lightning or a shock 96 %, all but certain',
      'Magnetic cargo 4 %, unlikely',
    ]) {
      expect(said).toContain(part);
    }
    expect(said).not.toContain('Slow drift');
  });

  test('blames the compass for nothing that a reference did', () => {
    const fault: Change = {
      ...struck,
      cause: 'reference_fault',
      deviation_change_deg: null,
      step: null,
      confirmed: false,
      ended: '2026-11-09T06:00:00Z',
    };
    const said = shown({ ...calm, changes: [fault] });
    expect(said).toContain('Gyro or satellite compass at fault not certain yet over since 9 Nov');
    expect(said).toContain('The ship’s own magnetism did not change.');
  });
});
