/** A ship that is moved over the map by hand. Pure functions. */

import type { Place } from '../format';
import { highestLat, placeOf, wrapped } from './mercator';
import { pointAt, type Aspect, type View } from './view';

/** As exact as a hand is. */
const round = ({ lat, lon }: Place): Place => ({
  lat: Math.round(lat * 100) / 100,
  lon: Math.round(lon * 100) / 100,
});

/** The place under a point of the shown map; beside the map, at its edge. */
export function placeAt(view: View, aspect: Aspect, right: number, down: number): Place {
  const within = (share: number) => Math.min(1, Math.max(0, share));
  return round(placeOf(pointAt(view, aspect, within(right), within(down))));
}

const ways: Record<string, [number, number]> = {
  ArrowUp: [1, 0],
  ArrowDown: [-1, 0],
  ArrowRight: [0, 1],
  ArrowLeft: [0, -1],
};

/** Where an arrow key moves her: a degree, or with Shift ten; nothing for another key. */
export function keyed(place: Place, key: string, far: boolean): Place | null {
  const way = ways[key];
  if (!way) return null;
  const step = far ? 10 : 1;
  const lat = place.lat + step * way[0];
  return round({
    lat: Math.min(highestLat, Math.max(-highestLat, lat)),
    lon: wrapped(place.lon + step * way[1]),
  });
}
