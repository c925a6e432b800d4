/** Names beside the marks of a map, as many as fit without lying on one another. Pure. */

import type { Place } from '../format';
import { near, pointOf } from './mercator';
import { screenOf, type Aspect, type View } from './view';

export interface Named {
  id: string;
  name: string;
  place: Place;
}

/** A name on the map, pixels from its left and upper edge to the name's beginning or end. */
export interface Label {
  id: string;
  name: string;
  x: number;
  y: number;
  side: 'right' | 'left';
}

/** A letter of the labels is so wide, and a line so high, pixels; a name begins so far off. */
const [letter, line, off] = [6.6, 15, 10];

/** The labels of the first that fit, each beside its mark, to the right where there is room. */
export function labels(
  named: readonly Named[],
  view: View,
  aspect: Aspect,
  width: number,
): Label[] {
  const height = width * aspect;
  const marks = named.map(({ place }) => {
    const { right, down } = screenOf(view, aspect, place);
    return { x: right * width, y: down * height };
  });
  const taken: Box[] = marks.map(({ x, y }) => ({
    left: x - 6,
    right: x + 6,
    top: y - 6,
    bottom: y + 6,
  }));
  const found: Label[] = [];
  named.forEach(({ id, name }, i) => {
    const mark = marks[i];
    if (!mark || mark.x < 0 || mark.x > width || mark.y < line || mark.y > height - line) return;
    const wide = name.length * letter;
    for (const side of ['right', 'left'] as const) {
      const left = side === 'right' ? mark.x + off : mark.x - off - wide;
      const box = { left, right: left + wide, top: mark.y - line / 2, bottom: mark.y + line / 2 };
      if (box.left < 0 || box.right > width || taken.some((other) => overlap(other, box))) continue;
      taken.push(box);
      found.push({ id, name, x: side === 'right' ? mark.x + off : mark.x - off, y: mark.y, side });
      return;
    }
  });
  return found;
}

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

const overlap = (a: Box, b: Box): boolean =>
  a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/**
 * An arrow ahead of a vessel, in the direction of the last leg of its track: `long` units
 * from its mark. Empty where it has not moved.
 */
export function arrow(track: readonly Place[], at: Place, view: View, long: number): string {
  const to = pointOf(at);
  const x = near(to.x, view.x);
  const from = track
    .toReversed()
    .map((place) => ({ x: near(place.lon, x), y: pointOf(place).y }))
    .find((before) => Math.hypot(before.x - x, before.y - to.y) > long / 50);
  if (!from) return '';
  const size = Math.hypot(x - from.x, to.y - from.y);
  const [east, south] = [(x - from.x) / size, (to.y - from.y) / size];
  const point = (along: number, aside: number) =>
    [x + long * (along * east - aside * south), to.y + long * (along * south + aside * east)]
      .map((value) => Math.round(value * 1000) / 1000)
      .join(' ');
  return `M${point(0.75, -0.3)}L${point(1.4, 0)}L${point(0.75, 0.3)}`;
}
