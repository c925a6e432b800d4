/**
 * The map's units: x is degrees east, y grows southward, both as on a Mercator chart,
 * where a line of constant course is straight. The world repeats every 360 units, so
 * that nothing special happens at the antimeridian.
 */

import type { Place } from '../format';

export interface Point {
  x: number;
  y: number;
}

/** Beyond, no ship sails by a magnetic compass, and the chart grows without end. */
export const highestLat = 80;

export function pointOf({ lat, lon }: Place): Point {
  const bounded = Math.min(highestLat, Math.max(-highestLat, lat));
  return {
    x: lon,
    y: -(180 / Math.PI) * Math.log(Math.tan(Math.PI / 4 + (bounded * Math.PI) / 360)),
  };
}

export function placeOf({ x, y }: Point): Place {
  const lat = (360 / Math.PI) * Math.atan(Math.exp((-y * Math.PI) / 180)) - 90;
  return { lat: Math.min(highestLat, Math.max(-highestLat, lat)), lon: wrapped(x) };
}

/** The same longitude in [-180, 180). */
export function wrapped(lon: number): number {
  return ((((lon + 180) % 360) + 360) % 360) - 180;
}

/** The repetition of a longitude that is nearest to another. */
export function near(lon: number, to: number): number {
  return to + wrapped(lon - to);
}

/** The lowest y of the chart; the highest is its negative. */
export const top = pointOf({ lat: highestLat, lon: 0 }).y;
