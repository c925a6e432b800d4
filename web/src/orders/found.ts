/** What an adjuster reports of the compass as found. Pure. */

import type { AsFound, CorrectorSetting, MagnetsInHole } from '../api/types';

/** The checks alongside, with nothing wrong. */
export const sound: Omit<AsFound['dockside'], 'spheres_turned_deg'> = {
  bubble: 'sound',
  pivot: 'sound',
  gimbals: 'sound',
  lubber_line: 'sound',
};

/** Whether two settings differ in any corrector. */
export function differs(one: CorrectorSetting, other: CorrectorSetting): boolean {
  return plain(one) !== plain(other);
}

function plain(setting: CorrectorSetting): string {
  const { fore_and_aft = [], athwartship = [], quadrantal, flinders, heeling } = setting;
  const iron = <T extends { slew_deg?: number }>(set: T | null | undefined) =>
    set ? { ...set, slew_deg: set.slew_deg ?? 0 } : null;
  // The order in which trays are named makes no other setting.
  const trays = (all: MagnetsInHole[]) =>
    all.toSorted(
      (a, b) =>
        a.hole - b.hole ||
        a.magnet.localeCompare(b.magnet) ||
        a.red.localeCompare(b.red) ||
        a.count - b.count,
    );
  const parts = [
    trays(fore_and_aft),
    trays(athwartship),
    iron(quadrantal),
    iron(flinders),
    heeling ?? null,
  ];
  return JSON.stringify(parts, (_, value: unknown) => {
    if (value === null || typeof value !== 'object' || Array.isArray(value)) return value;
    return Object.fromEntries(Object.entries(value).sort(([a], [b]) => a.localeCompare(b)));
  });
}
