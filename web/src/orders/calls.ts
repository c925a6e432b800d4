/** The port calls that an order may be of. Pure functions. */

import type { PortCall } from '../api/types';
import { instantAt, shownAt, type Zone } from '../zone';

const hourMs = 3_600_000;
const dayMs = 24 * hourMs;
/** Hours between which people work at a berth, the port's time. */
const [firstHour, lastHour] = [8, 17];

/** Her calls that are not over, the next one first. */
export const callsAhead = (calls: readonly PortCall[], now: Date): PortCall[] =>
  calls
    .filter((call) => call.withdrawn_at === null && Date.parse(call.etd) > now.getTime())
    .sort((a, b) => Date.parse(a.eta) - Date.parse(b.eta));

/**
 * When the work is best begun at a call, by the clocks of its port: at the first
 * full hour of a working day alongside, or as soon as she is there where her stay has none or
 * the port's time is not known.
 */
export function bestBegin(
  call: { eta: string; etd: string },
  zone: Zone | undefined,
  now: Date,
): Date {
  const soonest = Math.ceil(Math.max(Date.parse(call.eta), now.getTime()) / hourMs) * hourMs;
  if (zone === undefined) return new Date(soonest);
  const there = shownAt(soonest, zone);
  const hour = there.getUTCHours() + there.getUTCMinutes() / 60;
  const opens = (afterMs: number) => {
    const day = new Date(there.getTime() + afterMs).toISOString().slice(0, 10);
    return instantAt(`${day}T${String(firstHour).padStart(2, '0')}:00`, zone).getTime();
  };
  const wanted = hour < firstHour ? opens(0) : hour < lastHour ? soonest : opens(dayMs);
  return new Date(wanted < Date.parse(call.etd) ? wanted : soonest);
}

/** How an instant lies to a call: within it, or on which side. */
export function beside(
  call: { eta: string; etd: string },
  at: string,
): 'before' | 'after' | undefined {
  if (Date.parse(at) < Date.parse(call.eta)) return 'before';
  return Date.parse(at) > Date.parse(call.etd) ? 'after' : undefined;
}
