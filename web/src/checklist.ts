/** How far each vessel has come until it is live: measured, and planned for. Pure functions. */

import type { AdjustmentNeed, FleetVessel } from './api/types';

export interface Checked {
  id: string;
  name: string;
  /** The compass of which the last adjustment is asked. */
  compass: string | null;
  /** Whether the agent has sent anything. */
  agent: boolean;
  model: boolean;
  /** Day of the last adjustment on record; nothing where none is. */
  adjusted: string | null;
  call: boolean;
  /** Facts that the rules ask for and that are not known. */
  missing: number;
}

export function checklist(
  vessels: readonly FleetVessel[],
  needs: readonly AdjustmentNeed[],
): Checked[] {
  const known = new Map<string, AdjustmentNeed>();
  for (const need of needs) if (!known.has(need.vessel_id)) known.set(need.vessel_id, need);
  return vessels.map((vessel) => {
    const need = known.get(vessel.id);
    return {
      id: vessel.id,
      name: vessel.name,
      compass: need?.compass_id ?? null,
      agent: vessel.last_upload_at !== null,
      model: vessel.model !== null,
      adjusted: need?.adjusted_on ?? null,
      call: vessel.next_call !== null,
      missing: need?.not_known.length ?? 0,
    };
  });
}

/** A vessel is live when it is measured and its next adjustment can be planned. */
export const isLive = ({ agent, model, adjusted, call }: Checked): boolean =>
  agent && model && adjusted !== null && call;

/** Vessels that share an IMO number, by the number. */
export function sharedNumbers(vessels: readonly FleetVessel[]): [string, string[]][] {
  const named = new Map<string, string[]>();
  for (const { imo_number, name } of vessels) {
    if (imo_number === null) continue;
    named.set(imo_number, [...(named.get(imo_number) ?? []), name]);
  }
  return [...named].filter(([, names]) => names.length > 1);
}
