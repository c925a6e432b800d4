/** Vessels on a map: marks and tracks as paths, and which vessel is meant. */

import type { Place } from '../format';
import { near, pointOf, wrapped, type Point } from './mercator';
import type { View } from './view';

export interface Placed {
  id: string;
  place: Place;
}

/**
 * Whether the map goes to the chosen vessel: to another one at once, to a new place of the same
 * one as long as nobody has moved the map since.
 */
export function isGoneTo(last: Placed | undefined, to: Placed, moved: boolean): boolean {
  if (last?.id !== to.id) return true;
  return !moved && (last.place.lat !== to.place.lat || last.place.lon !== to.place.lon);
}

/** A mark for each place in one path: lines without length, which a round or square cap shows. */
export function marks(places: readonly Place[], view: View): string {
  return places
    .map((place) => {
      const { x, y } = pointOf(place);
      return `M${round(near(x, view.x))} ${round(y)}h0`;
    })
    .join('');
}

/** Tracks in one path; each goes the short way, also across the antimeridian. */
export function trackPath(track: readonly Place[], view: View): string {
  const last = track.at(-1);
  if (!last || track.length < 2) return '';
  // From the ship back, so that her end of it is where her mark is.
  let x = near(last.lon, view.x);
  const points = track.toReversed().map((place) => {
    x = near(place.lon, x);
    return `${round(x)} ${round(pointOf(place).y)}`;
  });
  return `M${points.join('L')}`;
}

/** A track as the server has it: pairs of degrees north and east. */
export const placesOf = (track: readonly (readonly number[])[]): Place[] =>
  track.flatMap(([lat, lon]) => (lat === undefined || lon === undefined ? [] : [{ lat, lon }]));

const round = (value: number): number => Math.round(value * 1000) / 1000;

/** The vessel nearest to a point of the map, if it is as near as `within` units. */
export function nearest<T extends Placed>(
  vessels: readonly T[],
  at: Point,
  within: number,
): T | null {
  let [best, least]: [T | null, number] = [null, within];
  for (const vessel of vessels) {
    const point = pointOf(vessel.place);
    const distance = Math.hypot(wrapped(point.x - at.x), point.y - at.y);
    if (distance <= least) [best, least] = [vessel, distance];
  }
  return best;
}

export type Direction = 'left' | 'right' | 'up' | 'down';

/** The next vessel in a direction: near, and not far to the side of it. */
export function towards<T extends Placed>(
  vessels: readonly T[],
  from: Place,
  direction: Direction,
): T | null {
  const start = pointOf(from);
  let [best, least]: [T | null, number] = [null, Infinity];
  for (const vessel of vessels) {
    const point = pointOf(vessel.place);
    const [dx, dy] = [wrapped(point.x - start.x), point.y - start.y];
    const ahead = { left: -dx, right: dx, up: -dy, down: dy }[direction];
    const aside = Math.abs(direction === 'left' || direction === 'right' ? dy : dx);
    const cost = ahead + 2 * aside;
    if (ahead > 0 && aside <= 2 * ahead && cost < least) [best, least] = [vessel, cost];
  }
  return best;
}
