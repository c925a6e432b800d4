/**
 * Where a model is good: how wide its band is in each band of magnetic latitude.
 *
 * The waters are those of the advice on what to sail next (docs/science.md, §8):
 * the middle of the fields that the ship met there, or a dipole's.
 */

import type { Coverage, Model } from '../api/types';
import { widestBand, type Field, type Widest } from './band';

/** A curve whose band is no wider than this serves; beyond, it needs a look at the gyro. */
export const goodDeg = 2;

/** A band of magnetic latitude. */
export interface Waters {
  fromDeg: number;
  toDeg: number;
  /** Whether she has samples from there. */
  sailed: boolean;
  /** The widest band on any heading; none where the compass would not steer. */
  widest: Widest | null;
}

export interface Range {
  fromDeg: number;
  toDeg: number;
}

/** H of a dipole at the magnetic equator, nT. */
const dipoleNt = 29_700;
/** Magnetic latitudes that ships sail in. */
const [southmost, northmost] = [-60, 60];
const stepDeg = 10;

/** All bands that ships sail in, and those she has been in, from north to south. */
export function watersOf(model: Model, met: Coverage['bands']): Waters[] {
  const waters: Waters[] = [];
  const edges = met.map((band) => band.magnetic_latitude_from_deg);
  const last = Math.min(southmost, ...edges);
  for (let fromDeg = Math.max(northmost - stepDeg, ...edges); fromDeg >= last; fromDeg -= stepDeg) {
    const own = met.find((band) => band.magnetic_latitude_from_deg === fromDeg);
    const field = own
      ? { h_nt: (own.h_nt_from + own.h_nt_to) / 2, z_nt: (own.z_nt_from + own.z_nt_to) / 2 }
      : dipole(fromDeg + stepDeg / 2);
    waters.push({
      fromDeg,
      toDeg: fromDeg + stepDeg,
      sailed: own !== undefined,
      widest: widestBand(model, field),
    });
  }
  return waters;
}

/** Where the band is good on every heading, joined where bands touch, from the south. */
export function goodRanges(waters: Waters[]): Range[] {
  const found: Range[] = [];
  for (const { fromDeg, toDeg, widest } of [...waters].reverse()) {
    if (!widest || widest.band95_deg > goodDeg) continue;
    const last = found.at(-1);
    if (last?.toDeg === fromDeg) last.toDeg = toDeg;
    else found.push({ fromDeg, toDeg });
  }
  return found;
}

/** The widest of all. */
export function worstWaters(waters: Waters[]): (Waters & { widest: Widest }) | null {
  let worst: (Waters & { widest: Widest }) | null = null;
  for (const { widest, ...water } of waters) {
    if (widest && (!worst || widest.band95_deg > worst.widest.band95_deg)) {
      worst = { ...water, widest };
    }
  }
  return worst;
}

/** The latitude whose dip this is: tan dip = 2 tan latitude. */
export function magneticLatitudeOf({ h_nt, z_nt }: Field): number {
  return (Math.atan2(z_nt, 2 * h_nt) * 180) / Math.PI;
}

function dipole(magneticLatitudeDeg: number): Field {
  const latitude = (magneticLatitudeDeg * Math.PI) / 180;
  return { h_nt: dipoleNt * Math.cos(latitude), z_nt: 2 * dipoleNt * Math.sin(latitude) };
}
