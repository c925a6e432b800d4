/** What a page asks first of all, asked while its own file is still on its way. */

import { findVessel } from '../api/client';
import type { Vessel } from '../api/types';
import { keptMe } from './me';

let ahead: { id: string; vessel: Promise<Vessel> } | undefined;

/** Asks for a vessel, if whoever was here last has vessels. */
export function askAhead(id: string): void {
  if (!['admin', 'viewer'].includes(keptMe()?.role ?? '')) return;
  const vessel = findVessel(id);
  // A failure is told where the answer is taken.
  vessel.catch(() => undefined);
  ahead = { id, vessel };
}

/** The vessel that was asked for ahead, once; any other is asked for now. */
export function vesselAsked(id: string): Promise<Vessel> {
  const found = ahead?.id === id ? ahead.vessel : findVessel(id);
  ahead = undefined;
  return found;
}
