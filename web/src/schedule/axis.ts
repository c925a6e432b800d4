/** The time line's measure: how days lie on a width, and what is written above them. */

const dayMs = 86_400_000;

/** What is shown: so many days from a midnight, UTC. */
export interface Span {
  fromMs: number;
  days: number;
}

export const spanChoices = [28, 91, 182] as const;

/** From a week's Monday, or the Monday before it, so that today is never at the edge. */
export function spanFrom(now: Date, days: number): Span {
  const midnight = Date.UTC(now.getUTCFullYear(), now.getUTCMonth(), now.getUTCDate());
  const sinceMonday = (now.getUTCDay() + 6) % 7;
  const back = sinceMonday === 0 ? 7 : sinceMonday;
  return { fromMs: midnight - back * dayMs, days };
}

export const moved = (span: Span, days: number): Span => ({
  ...span,
  fromMs: span.fromMs + days * dayMs,
});

export const endOf = (span: Span): number => span.fromMs + span.days * dayMs;

/** Where an instant lies on a width; it may lie beside it. */
export const xOf = (span: Span, atMs: number, width: number): number =>
  ((atMs - span.fromMs) / (span.days * dayMs)) * width;

export const atX = (span: Span, x: number, width: number): number =>
  span.fromMs + (x / width) * span.days * dayMs;

export interface Tick {
  atMs: number;
  label: string;
  /** Whether a month begins. */
  strong: boolean;
}

const months = 'Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec'.split(' ');

/** Mondays, or where these would crowd every second, fourth, … of them. */
export function ticks(span: Span, width: number): Tick[] {
  const mostLabels = Math.max(2, Math.floor(width / 62));
  const weeks = Math.ceil(span.days / 7);
  const every = [1, 2, 4, 8].find((n) => weeks / n <= mostLabels) ?? 13;
  const found: Tick[] = [];
  for (let week = 0; week < weeks; week += every) {
    const at = new Date(span.fromMs + week * 7 * dayMs);
    const day = at.getUTCDate();
    found.push({
      atMs: at.getTime(),
      label: `${day} ${months[at.getUTCMonth()] ?? ''}`,
      strong: day <= 7 * every,
    });
  }
  return found;
}

/** The part of an interval that is shown, or none. */
export function shown(
  span: Span,
  fromMs: number,
  toMs: number,
  width: number,
): { x: number; width: number } | null {
  const from = Math.max(fromMs, span.fromMs);
  const to = Math.min(toMs, endOf(span));
  if (to <= from) return null;
  const x = xOf(span, from, width);
  return { x, width: xOf(span, to, width) - x };
}
