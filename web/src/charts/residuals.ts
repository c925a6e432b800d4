/** Residuals over time, with the mean of each day or week, and when what changed. */

import * as Plot from '@observablehq/plot';
import { day } from '../format';
import type { Interval, Residual } from '../science/residuals';
import * as text from '../text';
import type { Mark, Range } from '../timeline';
import { colours, residualsHeight, sideTick, spanned } from './common';
import { crosses, dots } from './dots';

/** What a time axis holds besides what was measured. */
export interface Axis {
  range: Range;
  /** Changes that were found. */
  steps: Mark[];
  /** What is looked at. */
  shown: Mark | undefined;
}

export function drawResiduals(
  residuals: Residual[],
  intervals: Interval[],
  width: number,
  { range, steps }: Omit<Axis, 'shown'>,
): Element {
  const middle = (interval: Interval) =>
    new Date((interval.from.getTime() + interval.to.getTime()) / 2);
  const at = (used: boolean) =>
    residuals
      .filter((residual) => residual.used === used)
      .map(({ time, residualDeg }) => ({ x: time, y: residualDeg }));
  return Plot.plot({
    width,
    height: residualsHeight(width),
    marginLeft: 48,
    marginRight: 14,
    marginTop: 30,
    marginBottom: 46,
    style: { fontSize: '12px', fontVariant: 'tabular-nums' },
    x: {
      type: 'utc',
      domain: [new Date(range.fromMs), new Date(range.toMs)],
      label: text.residuals.axisX,
      labelAnchor: 'right',
      labelArrow: 'none',
      labelOffset: 40,
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
      Plot.ruleX(steps, {
        x: (mark: Mark) => new Date(mark.fromMs),
        stroke: (mark: Mark) => (mark.grave ? colours.bad : colours.notable),
        strokeWidth: 1.5,
        strokeDasharray: '5 3',
      }),
      dots(at(true), 1.7, colours.sample, 0.4),
      crosses(at(false), colours.unused),
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
