/**
 * Deviation over time on some headings, all at one place: what each epoch's curve says, and
 * each sample as far from that as it was from the model where it was taken. Pure.
 */

import type { DeviationRow, Epoch, SampleDots, Timeline } from '../api/types';
import type { Range } from '../timeline';

/** The deviation on one heading through an epoch. */
export interface Stretch {
  fromMs: number;
  toMs: number;
  deviationDeg: number;
  /** Half the width of the 95 % band; none without a covariance. */
  band95Deg: number | null;
}

export interface HistoryDot {
  timeMs: number;
  deviationDeg: number;
  used: boolean;
}

/** One heading's deviation over time. */
export interface HistoryLine {
  compassDeg: number;
  stretches: Stretch[];
  dots: HistoryDot[];
}

/** Headings to choose from: rows of the epochs' curves. */
export const headingsDeg = [0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330];
/** A sample this near to a heading is drawn with it, degrees. */
const nearDeg = 15;

const rowOn = (epoch: Epoch, compassDeg: number): DeviationRow | undefined =>
  epoch.curve?.find((row) => row.compass_deg === compassDeg);

const startOf = ({ from }: Epoch): number => (from === null ? -Infinity : Date.parse(from));
const endOf = ({ to }: Epoch): number => (to === null ? Infinity : Date.parse(to));

/** How far two headings are apart, degrees. */
const apart = (a: number, b: number): number => Math.abs(((a - b + 540) % 360) - 180);

export function historyOf(
  { epochs }: Timeline,
  samples: SampleDots,
  headings: readonly number[],
  range: Range,
): HistoryLine[] {
  return headings.map((compassDeg) => ({
    compassDeg,
    stretches: epochs.flatMap((epoch) => stretchOf(epoch, compassDeg, range)),
    dots: dotsNear(epochs, samples, compassDeg, range),
  }));
}

function stretchOf(epoch: Epoch, compassDeg: number, range: Range): Stretch[] {
  const row = rowOn(epoch, compassDeg);
  const fromMs = Math.max(startOf(epoch), range.fromMs);
  const toMs = Math.min(endOf(epoch), range.toMs);
  if (!row || fromMs >= toMs) return [];
  return [{ fromMs, toMs, deviationDeg: row.deviation_deg, band95Deg: row.band95_deg }];
}

function dotsNear(
  epochs: readonly Epoch[],
  samples: SampleDots,
  compassDeg: number,
  range: Range,
): HistoryDot[] {
  return samples.unix_s.flatMap((seconds, i) => {
    const timeMs = seconds * 1000;
    const residual = samples.residual_deg[i] ?? null;
    const near = apart(samples.compass_deg[i] ?? NaN, compassDeg) <= nearDeg;
    if (!near || residual === null || timeMs < range.fromMs || timeMs > range.toMs) return [];
    const epoch = epochs.find((one) => startOf(one) <= timeMs && timeMs < endOf(one));
    const row = epoch && rowOn(epoch, compassDeg);
    if (!row) return [];
    const deviationDeg = row.deviation_deg + residual;
    return [{ timeMs, deviationDeg, used: samples.used[i] ?? false }];
  });
}
