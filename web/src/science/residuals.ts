/** The dots of a picture of samples, and its means as an axis wants them. */

import type { SampleDots, SamplePicture } from '../api/types';

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

/** A sample as it is drawn. */
export interface SampleDot {
  compassDeg: number;
  deviationDeg: number;
  residualDeg: number | null;
  used: boolean;
}

/** The dots as rows. */
export const dotsOf = (dots: SampleDots): SampleDot[] =>
  dots.compass_deg.map((compassDeg, i) => ({
    compassDeg,
    deviationDeg: dots.deviation_deg[i] ?? NaN,
    residualDeg: dots.residual_deg[i] ?? null,
    used: dots.used[i] ?? false,
  }));

export const residualsOf = (dots: SampleDots): Residual[] =>
  dots.unix_s.flatMap((seconds, i) => {
    const residualDeg = dots.residual_deg[i] ?? null;
    if (residualDeg === null) return [];
    return [{ time: new Date(seconds * 1000), residualDeg, used: dots.used[i] ?? false }];
  });

export const intervalsOf = (picture: SamplePicture): Interval[] =>
  picture.intervals.map((interval) => {
    const from = new Date(interval.from);
    return {
      from,
      to: new Date(from.getTime() + picture.interval_days * dayMs),
      samples: interval.samples,
      meanDeg: interval.mean_deg,
      rmsDeg: interval.rms_deg,
    };
  });

/** At most `most` of the values, evenly picked and in their order. */
export function thinned<T>(values: T[], most: number): T[] {
  if (values.length <= most) return values;
  const step = values.length / most;
  return Array.from({ length: most }, (_, i) => values[Math.floor(i * step)] as T);
}
