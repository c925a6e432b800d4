import { expect, test } from 'vitest';
import type { Timeline } from '../api/types';
import { historyOf } from './history';

const ms = (day: string) => Date.parse(`${day}T00:00:00Z`);
const curve = (deviation: number) =>
  [0, 90].map((compass_deg) => ({
    compass_deg,
    magnetic_deg: compass_deg,
    deviation_deg: compass_deg === 90 ? deviation : 0,
    band95_deg: 0.5,
  }));

const timeline = {
  epochs: [
    { from: null, to: '2026-11-10T00:00:00Z', curve: curve(-2) },
    { from: '2026-11-10T00:00:00Z', to: '2026-11-11T00:00:00Z', curve: null },
    { from: '2026-11-11T00:00:00Z', to: null, curve: curve(4) },
  ],
} as unknown as Timeline;

const samples = {
  unix_s: ['2026-11-05', '2026-11-10', '2026-11-15', '2026-11-16'].map((day) => ms(day) / 1000),
  lon: [0, 0, 0, 0],
  compass_deg: [80, 90, 104, 130],
  deviation_deg: [-1, 0, 4, 4],
  residual_deg: [0.5, 0.1, -0.25, 0],
  used: [true, true, true, true],
};

test('a strike is a step between the epochs, in the curve and in the samples near the heading', () => {
  const range = { fromMs: ms('2026-11-01'), toMs: ms('2026-11-20') };
  const [east] = historyOf(timeline, samples, [90], range);
  expect(east?.stretches).toEqual([
    { fromMs: range.fromMs, toMs: ms('2026-11-10'), deviationDeg: -2, band95Deg: 0.5 },
    { fromMs: ms('2026-11-11'), toMs: range.toMs, deviationDeg: 4, band95Deg: 0.5 },
  ]);
  // An epoch without a curve has no samples to show; a heading of 130° is not near.
  expect(east?.dots.map(({ deviationDeg }) => deviationDeg)).toEqual([-1.5, 3.75]);
});

test('samples on either side of north are near it', () => {
  const around = { ...samples, compass_deg: [350, 10, 5, 344] };
  const range = { fromMs: ms('2026-11-01'), toMs: ms('2026-11-20') };
  const [north] = historyOf(timeline, around, [0], range);
  expect(north?.dots.map(({ deviationDeg }) => deviationDeg)).toEqual([0.5, -0.25]);
});
