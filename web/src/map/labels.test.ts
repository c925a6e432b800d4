import { expect, test } from 'vitest';
import { arrow, labels } from './labels';

const view = { x: 0, y: 0, width: 360 };
const named = (id: string, lat: number, lon: number) => ({ id, name: id, place: { lat, lon } });

test('names lie beside their marks, not on one another and not beyond the edge', () => {
  const [first, ...others] = labels(
    [named('Humboldt', 0, 0), named('Noordzee', 1, 2), named('At the edge', 20, 170)],
    view,
    0.5,
    720,
  );
  expect(first).toMatchObject({ id: 'Humboldt', side: 'right', y: 180 });
  expect(first?.x).toBeGreaterThan(360);
  expect(others.map(({ id, side }) => [id, side])).toEqual([
    ['Noordzee', 'left'],
    ['At the edge', 'left'],
  ]);
});

test('three in one place have no room for three names', () => {
  const here = ['One', 'Two', 'Three'].map((id) => named(id, 0, 0));
  expect(labels(here, view, 0.5, 720).length).toBeLessThan(3);
});

test('an arrow points where the vessel goes, also across the antimeridian', () => {
  const east = arrow([{ lat: 0, lon: 178 }], { lat: 0, lon: -178 }, { ...view, x: 180 }, 10);
  const [, tip] = east.split('L').map((point) => Number(point.replace('M', '').split(' ')[0]));
  expect(tip).toBeCloseTo(182 + 14, 6);
  expect(arrow([{ lat: 0, lon: 10 }], { lat: 0, lon: 10 }, view, 10)).toBe('');
});
