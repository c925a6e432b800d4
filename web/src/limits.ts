/** A vessel's settings as a form has them, and read from it. Pure functions. */

import type { VesselSettings } from './api/types';

/** A figure of the settings: where it stands, its range, and what holds if nobody says otherwise. */
export interface Figure {
  part: 'alerts' | 'analysis' | 'agent';
  name: string;
  low: number;
  high: number;
  usual: number;
  /** How many of the settings' own units are one of the form's. */
  per: number;
  whole?: boolean;
}

const figure = (
  part: Figure['part'],
  name: string,
  range: [number, number],
  usual: number,
  rest: Partial<Figure> = {},
): Figure => ({ part, name, low: range[0], high: range[1], usual, per: 1, ...rest });

/** In the form's units; the ranges are the server's. */
export const figures: readonly Figure[] = [
  figure('alerts', 'deviation_deg', [1, 45], 5),
  figure('alerts', 'band95_deg', [0.5, 45], 3),
  figure('alerts', 'silent_days', [0.25, 365], 3),
  figure('analysis', 'reference_constant_sd_deg', [0, 10], 0.5),
  figure('agent', 'min_sog_kn', [0, 50], 4),
  figure('agent', 'max_rate_of_turn_deg_min', [0.1, 360], 18),
  figure('agent', 'settle_s', [0, 7200], 180, { whole: true }),
  figure('agent', 'max_swing_deg', [0.1, 45], 2),
  figure('agent', 'sample_s', [10, 86_400], 600, { whole: true }),
  figure('agent', 'seal_s', [0.01, 720], 6, { per: 3600 }),
];

type Values = Record<string, unknown>;

/** What stands in the fields, by the figures' names. */
export function written(settings: VesselSettings): Record<string, string> {
  return Object.fromEntries(
    figures.map(({ part, name, per, usual }) => {
      const value = (settings[part] as Values | undefined)?.[name];
      return [name, typeof value === 'number' ? shown(value / per) : shown(usual)];
    }),
  );
}

const shown = (value: number): string => String(Number(value.toFixed(3)));

/** The settings with what is written; the first figure that cannot be where one cannot. */
export function settingsOf(
  before: VesselSettings,
  typed: Record<string, string>,
): VesselSettings | { wrong: Figure } {
  const parts: Record<Figure['part'], Values> = {
    alerts: { ...before.alerts },
    analysis: { ...before.analysis },
    agent: { ...before.agent },
  };
  const was = written(before);
  for (const each of figures) {
    const { part, name, low, high, per, whole } = each;
    const words = (typed[name] ?? '').trim().replace(',', '.');
    // What was not touched keeps the figures that a field does not show.
    if (words === was[name] && parts[part][name] !== undefined) continue;
    const value = Number(words);
    const inRange = words !== '' && value >= low && value <= high;
    if (!inRange || (whole && !Number.isInteger(value))) return { wrong: each };
    parts[part][name] = per === 1 ? value : Math.round(value * per);
  }
  return { ...before, ...parts } as unknown as VesselSettings;
}
