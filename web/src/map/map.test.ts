import { describe, expect, it } from 'vitest';
import { land } from 'virtual:land';
import { isGoneTo, marks, nearest, towards, trackPath } from './marks';
import type { Place } from '../format';
import { near, placeOf, pointOf, wrapped, type Point } from './mercator';
import { keyed, placeAt } from './moving';
import { fitted, panned, pointAt, revealing, screenOf, viewBox, zoomed, type View } from './view';

const world: View = { x: 0, y: 0, width: 360 };
const suva = { lat: -18.1, lon: 178.4 };
const apia = { lat: -13.8, lon: -171.8 };
const bilbao = { lat: 43.3, lon: -3 };
const callao = { lat: -12, lon: -77.2 };
const capeTown = { lat: -33.9, lon: 18.4 };
const gothenburg = { lat: 57.7, lon: 11.9 };
const coral = { lat: -16, lon: 160 };

/** The coasts that ship, in the map's units. */
const rings: Point[][] = land
  .split('z')
  .filter(Boolean)
  .map((ring) => {
    const [x = 0, y = 0, ...steps] = (ring.match(/-?\d+/g) ?? []).map((n) => Number(n) / 10);
    const points = [{ x, y }];
    for (let i = 0; i + 1 < steps.length; i += 2) {
      const last = points.at(-1) ?? { x, y };
      points.push({ x: last.x + (steps[i] ?? 0), y: last.y + (steps[i + 1] ?? 0) });
    }
    return points;
  });

/** South of it there is only Antarctica, which is closed along the map's edge. */
const lowestLand = pointOf({ lat: -60, lon: 0 }).y;

/** Whether a place is drawn as land: inside an odd number of rings, of one of the map's copies. */
function isLand(place: Place): boolean {
  const at = pointOf(place);
  return [-360, 0, 360].some(
    (east) => rings.filter((ring) => holds(ring, { x: at.x + east, y: at.y })).length % 2 === 1,
  );
}

/** Whether a line from a point to the east leaves the ring more often than it enters it. */
function holds(ring: readonly Point[], { x, y }: Point): boolean {
  const crossings = ring.filter((a, i) => {
    const b = ring[i + 1] ?? ring[0] ?? a;
    return a.y > y !== b.y > y && x < a.x + ((y - a.y) / (b.y - a.y)) * (b.x - a.x);
  });
  return crossings.length % 2 === 1;
}

describe('the chart', () => {
  it('finds a place again from its point', () => {
    for (const place of [suva, apia, bilbao, { lat: 0, lon: 0 }]) {
      const again = placeOf(pointOf(place));
      expect(again.lat).toBeCloseTo(place.lat, 9);
      expect(again.lon).toBeCloseTo(place.lon, 9);
    }
  });

  it('is Mercator’s: at 60° N a degree of latitude is twice one of longitude', () => {
    const [low, high] = [pointOf({ lat: 59.5, lon: 0 }), pointOf({ lat: 60.5, lon: 0 })];
    expect(low.y - high.y).toBeCloseTo(2, 3);
  });

  it('repeats every 360°', () => {
    expect(wrapped(180)).toBe(-180);
    expect(wrapped(-181)).toBe(179);
    expect(near(-171.8, 178.4)).toBeCloseTo(188.2, 9);
    expect(near(178.4, -171.8)).toBeCloseTo(-181.6, 9);
  });

  it('ships with coasts that begin and end inside the world', () => {
    expect(land.startsWith('M')).toBe(true);
    expect(land.length).toBeGreaterThan(10_000);
    expect(land).not.toMatch(/NaN|Infinity/);
  });

  it('ships with coasts that never cross the map the long way', () => {
    const longest = Math.max(
      ...rings.flatMap((ring) =>
        ring.map(({ x }, i) => Math.abs((ring[i + 1] ?? ring[0] ?? { x }).x - x)),
      ),
    );
    expect(longest).toBeLessThanOrEqual(180);
  });

  it('ships with coasts that do not run along the antimeridian, where the atlas is cut', () => {
    const cuts = rings.flatMap((ring) =>
      ring.filter((a, i) => {
        const b = ring[i + 1] ?? ring[0] ?? a;
        const onIt = (x: number) => Math.abs(Math.abs(x) - 180) < 0.05;
        return onIt(a.x) && onIt(b.x) && Math.abs(a.y - b.y) > 0.2 && a.y < lowestLand;
      }),
    );
    expect(cuts).toEqual([]);
  });

  it.each([
    ['the Barents Sea', 75, 40],
    ['the Norwegian Sea', 70, 2],
    ['the Kara Sea', 74, 75],
    ['the Chukchi Sea', 70, -170],
    ['Bering Strait', 65.9, -169],
    ['Baffin Bay', 72, -65],
    ['the Beaufort Sea', 71.5, -140],
    ['the South Atlantic', -16.5, -15],
    ['the Coral Sea', -16.5, 155],
    ['the sea off Fiji', -17.5, -179],
    ['the Southern Ocean', -62, 179.9],
  ])('has no land in %s', (_, lat, lon) => {
    expect(isLand({ lat, lon })).toBe(false);
  });

  it.each([
    ['Siberia', 65, 100],
    ['Chukotka, west of the antimeridian', 67, 178],
    ['Chukotka, east of it', 67, -176],
    ['Wrangel Island', 71.2, 179.5],
    ['Vanua Levu', -16.6, 179.4],
    ['Greenland', 75, -40],
    ['Spain', 40, -4],
    ['Victoria Land', -75, 160],
    ['the East Antarctic', -79.9, 90],
  ])('has land in %s', (_, lat, lon) => {
    expect(isLand({ lat, lon })).toBe(true);
  });
});

describe('a view', () => {
  it('holds ships on both sides of the antimeridian without the rest of the world', () => {
    const view = fitted([suva, apia], 0.6);
    expect(view.width).toBeLessThan(40);
    for (const place of [suva, apia]) {
      const { right, down } = screenOf(view, 0.6, place);
      expect(right).toBeGreaterThan(0);
      expect(right).toBeLessThan(1);
      expect(down).toBeGreaterThan(0);
      expect(down).toBeLessThan(1);
    }
  });

  it.each([
    ['flat', 0.25],
    ['usual', 0.6],
    ['square', 1],
    ['tall', 1.8],
  ])('holds ships all over the world with room around them on a %s map', (_, aspect) => {
    const fleet = [callao, capeTown, gothenburg, coral, suva];
    const view = fitted(fleet, aspect);
    for (const place of fleet) {
      const { right, down } = screenOf(view, aspect, place);
      expect(Math.abs(right - 0.5)).toBeLessThan(0.45);
      expect(Math.abs(down - 0.5)).toBeLessThan(0.45);
    }
  });

  it('holds ships all around the world with room beside them', () => {
    const fleet = Array.from({ length: 36 }, (_, i) => ({ lat: 0, lon: 10 * i - 180 }));
    const view = fitted(fleet, 0.6);
    for (const place of fleet) {
      expect(Math.abs(screenOf(view, 0.6, place).right - 0.5)).toBeLessThan(0.45);
    }
  });

  it('is the whole world without ships, and never wider', () => {
    expect(fitted([], 0.5).width).toBe(360);
    expect(zoomed(world, 0.1, 0.5).width).toBe(360);
    const tall = fitted([callao, coral, capeTown], 1.8);
    expect(zoomed(tall, 0.1, 1.8).width).toBe(tall.width);
  });

  it('does not show what lies beyond the chart', () => {
    const view = panned(fitted([bilbao], 0.6), 0, -50, 0.6);
    const [, y = '', , height = ''] = viewBox(view, 0.6).split(' ');
    expect(Number(y)).toBeGreaterThanOrEqual(pointOf({ lat: 80, lon: 0 }).y - 1e-9);
    expect(Number(height)).toBeCloseTo(view.width * 0.6, 9);
  });

  it('keeps a point under the pointer when it zooms', () => {
    const at = pointAt(world, 0.5, 0.7, 0.4);
    const view = zoomed(world, 2, 0.5, at);
    const again = pointAt(view, 0.5, 0.7, 0.4);
    expect(again.x).toBeCloseTo(at.x, 9);
    expect(again.y).toBeCloseTo(at.y, 9);
  });

  it('moves only to what it does not show', () => {
    const view = fitted([bilbao], 0.6);
    expect(revealing(view, { lat: 43, lon: -4 }, 0.6)).toBe(view);
    expect(revealing(view, suva, 0.6).x).toBeCloseTo(178.4, 9);
  });
});

describe('marks', () => {
  it('stand on the side of the world that is looked at', () => {
    expect(marks([suva], { ...world, x: -170 })).toMatch(/^M-181\.6 /);
    expect(marks([suva], { ...world, x: 170 })).toMatch(/^M178\.4 /);
  });

  it('a track crosses the antimeridian the short way', () => {
    const path = trackPath([suva, apia], { ...world, x: 180 });
    const xs = [...path.matchAll(/[ML](-?[\d.]+) /g)].map(([, x]) => Number(x));
    expect(xs).toEqual([188.2, 178.4]);
    expect(trackPath([suva], world)).toBe('');
  });

  it('are found by the nearest point, also across the antimeridian', () => {
    const fleet = [
      { id: 'suva', place: suva },
      { id: 'apia', place: apia },
    ];
    const at = pointOf({ lat: -18, lon: -181 });
    expect(nearest(fleet, at, 2)?.id).toBe('suva');
    expect(nearest(fleet, at, 0.1)).toBeNull();
    expect(towards(fleet, suva, 'right')?.id).toBe('apia');
    expect(towards(fleet, suva, 'left')).toBeNull();
  });
});

describe('a ship that is moved by hand', () => {
  it('is where the pointer is, and at the edge when it leaves the map', () => {
    const view = fitted([bilbao], 0.6);
    const middle = placeAt(view, 0.6, 0.5, 0.5);
    expect(middle.lat).toBeCloseTo(bilbao.lat, 1);
    expect(middle.lon).toBeCloseTo(bilbao.lon, 1);
    expect(placeAt(view, 0.6, 5, 0.5)).toEqual(placeAt(view, 0.6, 1, 0.5));
    expect(placeAt({ ...view, x: 179 }, 0.6, 1, 0.5).lon).toBeLessThan(0);
  });

  it('goes by the arrow keys: north is up, east is right, across the antimeridian', () => {
    expect(keyed(bilbao, 'ArrowUp', false)).toEqual({ lat: 44.3, lon: -3 });
    expect(keyed(bilbao, 'ArrowRight', true)).toEqual({ lat: 43.3, lon: 7 });
    expect(keyed(suva, 'ArrowRight', true)).toEqual({ lat: -18.1, lon: -171.6 });
    expect(keyed({ lat: 78, lon: 0 }, 'ArrowUp', true)).toEqual({ lat: 80, lon: 0 });
    expect(keyed(bilbao, 'Enter', false)).toBeNull();
  });
});

describe('the middle of the map', () => {
  const suvas = { id: 'a', place: suva };

  it('goes to a vessel that is chosen, whoever moved the map before', () => {
    expect(isGoneTo(undefined, suvas, true)).toBe(true);
    expect(isGoneTo({ id: 'b', place: suva }, suvas, true)).toBe(true);
  });

  it('follows her as she moves, until a person moves the map', () => {
    expect(isGoneTo(suvas, { id: 'a', place: { ...suva } }, false)).toBe(false);
    expect(isGoneTo(suvas, { id: 'a', place: apia }, false)).toBe(true);
    expect(isGoneTo(suvas, { id: 'a', place: apia }, true)).toBe(false);
  });
});
