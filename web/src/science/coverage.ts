/** Coverage as a table: bands of magnetic latitude by sectors of heading. */

import type { Coverage } from '../api/types';
import { typed } from '../format';
import * as text from '../text';

export interface CoverageTable {
  headings: number[];
  stepDeg: number;
  bands: { fromDeg: number; toDeg: number; samples: number[]; total: number }[];
  totals: number[];
  most: number;
}

/** Bands from north to south without holes between them; sectors all round. */
export function coverageTable(coverage: Coverage): CoverageTable {
  const stepDeg = coverage.heading_step_deg;
  const bandDeg = coverage.magnetic_latitude_step_deg;
  const headings = Array.from({ length: Math.round(360 / stepDeg) }, (_, i) => i * stepDeg);
  const samples = new Map(
    coverage.cells.map((cell) => [
      `${cell.magnetic_latitude_from_deg}/${cell.heading_from_deg}`,
      cell.samples,
    ]),
  );
  const edges = coverage.cells.map((cell) => cell.magnetic_latitude_from_deg);
  const bands: CoverageTable['bands'] = [];
  for (let from = Math.max(...edges); from >= Math.min(...edges); from -= bandDeg) {
    const row = headings.map((heading) => samples.get(`${from}/${heading}`) ?? 0);
    bands.push({ fromDeg: from, toDeg: from + bandDeg, samples: row, total: sum(row) });
  }
  return {
    headings,
    stepDeg,
    bands,
    totals: headings.map((_, i) => sum(bands.map((band) => band.samples[i] ?? 0))),
    most: Math.max(0, ...bands.flatMap((band) => band.samples)),
  };
}

/** Sectors without any sample, joined where they touch, also across north. */
export function gaps(table: CoverageTable): { fromDeg: number; toDeg: number }[] {
  const { totals, stepDeg } = table;
  const sectors = totals.length;
  const found: { fromDeg: number; toDeg: number }[] = [];
  const firstFilled = totals.findIndex((total) => total > 0);
  if (firstFilled === -1) return [{ fromDeg: 0, toDeg: 360 }];
  for (let step = 0; step < sectors; step++) {
    const sector = (firstFilled + step) % sectors;
    if ((totals[sector] ?? 0) > 0) continue;
    const fromDeg = sector * stepDeg;
    const last = found.at(-1);
    if (last && last.toDeg % 360 === fromDeg) last.toDeg = fromDeg + stepDeg;
    else found.push({ fromDeg, toDeg: fromDeg + stepDeg });
  }
  return found;
}

/** `40° N`; the equator has no side. */
export function magneticLatitude(value: number): string {
  const size = `${typed(Math.abs(value))}°`;
  if (value === 0) return size;
  return value < 0 ? text.coverage.south(size) : text.coverage.north(size);
}

function sum(values: number[]): number {
  return values.reduce((total, value) => total + value, 0);
}
