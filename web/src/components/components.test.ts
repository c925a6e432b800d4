import { render } from 'svelte/server';
import { describe, expect, test } from 'vitest';
import { sorts } from '../fleet';
import type { AgentStream, Change, SailNext, FleetVessel, Timeline } from '../api/types';
import AgentPanel from './AgentPanel.svelte';
import SailNextPanel from './SailNextPanel.svelte';
import TimeLanes from './timeline/TimeLanes.svelte';
import TimelinePanel from './TimelinePanel.svelte';
import FleetRow from './fleet/FleetRow.svelte';
import Worst from './Worst.svelte';
import { words } from './testing';

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
    azimuths: {
      standard_error_deg: 0.7,
      band: band(1.2),
      after_one: band(0.96),
      after_twenty: band(0.44),
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
    expect(shown).toContain(
      'Take an azimuth Only azimuths show the error of the gyro or satellite compass itself. One, of the sun or of a transit, would narrow the band here from ± 1.2° to ± 1.0°; twenty in the course of a voyage to ± 0.4°.',
    );
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
    expect(shown).toContain('Take an azimuth');
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
    last_week: { batches: 28, octets: 12_400, longest_wait_s: 5 * 3600 + 60 },
    aboard: { batches_waiting: 12, budget_left_percent: -40, at: '2026-11-20T06:00:00Z' },
  };

  test('tell how their link did of late', () => {
    const shown = words(render(AgentPanel, { props: { agents: [agent] } }));
    expect(shown).toMatch(/Link, last 7 days 28 batches, 12.400 octets/);
    expect(shown).toContain('Longest wait for the link 5 h');
    const silent = { ...agent, last_week: { batches: 0, octets: 0, longest_wait_s: null } };
    const still = words(render(AgentPanel, { props: { agents: [silent] } }));
    expect(still).toContain('Link, last 7 days nothing came');
    expect(still).not.toContain('Longest wait');
  });

  test('tell what waits on board, and how short the budget of the link is', () => {
    const shown = (aboard: AgentStream['aboard']) =>
      words(render(AgentPanel, { props: { agents: [{ ...agent, aboard }] } }));
    expect(shown(agent.aboard)).toContain(
      'Waiting on board 12 batches as of 20 Nov 2026, 06:00 UTC Budget of the link overdrawn by 40 % of a day’s',
    );
    const well = { batches_waiting: 0, budget_left_percent: null, at: '2026-11-20T06:00:00Z' };
    expect(shown(well)).toMatch(/Waiting on board nothing as of .* Budget of the link not short/);
    expect(shown({ ...well, budget_left_percent: 37 })).toContain('37 % of a day’s left');
    const unknown = 'not known: neither short bursts nor older agents say it';
    expect(shown(null)).toContain(`Waiting on board ${unknown} Budget of the link ${unknown}`);
    const later = { ...agent, last_upload_at: '2026-11-21T06:00:00Z' };
    expect(words(render(AgentPanel, { props: { agents: [later] } }))).toContain(
      'as of 20 Nov 2026, 06:00 UTC; what came later did not say, as short bursts do not',
    );
    const first = { ...agent, aboard: null, batches: 0 };
    expect(words(render(AgentPanel, { props: { agents: [first] } }))).toContain(
      'Waiting on board not known before the first batch Budget of the link not known before',
    );
  });

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
    interference: [],
    tags: [],
    model: { version: 2, rms_deg: 0.42, data_until: '2026-11-01T06:00:00Z', cautions: 1 },
    worst: { compass_deg: 45, deviation_deg: -6.2, band95_deg: 0.4 },
    open_alerts: 3,
    next_call: null,
    alert: {
      id: '0b8e6c7e-1f3d-4a5c-9c2b-7d1e2f3a4b5c',
      cause: 'deviation_over_limit',
      severity: 'critical',
      state: 'raised',
      summary: 'The deviation exceeds 5°.',
    },
  };
  const row = { vessel, chosen: false, choose: () => undefined, duesKnown: true, columns: sorts };
  const shown = words(render(FleetRow, { props: row }));
  expect(shown).toContain('MV Arcturus EAVN Critical Deviation over the limit and 2 more');
  expect(shown).toContain('6.2° W large on 045°, ± 0.4° (95 %)');
  expect(shown).toContain('fair residuals 0.4°');
  expect(shown).toContain('nothing uploaded yet');
  const calm = { ...vessel, alert: null, open_alerts: 0, worst: null, model: null };
  const said = words(render(FleetRow, { props: { ...row, vessel: calm } }));
  expect(said).toContain('nothing No model yet none yet');
  // Before it is known what is due she may need more.
  const early = words(render(FleetRow, { props: { ...row, vessel: calm, duesKnown: false } }));
  expect(early).toContain('not known yet No model yet');
  expect(early).not.toContain('nothing No model');
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
    notices: [],
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
    withdrawn: false,
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
      'Largest change of deviation, where the vessel was then changed by 6.2°',
      'Permanent field fore-and-aft, forward positive changed by +3.0 ± 0.1 µT',
      'Permanent field athwartships, starboard positive changed by −2.0 ± 0.1 µT',
      'Found 2 h after that.',
      'It began at sea.',
      'Lightning or a shock 96 %, all but certain',
      'Magnetic cargo 4 %, unlikely',
    ]) {
      expect(said).toContain(part);
    }
    expect(said).not.toContain('Slow drift');
  });

  test('says that a change was withdrawn, and that nothing changed', () => {
    const none: Change = {
      ...struck,
      confirmed: false,
      withdrawn: true,
      deviation_change_deg: null,
      step: null,
      ended: '2026-11-19T06:00:00Z',
    };
    const said = shown({ ...calm, changes: [none] });
    expect(said).toContain('Lightning or a shock withdrawn 19 Nov 2026, 06:00 UTC');
    expect(said).not.toContain('not certain yet');
    expect(said).toContain('The ship’s own magnetism did not change.');
  });

  test('says what an entry that nobody closed does to the samples', () => {
    const said = shown({ ...calm, notices: ['612 samples are left out of the model'] });
    expect(said).toContain('612 samples are left out of the model.');
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
    expect(said).toContain('As far as can be told yet, the ship’s own magnetism did not change.');
  });
});

describe('the lanes of the time axis', () => {
  const call = {
    key: 'call',
    lane: 'calls' as const,
    fromMs: 400,
    toMs: 600,
    title: 'Rotterdam',
    when: '9 Nov',
    more: '',
    at: '',
    grave: false,
  };
  const range = { fromMs: 0, toMs: 1000 };

  test('have no marks before their width is known: they would be wider than the page', () => {
    const props = { marks: [call], range, chosen: null, choose: () => undefined };
    const { body } = render(TimeLanes, { props });
    expect(body).toContain('time-lanes');
    expect(body).not.toContain('Rotterdam');
  });
});
