import { describe, expect, test } from 'vitest';
import { delay, lines, mostParted, pairs, sampledSince, sizes, sureness, when } from './changes';
import type { Change, DeviationRow, Epoch, LogbookEntry, Timeline } from './api/types';

const curve = (deviation_deg: number): DeviationRow[] =>
  [0, 90, 180, 270].map((compass_deg) => ({
    compass_deg,
    magnetic_deg: compass_deg + deviation_deg,
    deviation_deg: compass_deg === 90 ? 3 * deviation_deg : deviation_deg,
    band95_deg: 0.5,
  }));

const epoch = (more: Partial<Epoch>): Epoch => ({
  from: null,
  to: null,
  begun_by: null,
  begun_by_change: null,
  resumes: null,
  data_from: '2026-10-20T00:00:00Z',
  data_until: '2026-11-08T00:00:00Z',
  model_version: 1,
  rms_deg: 0.3,
  samples_used: 400,
  curve: curve(1),
  refusal: null,
  ...more,
});

const struck: Change = {
  from: '2026-11-09T00:00:00Z',
  from_earliest: '2026-11-08T23:40:00Z',
  from_latest: '2026-11-09T00:10:00Z',
  detected_at: '2026-11-09T02:00:00Z',
  confirmed: true,
  withdrawn: false,
  cause: 'lightning_or_shock',
  causes: [{ cause: 'lightning_or_shock', probability: 0.96 }],
  evidence: ['it began at sea'],
  deviation_change_deg: 6.2,
  step: { bx_nt: 3000, by_nt: -2000, bx_se_nt: 120, by_se_nt: 95 },
  ended: null,
  epoch_before: 0,
  epoch_after: 1,
  epoch_ended: null,
};

const timeline: Timeline = {
  compass_id: 'c',
  analysed_at: '2026-11-11T00:00:00Z',
  place: { at: '2026-11-11T00:00:00Z', lat: 48, lon: -6, variation_deg: 0, h_nt: 2e4, z_nt: 4e4 },
  epochs: [
    epoch({ to: struck.from }),
    epoch({ from: struck.from, begun_by_change: 'lightning_or_shock', curve: curve(-1) }),
  ],
  changes: [struck],
  notices: [],
};

const entry = (from: string, more: Partial<LogbookEntry> = {}): LogbookEntry =>
  ({ id: from, kind: 'lightning', from, to: null, withdrawn_at: null, ...more }) as LogbookEntry;

describe('the timeline', () => {
  test('has what happened, the latest first, and each thing once', () => {
    const entries = [
      entry('2026-11-08T23:50:00Z'),
      entry('2026-11-01T00:00:00Z', { withdrawn_at: '2026-11-02T00:00:00Z' }),
      entry('2025-01-01T00:00:00Z'),
    ];
    const kinds = lines(timeline, entries).map((line) => `${line.kind} ${line.at}`);
    expect(kinds).toEqual([
      'change 2026-11-09T00:00:00Z',
      'entry 2026-11-08T23:50:00Z',
      'epoch 2026-10-20T00:00:00Z',
    ]);
  });

  test('begins with the first sample, though a report from before it began an epoch', () => {
    const adjusted = '2026-10-01T00:00:00Z';
    const [first = epoch({}), second = epoch({})] = timeline.epochs;
    const before = epoch({ to: adjusted, data_from: null, data_until: null, curve: null });
    const epochs = [before, { ...first, from: adjusted, begun_by: 'adjustment' as const }, second];
    const shifted = {
      ...timeline,
      epochs,
      changes: [{ ...struck, epoch_before: 1, epoch_after: 2 }],
    };
    expect(sampledSince(shifted)).toBe('2026-10-20T00:00:00Z');
    const kinds = lines(shifted, [entry('2026-11-08T23:50:00Z')]).map((line) => line.kind);
    expect(kinds).toEqual(['change', 'entry', 'epoch']);
  });

  test('is empty before the first analysis', () => {
    const nothing = { ...timeline, epochs: [], changes: [] };
    expect(lines(nothing, [entry('2026-11-08T23:50:00Z')])).toEqual([]);
  });
});

describe('a change', () => {
  test('is dated as well as it is known', () => {
    expect(when(struck)).toBe('some time between 8 Nov 2026, 23:40 UTC and 9 Nov 2026, 00:10 UTC');
    expect(when({ ...struck, from_earliest: '2026-11-09T00:00:00Z' })).toBe(
      'some time between 9 Nov 2026, 00:00 UTC and 00:10 UTC',
    );
    const sharp = { from_earliest: struck.from, from_latest: '2026-11-09T00:01:00Z' };
    expect(when({ ...struck, ...sharp })).toBe('9 Nov 2026, 00:00 UTC');
  });

  test('says how long it took to find', () => {
    const foundAt = (detected_at: string) => delay({ ...struck, detected_at });
    expect(foundAt('2026-11-09T00:00:20Z')).toBeNull();
    expect(foundAt('2026-11-09T00:40:00Z')).toBe('40 min');
    expect(foundAt('2026-11-09T02:10:00Z')).toBe('2 h');
    expect(foundAt('2026-11-12T00:00:00Z')).toBe('3 days');
  });

  test('has the curves of the epochs that it parts', () => {
    const all = pairs(timeline, struck);
    expect(all.map((pair) => pair.compass_deg)).toEqual([0, 90, 180, 270]);
    const most = mostParted(all);
    expect(most?.pair.compass_deg).toBe(90);
    expect(most?.degrees).toBe(-6);
  });

  test('has each figure of its size by its name', () => {
    expect(sizes(timeline, struck)).toEqual([
      { what: 'Largest change of deviation, where the vessel was then', size: 'changed by 6.2°' },
      { what: 'Deviation on 090°, the worst at the last position', size: 'changed by 6.0° W' },
      {
        what: 'Permanent field fore-and-aft, forward positive',
        size: 'changed by +3.0 ± 0.1\u00a0µT',
      },
      {
        what: 'Permanent field athwartships, starboard positive',
        size: 'changed by −2.0 ± 0.1\u00a0µT',
      },
    ]);
    expect(sizes(timeline, { ...struck, cause: 'magnetic_storm' })).toEqual([]);
  });

  test('has one curve while there is no other', () => {
    const [first = epoch({}), second = epoch({})] = timeline.epochs;
    const early = { ...timeline, epochs: [first, { ...second, curve: null }] };
    const all = pairs(early, struck);
    expect(all).toHaveLength(4);
    expect(all.every((pair) => pair.before && !pair.after)).toBe(true);
    expect(mostParted(all)).toBeNull();
    expect(pairs(early, { ...struck, epoch_before: null, epoch_after: null })).toEqual([]);
  });
});

test('words for probabilities', () => {
  expect([0.99, 0.6, 0.2, 0.02].map(sureness)).toEqual([
    'all but certain',
    'likely',
    'possible',
    'unlikely',
  ]);
});
