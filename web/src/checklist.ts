/** How far each vessel has come until it is live: measured, and planned for. Pure functions. */

import type { AdjustmentNeed, FleetVessel } from './api/types';

export interface Checked {
  id: string;
  name: string;
  /** Whether the agent has sent anything. */
  agent: boolean;
  model: boolean;
  /** Her compasses, and the day of the last adjustment on record; nothing where none is. */
  compasses: { id: string; name: string; adjusted: string | null }[];
  call: boolean;
  /** Facts that the rules ask for and that are not known; not said before a rule asks. */
  missing: number | null;
}

export function checklist(
  vessels: readonly FleetVessel[],
  needs: readonly AdjustmentNeed[],
): Checked[] {
  const known = new Map<string, AdjustmentNeed[]>();
  for (const need of needs) {
    known.set(need.vessel_id, [...(known.get(need.vessel_id) ?? []), need]);
  }
  return vessels.map((vessel) => {
    const hers = known.get(vessel.id) ?? [];
    return {
      id: vessel.id,
      name: vessel.name,
      agent: vessel.last_upload_at !== null,
      model: vessel.model !== null,
      compasses: hers
        .map(({ compass_id: id, compass_name: name, adjusted_on: adjusted }) => ({
          ...{ id, name, adjusted },
        }))
        .sort((a, b) => a.name.localeCompare(b.name, 'en')),
      call: vessel.next_call !== null,
      missing: hers.length === 0 ? null : new Set(hers.flatMap((need) => need.not_known)).size,
    };
  });
}

/** A vessel is live when it is measured and its next adjustment can be planned. */
export const isLive = ({ agent, model, compasses, call }: Checked): boolean =>
  agent &&
  model &&
  call &&
  compasses.length > 0 &&
  compasses.every(({ adjusted }) => adjusted !== null);

/** Vessels that share an IMO number, by the number. */
export function sharedNumbers(vessels: readonly FleetVessel[]): [string, string[]][] {
  const named = new Map<string, string[]>();
  for (const { imo_number, name } of vessels) {
    if (imo_number === null) continue;
    named.set(imo_number, [...(named.get(imo_number) ?? []), name]);
  }
  return [...named].filter(([, names]) => names.length > 1);
}
