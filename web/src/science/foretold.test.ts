import { describe, expect, test } from 'vitest';
import type { SamplePicture, WorkOrder, WorkOrderSummary } from '../api/types';
import { version } from '../components/testing';
import { evidence, foretoldOf, standing } from './foretold';
import { sinceAdjustment } from './trust';

const adjusted = '2026-11-23T12:55:25.273Z';
const foretelling = {
  ...{ ...version, foretold_by: 'o', epoch_from: adjusted, lat: -5.08, lon: -81.11 },
  data_from: '2026-11-23T12:43:00Z',
};
const order = { id: 'o', port: 'Paita (PEPAI)', planned_at: '2026-11-23T13:43:30Z' };
const listed = (state: string) => [{ ...order, state } as WorkOrderSummary];
const whole = (verification: object | null) =>
  ({ ...order, state: 'adjusted', verification }) as WorkOrder;
const sea = (verdict: object) => ({
  samples: 12,
  until: '2026-11-25T06:00:00Z',
  verification: verdict,
  words: '',
});

describe('a foretold model', () => {
  test('is not verified before headings at sea agree, and says of which place it is', () => {
    const found = foretoldOf(foretelling, listed('adjusted'), whole(null));
    expect(found?.proof).toBe('none');
    if (!found) return;
    const { title, words } = standing(found);
    expect(title).toBe('Predicted, not verified at sea');
    expect(words).toBe(
      'This curve is foretold: by work order Paita (PEPAI), 23 Nov 2026, from the work done on 23 Nov 2026 at 05° 04.8′ S, 081° 06.6′ W. It is not fitted to any sample. No settled heading has come in since the adjustment.',
    );
    expect(sinceAdjustment(found).figure).toBe('None');
  });

  test('says how many headings are still needed, and which', () => {
    const verdict = {
      ...{ verdict: 'more_needed', headings: 2 },
      needed: { count: 3, compass_deg: [45, 135] },
    };
    const found = foretoldOf(foretelling, [], whole(sea(verdict)));
    expect(found && standing(found).words).toContain(
      '2 headings agree so far; 3 more are needed, best of all on 045°, 135°.',
    );
    expect(found && sinceAdjustment(found).figure).toBe('12');
  });

  test('is verified or disproved by the sea alone', () => {
    const proof = (...given: [WorkOrderSummary[], WorkOrder?]) =>
      foretoldOf(foretelling, given[0], given[1])?.proof;
    expect(proof([])).toBe('none');
    expect(proof(listed('verified'))).toBe('verified');
    expect(proof(listed('closed'))).toBe('none');
    expect(proof([], whole(sea({ verdict: 'passed' })))).toBe('verified');
    expect(proof(listed('failed'))).toBe('disproved');
    expect(proof([], whole(sea({ verdict: 'alarm' })))).toBe('disproved');
    // Another order's headings say nothing of this one.
    expect(proof([], { ...whole(sea({ verdict: 'passed' })), id: 'other' })).toBe('none');
  });

  test('is none of a model that was fitted', () => {
    expect(foretoldOf(version, listed('adjusted'), whole(null))).toBeNull();
    expect(foretoldOf(undefined, [], undefined)).toBeNull();
  });
});

describe('the samples that tell of a model', () => {
  const unix_s = [-3600, -1, 0, 60].map((after) => Math.floor(Date.parse(adjusted) / 1000) + after);
  const picture = {
    dots: {
      unix_s,
      lon: [0, 0, 0, 0],
      compass_deg: [10, 20, 30, 40],
      deviation_deg: [1, 2, 3, 4],
      residual_deg: [0, 0, null, null],
      used: [true, true, false, false],
    },
  } as unknown as SamplePicture;

  test('are none from before the adjustment that foretold it', () => {
    const found = evidence(picture, foretelling);
    expect(found.dots.map(({ compassDeg }) => compassDeg)).toEqual([30, 40]);
    expect(found.earlier).toBe(true);
  });

  test('are those from the first that it was fitted to', () => {
    const from = (data_from: string) => evidence(picture, { ...version, data_from });
    expect(from('2026-09-01T00:00:00Z')).toMatchObject({ earlier: false });
    expect(from('2026-11-23T12:55:24Z').dots).toHaveLength(3);
    expect(evidence(picture, undefined)).toMatchObject({ earlier: false });
  });
});
