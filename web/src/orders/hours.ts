/** Hours of a job as they are typed, in the port's time where that is known. Pure functions. */

import { field } from '../logbook';
import { instantAt, shownAt, type Zone } from '../zone';

/** What stands in two fields of type `datetime-local`. */
export interface WrittenHours {
  from: string;
  until: string;
}

/** Hours that an order or its terms have. */
export interface JobHours {
  planned_at: string;
  planned_until: string;
}

/** The longest job. */
const mostMs = 24 * 3_600_000;
/** The usual job, where no end is known. */
const usualMs = 3 * 3_600_000;

/** The fields for some hours; in UTC where the zone is not known. */
export function writtenHours(hours: JobHours, zone: Zone | undefined): WrittenHours {
  const shown = (at: string) => field(shownAt(Date.parse(at), zone ?? 0));
  return { from: shown(hours.planned_at), until: shown(hours.planned_until) };
}

/** The hours that the fields name; `null` unless the end follows the beginning within a day. */
export function readHours(written: WrittenHours, zone: Zone | undefined): JobHours | null {
  if (written.from === '' || written.until === '') return null;
  const [from, until] = [written.from, written.until].map((typed) => instantAt(typed, zone ?? 0));
  if (!from || !until) return null;
  const long = until.getTime() - from.getTime();
  if (!(long > 0 && long <= mostMs)) return null;
  return { planned_at: from.toISOString(), planned_until: until.toISOString() };
}

/** Hours of the same length from another beginning. */
export function hoursFrom(begin: string, like: JobHours | undefined): JobHours {
  const long = like ? Date.parse(like.planned_until) - Date.parse(like.planned_at) : usualMs;
  return { planned_at: begin, planned_until: new Date(Date.parse(begin) + long).toISOString() };
}
