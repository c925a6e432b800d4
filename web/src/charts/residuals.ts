/** Residuals over time, with the mean of each day or week. */

import * as Plot from '@observablehq/plot';
import { day } from '../format';
import type { Interval, Residual } from '../science/residuals';
import { text } from '../text';
import { colours, sideTick, spanned } from './common';

export const residualsHeight = (width: number): number => (width < 520 ? 220 : 260);

export function drawResiduals(
  residuals: Residual[],
  intervals: Interval[],
  width: number,
): Element {
  const middle = (interval: Interval) =>
    new Date((interval.from.getTime() + interval.to.getTime()) / 2);
  return Plot.plot({
    width,
    height: residualsHeight(width),
    marginLeft: 48,
    marginRight: 14,
    marginTop: 30,
    marginBottom: 30,
    style: { fontSize: '12px', fontVariant: 'tabular-nums' },
    x: {
      type: 'utc',
      label: null,
      ticks: Math.max(2, Math.floor(width / 130)),
      tickFormat: (date: Date) => day(date).replace(/ \d{4}$/, ''),
      tickSize: 5,
    },
    y: {
      domain: spanned(
        intervals.map((interval) => interval.meanDeg),
        residuals.map((residual) => residual.residualDeg),
        1,
      ),
      nice: true,
      ticks: 5,
      tickFormat: sideTick,
      tickSize: 0,
      label: text.residuals.axisY,
      labelArrow: 'none',
    },
    marks: [
      Plot.gridY({ ticks: 5, stroke: colours.grid, strokeOpacity: 1 }),
      Plot.ruleY([0], { stroke: colours.axis }),
      Plot.dot(
        residuals.filter((residual) => residual.used),
        {
          x: 'time',
          y: 'residualDeg',
          r: 1.7,
          fill: colours.sample,
          fillOpacity: 0.4,
          clip: true,
          ariaHidden: 'true',
        },
      ),
      Plot.dot(
        residuals.filter((residual) => !residual.used),
        {
          x: 'time',
          y: 'residualDeg',
          r: 2.2,
          symbol: 'times',
          stroke: colours.unused,
          strokeOpacity: 0.8,
          clip: true,
          ariaHidden: 'true',
        },
      ),
      Plot.lineY(intervals, {
        x: middle,
        y: 'meanDeg',
        stroke: colours.curve,
        strokeWidth: 2,
        curve: 'monotone-x',
        marker: intervals.length < 40 ? 'circle' : 'none',
      }),
    ],
  });
}
