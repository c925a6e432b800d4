/**
 * Where a ship was when something happened, as far as her samples and port calls tell: her
 * clocks follow it. Pure functions.
 */

import type { FleetVessel, PortCall, SampleDots } from './api/types';

/** Where something happened: a place at sea, or a port by its code. */
export type Where = { lon: number } | { port: string | null | undefined } | null | undefined;

/** An instant as the reader wants it, at the port that is named or where she was then. */
export type At = (value: string, port?: string) => string;

/** A ship is within a zone or two of where she was so long before. */
const nearMs = 2 * 86_400_000;

/** In port where a call says so, else by the nearest sample; nowhere where none is near. */
export function whereabouts(
  dots: SampleDots | undefined,
  calls: readonly PortCall[],
): (value: string) => Where {
  const standing = calls.filter((call) => call.withdrawn_at === null);
  return (value) => {
    const at = Date.parse(value);
    const call = standing.find(({ eta, etd }) => Date.parse(eta) <= at && at <= Date.parse(etd));
    if (call) return { port: call.port };
    const index = dots ? nearest(dots.unix_s, at / 1000) : -1;
    const [time, lon] = [dots?.unix_s[index], dots?.lon[index]];
    if (time === undefined || lon === undefined) return null;
    return Math.abs(time * 1000 - at) <= nearMs ? { lon } : null;
  };
}

/** Where a vessel of the fleet is now: alongside at a port of call, or where she was last. */
export function whereNow(vessel: FleetVessel | undefined, now: Date): Where {
  if (!vessel) return null;
  const { next_call: call, position } = vessel;
  if (call && Date.parse(call.eta) <= now.getTime()) return { port: call.port };
  return position;
}

/** The place of the value that is nearest, of values in order; −1 of none. */
function nearest(values: readonly number[], wanted: number): number {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((values[middle] ?? Infinity) < wanted) low = middle + 1;
    else high = middle;
  }
  const [before, after] = [values[low - 1] ?? -Infinity, values[low] ?? Infinity];
  return wanted - before <= after - wanted ? low - 1 : low < values.length ? low : -1;
}

/** The later of two written instants without the day, where that is the earlier one's. */
export function withoutItsDay(later: string, earlier: string): string {
  const day = /^\d+ \w+ \d{4}, /;
  const [its, other] = [day.exec(later)?.[0], day.exec(earlier)?.[0]];
  return its !== undefined && its === other ? later.slice(its.length) : later;
}

/** From one instant to another: what both have, a day or one clock's zone, is said once. */
export function fromTo(from: string, to: string): string {
  const zone = / UTC[^ )]*$/;
  const begin = zone.exec(from)?.[0] === zone.exec(to)?.[0] ? from.replace(zone, '') : from;
  return `${begin} – ${withoutItsDay(to, from)}`;
}
