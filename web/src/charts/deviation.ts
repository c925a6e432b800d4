/** The deviation curve: band, samples and line against compass heading. */

import * as Plot from '@observablehq/plot';
import type { DeviationRow } from '../api/types';
import { compassPoint, eastWest, fineHeading, heading, plusMinus } from '../format';
import { closed } from '../science/curve';
import * as text from '../text';
import { colours, deviationHeight, sideTick, spanned } from './common';
import { crosses, dots as dotted } from './dots';

export interface Dot {
  compassDeg: number;
  deviationDeg: number;
  used: boolean;
}

export function drawDeviation(rows: DeviationRow[], dots: Dot[], width: number): Element {
  const line = closed(rows);
  const banded = line.filter((row) => typeof row.band95_deg === 'number');
  const low = (row: DeviationRow) => row.deviation_deg - (row.band95_deg ?? 0);
  const high = (row: DeviationRow) => row.deviation_deg + (row.band95_deg ?? 0);
  const narrow = width < 520;
  const at = (used: boolean) =>
    dots
      .filter((dot) => dot.used === used)
      .map(({ compassDeg, deviationDeg }) => ({ x: compassDeg, y: deviationDeg }));
  return Plot.plot({
    width,
    height: deviationHeight(width),
    marginLeft: 48,
    marginRight: 14,
    marginTop: 30,
    marginBottom: 62,
    style: { fontSize: '12px', fontVariant: 'tabular-nums' },
    x: {
      domain: [0, 360],
      ticks: [0, 45, 90, 135, 180, 225, 270, 315, 360].filter((d) => !narrow || d % 90 === 0),
      tickFormat: (d: number) => `${heading(d)}\n${compassPoint(d)}`,
      label: text.deviation.axisX,
      labelAnchor: 'center',
      labelArrow: 'none',
      labelOffset: 56,
      tickSize: 5,
    },
    y: {
      domain: spanned(
        line.flatMap((row) => [low(row), high(row)]),
        dots.map((dot) => dot.deviationDeg),
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
      Plot.gridX(
        [45, 90, 135, 180, 225, 270, 315].filter((d) => !narrow || d % 90 === 0),
        {
          stroke: colours.grid,
          strokeOpacity: 1,
        },
      ),
      Plot.gridY({ ticks: narrow ? 5 : 7, stroke: colours.grid, strokeOpacity: 1 }),
      Plot.ruleY([0], { stroke: colours.axis, strokeWidth: 1 }),
      dotted(at(true), narrow ? 1.8 : 2.2, colours.sample, 0.45),
      crosses(at(false), colours.unused),
      Plot.areaY(banded, {
        x: 'compass_deg',
        y1: low,
        y2: high,
        fill: colours.curve,
        fillOpacity: 0.18,
        curve: 'natural',
      }),
      Plot.lineY(banded, { x: 'compass_deg', y: low, ...edge }),
      Plot.lineY(banded, { x: 'compass_deg', y: high, ...edge }),
      Plot.lineY(line, {
        x: 'compass_deg',
        y: 'deviation_deg',
        stroke: colours.curve,
        strokeWidth: 2.5,
        curve: 'natural',
      }),
      Plot.ruleX(line, Plot.pointerX({ x: 'compass_deg', stroke: colours.axis })),
      Plot.dot(
        line,
        Plot.pointerX({
          x: 'compass_deg',
          y: 'deviation_deg',
          r: 4.5,
          fill: colours.curve,
          stroke: colours.surface,
          strokeWidth: 2,
        }),
      ),
      Plot.tip(
        line,
        Plot.pointerX({
          x: 'compass_deg',
          y: 'deviation_deg',
          title: (row: DeviationRow) =>
            text.deviation.tip(
              heading(row.compass_deg),
              eastWest(row.deviation_deg),
              plusMinus(row.band95_deg),
              fineHeading(row.magnetic_deg),
            ),
          fill: colours.surface,
          stroke: colours.axis,
          fontSize: 12,
        }),
      ),
    ],
  });
}

const edge = {
  stroke: colours.curve,
  strokeOpacity: 0.45,
  strokeWidth: 1,
  curve: 'natural',
} as const;
