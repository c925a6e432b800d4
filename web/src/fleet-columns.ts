/** The columns of the fleet's table that can be left out, and the table as a CSV file. Pure. */

import { reasonsOf, worstAhead, type FleetLine, type Reason } from './attention';
import { sorts, type Sort } from './fleet';

/** The name is always there. */
export type Column = Exclude<Sort, 'name'>;
export const columns = sorts.filter((sort): sort is Column => sort !== 'name');

interface Store {
  getItem: (key: string) => string | null;
  setItem: (key: string, value: string) => void;
}

const key = 'binnacle.fleet.hidden';

/** Those that the reader left out in this browser; what cannot be read counts as none. */
export function hiddenColumns(store: Store): Column[] {
  try {
    const kept = (store.getItem(key) ?? '').split(',');
    return columns.filter((column) => kept.includes(column));
  } catch {
    return [];
  }
}

export function hideColumns(store: Store, hidden: readonly Column[]): void {
  try {
    store.setItem(key, hidden.join(','));
  } catch {
    // A private window may keep nothing: the choice holds until the page is left.
  }
}

const head = [
  ...['name', 'imo_number', 'call_sign', 'tags', 'needs', 'open_alerts'],
  ...['worst_deviation_deg', 'worst_compass_deg', 'worst_band95_deg', 'worst_at'],
  ...['residuals_rms_deg', 'last_upload_at', 'due_on', 'urgency', 'order'],
  ...['next_port', 'eta', 'etd', 'lat', 'lon', 'position_at'],
];

/** A line for each vessel, with days and instants as data have them (ISO 8601). */
export function fleetCsv(vessels: readonly FleetLine[]): string {
  const lines = vessels.map((vessel) => {
    const ahead = worstAhead(vessel);
    const { position, next_call: call, due } = vessel;
    return [
      ...[vessel.name, vessel.imo_number, vessel.call_sign, vessel.tags.join(' ')],
      ...[reasonsOf(vessel).map(wordOf).join(' '), vessel.open_alerts],
      ...[ahead?.worst.deviation_deg, ahead?.worst.compass_deg, ahead?.worst.band95_deg],
      ...[ahead?.port, vessel.model?.rms_deg, vessel.last_upload_at],
      ...[due?.urgency === 'unknown' ? '' : due?.on, due?.urgency, vessel.inHand?.state],
      ...[call ? call.port_name || call.port : undefined, call?.eta, call?.etd],
      ...[position?.lat, position?.lon, position?.at],
    ];
  });
  return [head, ...lines].map((line) => `${line.map(field).join(',')}\r\n`).join('');
}

function wordOf(reason: Reason): string {
  switch (reason.kind) {
    case 'alert':
      return reason.cause;
    case 'due':
      return `adjustment_${reason.urgency}`;
    case 'order':
      return `order_${reason.state}`;
    case 'deviation':
      return 'large_deviation';
  }
}

/** As RFC 4180 has it; what a spreadsheet would run as a formula begins with an apostrophe. */
function field(value: string | number | null | undefined): string {
  if (typeof value === 'number') return String(value);
  const text = (value ?? '').replace(/^[=+@\t\r-]/, "'$&");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
