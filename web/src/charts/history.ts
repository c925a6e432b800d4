/** Deviation over time on some headings, with what happened meanwhile. */

import * as Plot from '@observablehq/plot';
import { day, heading } from '../format';
import type { HistoryLine, Stretch } from '../science/history';
import * as text from '../text';
import { colours, historyColours, historyHeight, sideTick, spanned } from './common';
import { crosses, dots } from './dots';
import type { Axis } from './residuals';

export function drawHistory(
  lines: HistoryLine[],
  width: number,
  { range, steps, shown }: Axis,
): Element {
  const span = range.toMs - range.fromMs;
  const date = (ms: number) => new Date(ms);
  const all = lines.flatMap((line) => line.stretches);
  const isBrief = ({ fromMs, toMs }: { fromMs: number; toMs: number }) =>
    toMs - fromMs < span / 500;
  return Plot.plot({
    width,
    height: historyHeight(width),
    marginLeft: 48,
    // The lanes below end where the chart does.
    marginRight: 14,
    marginTop: 30,
    marginBottom: 46,
    style: { fontSize: '12px', fontVariant: 'tabular-nums' },
    x: {
      type: 'utc',
      domain: [date(range.fromMs), date(range.toMs)],
      label: text.residuals.axisX,
      labelAnchor: 'right',
      labelArrow: 'none',
      labelOffset: 40,
      ticks: Math.max(2, Math.floor(width / 130)),
      tickFormat: (on: Date) => day(on).replace(/ \d{4}$/, ''),
      tickSize: 5,
    },
    y: {
      domain: spanned(
        all.flatMap(({ deviationDeg, band95Deg }) => [
          deviationDeg - (band95Deg ?? 0),
          deviationDeg + (band95Deg ?? 0),
        ]),
        lines.flatMap((line) => line.dots.map((dot) => dot.deviationDeg)),
        1.5,
      ),
      nice: true,
      ticks: 7,
      tickFormat: sideTick,
      tickSize: 0,
      label: text.history.axisY,
      labelArrow: 'none',
    },
    marks: [
      Plot.rectX(
        [...steps.filter((step) => !step.grave && !isBrief(step)), ...(shown ? [shown] : [])],
        {
          x1: (mark: Axis['steps'][number]) => date(mark.fromMs),
          x2: (mark: Axis['steps'][number]) => date(Math.max(mark.toMs, mark.fromMs + span / 250)),
          fill: (mark: Axis['steps'][number]) => (mark === shown ? colours.curve : colours.notable),
          fillOpacity: 0.12,
        },
      ),
      Plot.gridY({ ticks: 7, stroke: colours.grid, strokeOpacity: 1 }),
      Plot.ruleY([0], { stroke: colours.axis }),
      Plot.ruleX(
        steps.filter((step) => step.grave || isBrief(step)),
        {
          x: (mark: Axis['steps'][number]) => date(mark.fromMs),
          stroke: (mark: Axis['steps'][number]) => (mark.grave ? colours.bad : colours.notable),
          strokeWidth: 1.5,
          strokeDasharray: '5 3',
        },
      ),
      ...lines.flatMap((line, index) =>
        ofLine(line, historyColours[index % historyColours.length] ?? colours.curve),
      ),
    ],
  });

  function ofLine({ compassDeg, stretches, dots: near }: HistoryLine, stroke: string) {
    const at = (used: boolean) =>
      near
        .filter((dot) => dot.used === used)
        .map(({ timeMs, deviationDeg }) => ({ x: date(timeMs), y: deviationDeg }));
    const across = { x1: (s: Stretch) => date(s.fromMs), x2: (s: Stretch) => date(s.toMs) };
    const last = stretches.at(-1);
    return [
      dots(at(true), 1.5, stroke, 0.3),
      crosses(at(false), colours.unused),
      Plot.rect(
        stretches.filter(({ band95Deg }) => band95Deg !== null),
        {
          ...across,
          y1: (s: Stretch) => s.deviationDeg - (s.band95Deg ?? 0),
          y2: (s: Stretch) => s.deviationDeg + (s.band95Deg ?? 0),
          fill: stroke,
          fillOpacity: 0.13,
        },
      ),
      Plot.ruleY(stretches, { ...across, y: 'deviationDeg', stroke, strokeWidth: 2.5 }),
      // The step itself, from one epoch's line to the next one's.
      Plot.line(
        stretches.flatMap((s) => [
          [date(s.fromMs), s.deviationDeg],
          [date(s.toMs), s.deviationDeg],
        ]),
        { stroke, strokeWidth: 1, strokeDasharray: '2 3' },
      ),
      Plot.text(last ? [last] : [], {
        x: (s: Stretch) => date(s.toMs),
        y: 'deviationDeg',
        text: () => heading(compassDeg),
        textAnchor: 'end',
        lineAnchor: 'bottom',
        dx: -3,
        dy: -3,
        fill: stroke,
        stroke: colours.surface,
        strokeWidth: 4,
        fontWeight: 650,
      }),
    ];
  }
}
