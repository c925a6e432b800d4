import { describe, expect, it } from 'vitest';
import type { AzimuthResult } from './api/types';
import { azimuthOf, fault, inWords, newDraft, uses, type Draft } from './azimuths';

const now = new Date('2026-11-20T10:00:07Z');
const draft = (changes: Partial<Draft> = {}): Draft => ({
  ...newDraft(now, { lat: 43.4, lon: -3.1 }),
  compass_heading_deg: '092.0',
  compass_bearing_deg: '150,5',
  observer: ' LW ',
  ...changes,
});

describe('the form of azimuths', () => {
  it('begins with the sun, now, where the vessel was last', () => {
    expect(azimuthOf(draft())).toMatchObject({
      kind: 'sun_azimuth',
      time: '2026-11-20T10:00:07.000Z',
      lat: 43.4,
      lon: -3.1,
      compass_heading_deg: 92,
      compass_bearing_deg: 150.5,
      gyro_heading_deg: null,
      observer: 'LW',
      confirmed: false,
    });
    expect(fault(draft())).toBeNull();
  });

  it('leaves out what the kind of bearing does not use', () => {
    const quay = draft({ kind: 'quay', name: 'Muelle A3', true_bearing_deg: '95' });
    expect(fault(quay)).toBeNull();
    expect(azimuthOf(quay)).toMatchObject({
      compass_bearing_deg: null,
      horizon: null,
      altitude_deg: null,
      name: 'Muelle A3',
    });
    expect(uses(draft({ kind: 'sun_amplitude' }), 'height_of_eye_m')).toBe(false);
    expect(uses(draft({ kind: 'sun_amplitude', horizon: 'centre' }), 'height_of_eye_m')).toBe(true);
  });

  it.each<[keyof Draft, Partial<Draft>]>([
    ['time', { time: '' }],
    ['lat', { lat: '95 N' }],
    ['lon', { lon: '' }],
    ['compass_heading_deg', { compass_heading_deg: '' }],
    ['compass_heading_deg', { compass_heading_deg: 'east' }],
    ['compass_bearing_deg', { compass_bearing_deg: '' }],
    ['observer', { observer: ' ' }],
    ['name', { kind: 'body', true_bearing_deg: '9' }],
    ['true_bearing_deg', { kind: 'body', name: 'Vega' }],
    ['height_of_eye_m', { kind: 'sun_amplitude', horizon: 'upper_limb' }],
  ])('names the field %s that is wrong', (field, changes) => {
    expect(fault(draft(changes))?.field).toBe(field);
  });

  it('takes a bearing by gyro for one by compass', () => {
    const byGyro = { compass_bearing_deg: '', gyro_bearing_deg: '152', gyro_heading_deg: '94' };
    expect(fault(draft(byGyro))).toBeNull();
  });

  it('says the errors with their sides', () => {
    const result: AzimuthResult = {
      true_bearing_deg: 152.3,
      altitude_deg: 22,
      compass_error_deg: -2.3,
      variation_deg: 0.4,
      deviation_deg: -2.7,
      gyro_error_deg: 0.3,
      true_heading_deg: 89.7,
      standard_error_deg: 0.6,
      cautions: [],
    };
    expect(inWords(result)).toBe(
      'Compass error 2.3° W · deviation 2.7° W, variation 0.4° E · gyro error 0.3° E · true bearing 152.3°',
    );
    expect(inWords({ ...result, gyro_error_deg: null })).not.toContain('gyro');
  });
});
