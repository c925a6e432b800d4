/** What part of the world a map shows. Pure functions: a view in, a view out. */

import type { Place } from '../format';
import { pointOf, top, wrapped, type Point } from './mercator';

export interface View {
  /** The middle, in the map's units. */
  x: number;
  y: number;
  /** How many units fit in the width. */
  width: number;
}

/** A map's height over its width. */
export type Aspect = number;

const widest = 360;
const narrowest = 4;
/** What a flat map may need to hold ships far to the north and the south: the world repeats. */
const widestFitted = 2 * widest;
/** What is shown, times this, is the view: a tenth of it stays free on each side. */
const margin = 1.25;

/**
 * The smallest view that holds all places, on whichever side of the globe they are, and of
 * whatever shape the map is: a tall one then shows what lies beyond the chart, too.
 */
export function fitted(places: readonly Place[], aspect: Aspect, leastWidth = 24): View {
  const points = places.map(pointOf);
  if (points.length === 0) return { x: 0, y: 0, width: onChart(widest, aspect) };
  const { x, width } = span(points.map((point) => point.x));
  const ys = points.map((point) => point.y);
  const [low, high] = [Math.min(...ys), Math.max(...ys)];
  const needed = Math.max(width * margin, ((high - low) * margin) / aspect, leastWidth);
  const view = { x, y: (low + high) / 2, width: Math.min(needed, widestFitted) };
  return bounded(view, aspect);
}

/** The shortest arc that holds all longitudes: it leaves out the widest gap. */
function span(longitudes: number[]): { x: number; width: number } {
  const sorted = longitudes.map(wrapped).sort((a, b) => a - b);
  let [gap, after] = [0, 0];
  sorted.forEach((lon, i) => {
    const next = sorted[i + 1] ?? (sorted[0] ?? 0) + 360;
    if (next - lon > gap) [gap, after] = [next - lon, next];
  });
  const width = 360 - gap;
  return { x: wrapped(after + width / 2), width };
}

/** Nearer by a factor, with a point of the map staying where it is. */
export function zoomed(view: View, factor: number, aspect: Aspect, at: Point = view): View {
  // A view that had to be wider to hold the fleet is not narrowed by going further away.
  const most = Math.max(view.width, onChart(widest, aspect));
  const width = Math.min(most, Math.max(narrowest, view.width / factor));
  const scale = width / view.width;
  const moved = { x: at.x + (view.x - at.x) * scale, y: at.y + (view.y - at.y) * scale, width };
  return bounded(moved, aspect);
}

/** Moved by shares of the width, to the east and to the south. */
export function panned(view: View, east: number, south: number, aspect: Aspect): View {
  return bounded(
    { ...view, x: view.x + east * view.width, y: view.y + south * view.width },
    aspect,
  );
}

/** The same nearness, with a place in it that was outside of it or at its edge. */
export function revealing(view: View, place: Place, aspect: Aspect): View {
  const point = pointOf(place);
  const [dx, dy] = [wrapped(point.x - view.x), point.y - view.y];
  const inside = Math.abs(dx) < 0.42 * view.width && Math.abs(dy) < 0.42 * view.width * aspect;
  return inside ? view : centred(view, place, aspect);
}

/** The same nearness, with a place in the middle. */
export function centred(view: View, place: Place, aspect: Aspect): View {
  return bounded({ ...view, ...pointOf(place) }, aspect);
}

/** No wider than a view may be that shows nothing beyond the chart. */
const onChart = (width: number, aspect: Aspect): number => Math.min(width, (-2 * top) / aspect);

/** Not beyond the chart's upper and lower edge, or as far beyond the one as the other. */
function bounded(view: View, aspect: Aspect): View {
  const room = Math.max(0, -top - (view.width * aspect) / 2);
  return { ...view, x: wrapped(view.x), y: Math.min(room, Math.max(-room, view.y)) };
}

/** For SVG: left, top, width and height. */
export function viewBox(view: View, aspect: Aspect): string {
  const height = view.width * aspect;
  return [view.x - view.width / 2, view.y - height / 2, view.width, height].join(' ');
}

/** Where on the map a point of the screen lies, both from 0 to 1. */
export function pointAt(view: View, aspect: Aspect, right: number, down: number): Point {
  return {
    x: view.x + (right - 0.5) * view.width,
    y: view.y + (down - 0.5) * view.width * aspect,
  };
}

/** Where on the screen a place lies, from 0 to 1 where it is inside. */
export function screenOf(
  view: View,
  aspect: Aspect,
  place: Place,
): { right: number; down: number } {
  const point = pointOf(place);
  return {
    right: 0.5 + wrapped(point.x - view.x) / view.width,
    down: 0.5 + (point.y - view.y) / (view.width * aspect),
  };
}
