/** A vessel's settings: when there are alerts, how samples are read and taken. */

import { translate } from './language';

export const limits = translate('limits', {
  title: 'Alert limits and settings',
  lead: 'From when on there are alerts about her, how her samples are read, and how her agents take them.',
  parts: {
    alerts: 'Alerts',
    analysis: 'How samples are read',
    agent: 'How agents sample and send',
  },
  notes: {
    alerts:
      'A flag state may ask for less: AMSA and the Marshall Islands have the compass adjusted above 5° on any heading.',
    analysis: 'A change has all her samples analysed anew.',
    agent: 'Agents follow with their next message from ashore.',
  },
  fields: {
    deviation_deg: ['Deviation, °', 'An alert is raised when the predicted deviation is larger.'],
    band95_deg: [
      'Uncertainty, ± °',
      'An alert is raised when the 95 % band is wider to each side.',
    ],
    silent_days: ['Silence, days', 'An alert is raised when nothing has come from her for longer.'],
    reference_constant_sd_deg: [
      'Constant error of a reference, °',
      'Standard deviation of what gyro or satellite compass are off all the time.',
    ],
    min_sog_kn: ['Least speed over ground, kn', 'Slower, nothing is sampled.'],
    max_rate_of_turn_deg_min: [
      'Greatest rate of turn, ° a minute',
      'Turning faster, nothing is sampled.',
    ],
    settle_s: ['Settling after a turn, s', 'So long nothing is sampled, until the gyro is steady.'],
    max_swing_deg: ['Greatest swing of heading, °', 'To either side within 30 s.'],
    sample_s: ['Longest sample, s', 'One sample is the mean of at most so long.'],
    seal_s: ['Sent after, h', 'What was sampled is sent when its first sample is this old.'],
  } as Record<string, [label: string, help: string]>,
  usual: (range: string, usual: string) => `${range}; usually ${usual}.`,
  range: (low: string, high: string) => `${low} to ${high}`,
  fieldModel: 'Model of the earth’s field',
  fieldModels: { igrf14: 'IGRF-14 (1900 to 2030)', wmm2025: 'WMM2025 (2025 to 2030)' },
  gyro: 'Speed error of the gyro',
  gyros: {
    corrected: 'The gyro takes it out itself',
    uncorrected: 'The gyro does not: the analysis does',
  },
  more: 'How samples are taken and read',
  change: 'Change the settings',
  save: 'Save the settings',
  saving: 'Saving…',
  saved: 'The settings are saved.',
  wrong: (field: string, range: string, whole: boolean) =>
    `“${field}” is ${whole ? 'a whole number' : 'a number'} from ${range}.`,
});
