/** A port call in a form, in the port's time, and what of it was amended. Pure functions. */

import type { PortCall, PortCallAmendment } from '../api/types';
import { instantAt, shownAt, type Zone } from '../zone';

/** What is written in the form; times to the minute, `YYYY-MM-DDTHH:MM`. */
export interface Written {
  eta: string;
  etd: string;
  berth: string;
}

const minute = (at: string, zone: Zone): string =>
  shownAt(Date.parse(at), zone).toISOString().slice(0, 16);

export const writtenOf = (call: PortCall, zone: Zone): Written => ({
  eta: minute(call.eta, zone),
  etd: minute(call.etd, zone),
  berth: call.berth ?? '',
});

/** What differs from what was opened: a time that nobody touched keeps its seconds. */
export function amendmentOf(opened: Written, written: Written, zone: Zone): PortCallAmendment {
  const amendment: PortCallAmendment = {};
  if (written.eta !== opened.eta) amendment.eta = instantAt(written.eta, zone).toISOString();
  if (written.etd !== opened.etd) amendment.etd = instantAt(written.etd, zone).toISOString();
  const berth = written.berth.trim();
  if (berth !== opened.berth) amendment.berth = berth === '' ? null : berth;
  return amendment;
}
