/** Meridians and parallels for a map, as one path. */

import { highestLat, pointOf, top } from './mercator';
import type { View } from './view';

/** Every 30° of a wide view, every 10° or 5° of a narrower one. */
export const gridStep = (view: View): number => (view.width > 120 ? 30 : view.width > 40 ? 10 : 5);

export function grid(view: View): string {
  const step = gridStep(view);
  const [left, right] = [view.x - view.width / 2, view.x + view.width / 2];
  const lines: string[] = [];
  for (let x = Math.ceil(left / step) * step; x <= right; x += step) {
    lines.push(`M${x} ${top}V${-top}`);
  }
  for (let lat = -highestLat + (highestLat % step); lat <= highestLat; lat += step) {
    lines.push(`M${left} ${pointOf({ lat, lon: 0 }).y}H${right}`);
  }
  return lines.join('');
}
