/** Two deviation curves on one picture: before a change and after it. */

import * as Plot from '@observablehq/plot';
import type { DeviationRow } from '../api/types';
import type { Pair } from '../changes';
import { compassPoint, eastWest, heading, plusMinus } from '../format';
import { closed } from '../science/curve';
import * as text from '../text';
import { colours, comparedHeight, sideTick, spanned } from './common';

const low = (row: DeviationRow) => row.deviation_deg - (row.band95_deg ?? 0);
const high = (row: DeviationRow) => row.deviation_deg + (row.band95_deg ?? 0);

export function drawCompared(pairs: Pair[], width: number): Element {
  const rows = (which: 'before' | 'after') => closed(pairs.flatMap((pair) => pair[which] ?? []));
  const [before, after] = [rows('before'), rows('after')];
  const narrow = width < 520;
  const headings = [0, 45, 90, 135, 180, 225, 270, 315, 360].filter((d) => !narrow || d % 90 === 0);
  const all = [...before, ...after];
  return Plot.plot({
    width,
    height: comparedHeight(width),
    marginLeft: 48,
    marginRight: 14,
    marginTop: 26,
    marginBottom: 62,
    style: { fontSize: '12px', fontVariant: 'tabular-nums' },
    x: {
      domain: [0, 360],
      ticks: headings,
      tickFormat: (d: number) => `${heading(d)}\n${compassPoint(d)}`,
      label: text.deviation.axisX,
      labelAnchor: 'center',
      labelArrow: 'none',
      labelOffset: 56,
      tickSize: 5,
    },
    y: {
      domain: spanned(
        all.flatMap((row) => [low(row), high(row)]),
        [],
        1.5,
      ),
      nice: true,
      ticks: narrow ? 5 : 7,
      tickFormat: sideTick,
      tickSize: 0,
      label: text.deviation.axisY,
      labelArrow: 'none',
    },
    marks: [
      Plot.gridX(headings.slice(1, -1), { stroke: colours.grid, strokeOpacity: 1 }),
      Plot.gridY({ ticks: narrow ? 5 : 7, stroke: colours.grid, strokeOpacity: 1 }),
      Plot.ruleY([0], { stroke: colours.axis, strokeWidth: 1 }),
      ...curve(before, colours.sample, '6 4'),
      ...curve(after, colours.curve),
      Plot.ruleX(pairs, Plot.pointerX({ x: 'compass_deg', stroke: colours.axis })),
      Plot.tip(
        pairs,
        Plot.pointerX({
          x: 'compass_deg',
          y: (pair: Pair) => (pair.after ?? pair.before)?.deviation_deg ?? 0,
          title: (pair: Pair) =>
            text.changes.tip(heading(pair.compass_deg), said(pair.before), said(pair.after)),
          fill: colours.surface,
          stroke: colours.axis,
          fontSize: 12,
        }),
      ),
    ],
  });
}

function said(row: DeviationRow | null): string {
  return row ? `${eastWest(row.deviation_deg)} ${plusMinus(row.band95_deg)}` : eastWest(null);
}

function curve(rows: DeviationRow[], stroke: string, strokeDasharray?: string): Plot.Markish[] {
  if (rows.length === 0) return [];
  const banded = rows.filter((row) => typeof row.band95_deg === 'number');
  const dashes = strokeDasharray === undefined ? {} : { strokeDasharray };
  return [
    Plot.areaY(banded, {
      x: 'compass_deg',
      y1: low,
      y2: high,
      fill: stroke,
      fillOpacity: 0.16,
      curve: 'natural',
    }),
    Plot.lineY(rows, {
      x: 'compass_deg',
      y: 'deviation_deg',
      stroke,
      strokeWidth: 2.5,
      curve: 'natural',
      ...dashes,
    }),
  ];
}
