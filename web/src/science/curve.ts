/** What a table of deviations says in a few words, and what grade that is. */

import type { DeviationRow } from '../api/types';

export interface Extremes {
  largest: DeviationRow;
  mostEast: DeviationRow;
  mostWest: DeviationRow;
  narrowest95: number | null;
  widest95: number | null;
}

export function extremes(rows: DeviationRow[]): Extremes | null {
  const [first] = rows;
  if (!first) return null;
  const pick = (better: (a: DeviationRow, b: DeviationRow) => boolean) =>
    rows.reduce((best, row) => (better(row, best) ? row : best), first);
  const bands = rows.flatMap((row) => (typeof row.band95_deg === 'number' ? [row.band95_deg] : []));
  return {
    largest: pick((a, b) => Math.abs(a.deviation_deg) > Math.abs(b.deviation_deg)),
    mostEast: pick((a, b) => a.deviation_deg > b.deviation_deg),
    mostWest: pick((a, b) => a.deviation_deg < b.deviation_deg),
    narrowest95: bands.length > 0 ? Math.min(...bands) : null,
    widest95: bands.length > 0 ? Math.max(...bands) : null,
  };
}

/** Rows on every multiple of `stepDeg`, as a card prints them. */
export function everyStep(rows: DeviationRow[], stepDeg: number): DeviationRow[] {
  return rows.filter((row) => row.compass_deg < 360 && row.compass_deg % stepDeg === 0);
}

/** The rows with north repeated at 360°, so that a drawn curve closes. */
export function closed(rows: DeviationRow[]): DeviationRow[] {
  const north = rows.find((row) => row.compass_deg === 0);
  if (!north || rows.some((row) => row.compass_deg === 360)) return rows;
  return [...rows, { ...north, compass_deg: 360 }];
}

/** The deviation between two rows, for a sample's own heading. */
export function deviationAt(rows: DeviationRow[], compassDeg: number): number | null {
  const all = closed(rows);
  for (let i = 1; i < all.length; i++) {
    const [left, right] = [all[i - 1], all[i]];
    if (!left || !right || compassDeg > right.compass_deg) continue;
    const t = (compassDeg - left.compass_deg) / (right.compass_deg - left.compass_deg);
    return left.deviation_deg + t * (right.deviation_deg - left.deviation_deg);
  }
  return null;
}

export type Grade = 'small' | 'notable' | 'large';

/** Most flags ask for an adjustment above 5° on any heading (AMSA, Marshall Islands). */
export function grade(deviationDeg: number): Grade {
  const size = Math.abs(deviationDeg);
  if (size > 5) return 'large';
  return size > 3 ? 'notable' : 'small';
}
