/**
 * Coverage as a compass rose: north up, headings clockwise, a ring for each band of
 * magnetic latitude with the northernmost outside. Pure functions; the radius is 100.
 */

import type { HeadingRange } from '../api/types';
import type { CoverageTable } from './coverage';

/** The middle stays free: rings that meet in a point show nothing. */
const hole = 30;
const rim = 100;

export interface Ring {
  fromDeg: number;
  toDeg: number;
  inner: number;
  outer: number;
  cells: { fromDeg: number; samples: number; path: string }[];
}

export function rings({ bands, headings, stepDeg }: CoverageTable): Ring[] {
  const wide = (rim - hole) / bands.length;
  return bands.map(({ fromDeg, toDeg, samples }, i) => {
    const [inner, outer] = [rim - (i + 1) * wide, rim - i * wide];
    const cells = headings.map((heading, sector) => ({
      fromDeg: heading,
      samples: samples[sector] ?? 0,
      path: sectorPath(heading, heading + stepDeg, inner, outer),
    }));
    return { fromDeg, toDeg, inner, outer, cells };
  });
}

/** An arc around the rose for each range of headings; through north where it goes that way. */
export const arcs = (ranges: readonly HeadingRange[], inner: number, outer: number): string[] =>
  ranges.map(({ heading_from_deg: from, heading_to_deg: to }) =>
    sectorPath(from, to > from ? to : to + 360, inner, outer),
  );

/** A piece of a ring between two headings, of at most a whole turn. */
export function sectorPath(fromDeg: number, toDeg: number, inner: number, outer: number): string {
  // A whole turn begins where it ends, and such an arc is none: two halves are.
  if (toDeg - fromDeg >= 360) {
    const middle = fromDeg + 180;
    return (
      sectorPath(fromDeg, middle, inner, outer) + sectorPath(middle, fromDeg + 360, inner, outer)
    );
  }
  const large = toDeg - fromDeg > 180 ? 1 : 0;
  return [
    `M${pointAt(fromDeg, outer)}`,
    `A${outer} ${outer} 0 ${large} 1 ${pointAt(toDeg, outer)}`,
    `L${pointAt(toDeg, inner)}`,
    `A${inner} ${inner} 0 ${large} 0 ${pointAt(fromDeg, inner)}Z`,
  ].join('');
}

/** Where a heading meets a circle; y grows downward. */
export function pointAt(headingDeg: number, radius: number): string {
  const angle = (headingDeg * Math.PI) / 180;
  const round = (value: number) => Math.round(value * 100) / 100 + 0;
  return `${round(radius * Math.sin(angle))} ${round(-radius * Math.cos(angle))}`;
}

/** How dark a cell is, 0 to 1: few samples still show, ten times as many a step darker. */
export function shade(samples: number, most: number): number {
  if (samples === 0) return 0;
  return 0.18 + 0.82 * (Math.log1p(samples) / Math.log1p(most));
}
