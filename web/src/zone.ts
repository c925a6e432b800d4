/**
 * What clocks show, where and when: legal time by the name of its zone, as `Europe/Madrid`, and
 * the nautical zone of a longitude as hours ahead of UTC. Pure functions.
 */

export type Zone = string | number;

const minuteMs = 60_000;
const hourMs = 60 * minuteMs;
const dayMs = 24 * hourMs;

const writers = new Map<string, Intl.DateTimeFormat | null>();

function writer(zone: string): Intl.DateTimeFormat | null {
  const known = writers.get(zone);
  if (known !== undefined) return known;
  let made: Intl.DateTimeFormat | null = null;
  try {
    made = new Intl.DateTimeFormat('en-GB', {
      timeZone: zone,
      calendar: 'gregory',
      numberingSystem: 'latn',
      hourCycle: 'h23',
      year: 'numeric',
      month: '2-digit',
      day: '2-digit',
      hour: '2-digit',
      minute: '2-digit',
      second: '2-digit',
    });
  } catch {
    // A browser that is older than the zone does not know it.
  }
  writers.set(zone, made);
  return made;
}

/** Milliseconds that clocks are ahead of UTC at an instant; nothing where the browser does not
 * know the zone. */
export function aheadMs(zone: Zone, atMs: number): number | undefined {
  if (typeof zone === 'number') return zone * hourMs;
  const parts = writer(zone)?.formatToParts(atMs);
  if (!parts) return undefined;
  const of = Object.fromEntries(parts.map(({ type, value }) => [type, Number(value)]));
  const { year = 0, month = 1, day = 1, hour = 0, minute = 0, second = 0 } = of;
  const shown = Date.UTC(year, month - 1, day, hour, minute, second);
  return shown - Math.floor(atMs / 1000) * 1000;
}

/** Whether the browser knows a zone. */
export const isKnown = (zone: Zone): boolean => aheadMs(zone, 0) !== undefined;

/** What clocks show at an instant, as though it were UTC; UTC where the zone is not known. */
export const shownAt = (atMs: number, zone: Zone): Date =>
  new Date(atMs + (aheadMs(zone, atMs) ?? 0));

/** The day that it is somewhere, `YYYY-MM-DD`. */
export const dayAt = (atMs: number, zone: Zone): string =>
  shownAt(atMs, zone).toISOString().slice(0, 10);

/**
 * When clocks show what was written, as `2026-12-08T06:00`: the first time, where they show it
 * twice as they are put back; the first instant after it, where they skip it.
 */
export function instantAt(written: string, zone: Zone): Date {
  const shown = Date.parse(`${written}Z`);
  const ahead = (atMs: number) => aheadMs(zone, atMs) ?? 0;
  const [before, after] = [shown - dayMs, shown + dayMs];
  const found = [ahead(before), ahead(after)]
    .map((offset) => shown - offset)
    .filter((at) => shown - ahead(at) === at);
  if (found.length > 0) return new Date(Math.min(...found));
  return new Date(changeBetween(before, after, ahead));
}

/** The instant from which clocks are another time ahead than before, to the second. */
function changeBetween(before: number, after: number, ahead: (atMs: number) => number): number {
  let [was, is] = [before, after];
  while (is - was > 1000) {
    const middle = Math.round((was + is) / 2000) * 1000;
    if (ahead(middle) === ahead(before)) was = middle;
    else is = middle;
  }
  return is;
}
