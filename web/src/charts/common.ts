/** What the charts share: colours that follow day and night, heights, ticks, spans. */

import { eastWest } from '../format';

/** Style-sheet variables, so that a change of theme needs no new drawing. */
export const colours = {
  curve: 'var(--curve)',
  sample: 'var(--sample)',
  unused: 'var(--ink-faint)',
  grid: 'var(--line)',
  axis: 'var(--line-strong)',
  bad: 'var(--bad)',
  notable: 'var(--notable)',
  surface: 'var(--surface)',
} as const;

/** One for each heading drawn over time, and again from the first. */
export const historyColours = [
  'var(--curve)',
  'var(--sample)',
  'var(--good)',
  'var(--notable)',
  'var(--ink-soft)',
] as const;

/** Known before the drawing is, so that its room can be kept. */
export const comparedHeight = (width: number): number => (width < 520 ? 280 : 340);
export const deviationHeight = (width: number): number => (width < 520 ? 300 : 410);
export const historyHeight = (width: number): number => (width < 520 ? 300 : 380);
export const residualsHeight = (width: number): number => (width < 520 ? 236 : 276);

/** `4° E`, `0°`, `2.5° W` */
export function sideTick(value: number): string {
  return eastWest(value, Number.isInteger(value) ? 0 : 1);
}

/**
 * A range that holds zero, all of `firm` and the middle 98 % of `loose`, at
 * least `leastDeg` to either side: a stray outlier does not flatten the curve.
 */
export function spanned(firm: number[], loose: number[], leastDeg: number): [number, number] {
  const sorted = [...loose].sort((a, b) => a - b);
  const at = (share: number) => sorted[Math.floor(share * (sorted.length - 1))] ?? 0;
  const low = Math.min(-leastDeg, at(0.01), ...firm);
  const high = Math.max(leastDeg, at(0.99), ...firm);
  const margin = 0.06 * (high - low);
  return [low - margin, high + margin];
}
