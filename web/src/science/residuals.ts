/** Residuals gathered by day or week, and thinned for drawing. */

import type { Sample } from '../api/types';

export interface Interval {
  from: Date;
  to: Date;
  samples: number;
  meanDeg: number;
  rmsDeg: number;
}

const dayMs = 86_400_000;

export interface Residual {
  time: Date;
  residualDeg: number;
  used: boolean;
}

export function residualsOf(samples: Sample[]): Residual[] {
  return samples.flatMap((sample) =>
    typeof sample.residual_deg === 'number'
      ? [{ time: new Date(sample.time), residualDeg: sample.residual_deg, used: sample.used }]
      : [],
  );
}

/** By UTC day up to 31 days, by week from the first day beyond; only used samples count. */
export function byInterval(residuals: Residual[]): { days: 1 | 7; intervals: Interval[] } {
  const used = residuals.filter((residual) => residual.used);
  const times = used.map((residual) => residual.time.getTime());
  const first = Math.floor(least(times) / dayMs) * dayMs;
  const days = greatest(times) - first > 31 * dayMs ? 7 : 1;
  const groups = new Map<number, number[]>();
  for (const { time, residualDeg } of used) {
    const index = Math.floor((time.getTime() - first) / (days * dayMs));
    const group = groups.get(index);
    if (group) group.push(residualDeg);
    else groups.set(index, [residualDeg]);
  }
  const intervals = [...groups]
    .sort(([a], [b]) => a - b)
    .map(([index, values]) => ({
      from: new Date(first + index * days * dayMs),
      to: new Date(first + (index + 1) * days * dayMs),
      samples: values.length,
      meanDeg: mean(values),
      rmsDeg: rms(values),
    }));
  return { days, intervals };
}

export function mean(values: number[]): number {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}

export function rms(values: number[]): number {
  return Math.sqrt(mean(values.map((value) => value * value)));
}

// Spreading thousands of values into Math.min would overflow the stack.
function least(values: number[]): number {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}

function greatest(values: number[]): number {
  return values.reduce((a, b) => Math.max(a, b), -Infinity);
}

/** At most `most` of the values, evenly picked and in their order. */
export function thinned<T>(values: T[], most: number): T[] {
  if (values.length <= most) return values;
  const step = values.length / most;
  return Array.from({ length: most }, (_, i) => values[Math.floor(i * step)] as T);
}
