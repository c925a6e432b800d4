/** What a page asks first of all, asked while its own file is still on its way. */

import { findVessel, listVesselNeeds } from '../api/client';
import type { AdjustmentNeed, Vessel } from '../api/types';
import { keptMe } from './me';

interface Ahead {
  id: string;
  vessel?: Promise<Vessel> | undefined;
  needs?: Promise<AdjustmentNeed[]> | undefined;
}
let ahead: Ahead | undefined;

/** Asks for a vessel and what is due, if whoever was here last has vessels. */
export function askAhead(id: string): void {
  if (!['admin', 'viewer'].includes(keptMe()?.role ?? '')) return;
  ahead = { id, vessel: findVessel(id), needs: listVesselNeeds(id) };
  // A failure is told where the answer is taken.
  ahead.vessel?.catch(() => undefined);
  ahead.needs?.catch(() => undefined);
}

/** The vessel that was asked for ahead, once; any other is asked for now. */
export function vesselAsked(id: string): Promise<Vessel> {
  const found = ahead?.id === id ? ahead.vessel : undefined;
  if (ahead) ahead.vessel = undefined;
  return found ?? findVessel(id);
}

/** Her needs that were asked for ahead, once, as the vessel. */
export function needsAsked(id: string): Promise<AdjustmentNeed[]> {
  const found = ahead?.id === id ? ahead.needs : undefined;
  if (ahead) ahead.needs = undefined;
  return found ?? listVesselNeeds(id);
}
