import { describe, expect, test } from 'vitest';
import type { VesselSettings } from './api/types';
import { figures, settingsOf, written } from './limits';

const settings = {
  agent: {
    version: 3,
    min_sog_kn: 4,
    max_rate_of_turn_deg_min: 18,
    settle_s: 180,
    max_swing_deg: 2,
    sample_s: 600,
    seal_s: 20_001,
  },
  analysis: {
    field_model: 'igrf14',
    gyro_speed_error: 'corrected',
    reference_constant_sd_deg: 0.3,
  },
  alerts: { deviation_deg: 5, band95_deg: 3, silent_days: 3 },
} as VesselSettings;
const changed = (typed: Record<string, string>) =>
  settingsOf(settings, { ...written(settings), ...typed });

describe('a vessel’s settings', () => {
  test('stay to the last figure where nothing is written', () => {
    expect(changed({})).toEqual(settings);
  });

  test('take what is written, with a comma too, in the units of the form', () => {
    expect(changed({ deviation_deg: '3,5', seal_s: '12' })).toEqual({
      ...settings,
      alerts: { ...settings.alerts, deviation_deg: 3.5 },
      agent: { ...settings.agent, seal_s: 43_200 },
    });
  });

  test('are not taken out of range, nor in parts of what is whole', () => {
    const wrong = (typed: Record<string, string>) => {
      const said = changed(typed);
      return 'wrong' in said ? said.wrong.name : undefined;
    };
    expect(wrong({ deviation_deg: '0.5' })).toBe('deviation_deg');
    expect(wrong({ band95_deg: '' })).toBe('band95_deg');
    expect(wrong({ silent_days: 'three' })).toBe('silent_days');
    expect(wrong({ settle_s: '10.5' })).toBe('settle_s');
    expect(wrong({ deviation_deg: '45' })).toBeUndefined();
  });

  test('have limits of alerts where a server says none', () => {
    const { agent, analysis } = settings;
    const without: VesselSettings = { agent, analysis };
    expect(written(without)['deviation_deg']).toBe('5');
    expect(settingsOf(without, written(without))).toEqual(settings);
  });

  test('have defaults within their ranges', () => {
    for (const { name, low, high, usual } of figures) {
      expect(usual >= low && usual <= high, name).toBe(true);
    }
  });
});
