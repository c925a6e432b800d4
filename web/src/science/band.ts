/**
 * The 95 % band of a foretold deviation, from the model's covariance alone.
 *
 * docs/science.md (6), (8), (10) and (11); docs/model.md has the worked example
 * that the tests read. Inside, angles are radians.
 */

import type { Model } from '../api/types';
import { needlesChange, parametersAt } from './needles';

/** The earth's field at a place, nT, Z down positive. */
export interface Field {
  h_nt: number;
  z_nt: number;
}

export interface Widest {
  compass_deg: number;
  /** Half the width of the 95 % band. */
  band95_deg: number;
}

/** Two-sided 95 % of the normal distribution. */
export const normal95 = 1.96;

const degreesPerRadian = 180 / Math.PI;
/** Headings on which a curve is looked at, as in the table of deviations. */
const stepDeg = 5;
const headings = Array.from({ length: 360 / stepDeg }, (_, i) => i * stepDeg);

/**
 * Half the band on a compass heading; none where headings are ambiguous there,
 * or when the model came without a covariance.
 */
export function band95(model: Model, compassDeg: number, field: Field): number | null {
  return band95By(model, coefficients(model, field), compassDeg, field);
}

function band95By(model: Model, by: Coefficients, compassDeg: number, field: Field): number | null {
  const slopes = slopesOf(by, compassDeg, field);
  if (!slopes || !model.covariance) return null;
  const change = needlesChange(model, field.h_nt);
  const turned = slopes.reduce((sum, slope, i) => sum + slope * (change[i] ?? 0), 0);
  const ofNeedles = turned * (model.needles?.relative_sd ?? 0);
  const variance = quadratic(model.covariance, slopes) + ofNeedles * ofNeedles;
  return variance >= 0 ? normal95 * Math.sqrt(variance) : null;
}

/** The heading where the band is widest; none where any heading is ambiguous. */
export function widestBand(model: Model, field: Field): Widest | null {
  const by = coefficients(model, field);
  if (!steers(by)) return null;
  let widest: Widest | null = null;
  for (const compass_deg of headings) {
    const found = band95By(model, by, compass_deg, field);
    if (found === null) return null;
    if (!widest || found > widest.band95_deg) widest = { compass_deg, band95_deg: found };
  }
  return widest;
}

/** Standard error of a sum of parameters, each with its factor, in their order. */
export function standardError(
  covariance: number[][] | null | undefined,
  factors: number[],
): number | null {
  if (!covariance) return null;
  const variance = quadratic(covariance, factors);
  return variance >= 0 ? Math.sqrt(variance) : null;
}

function quadratic(covariance: number[][], v: number[]): number {
  let sum = 0;
  for (let i = 0; i < v.length; i++) {
    const [row, left] = [covariance[i], v[i] ?? NaN];
    for (let j = 0; j < v.length; j++) sum += left * (v[j] ?? NaN) * (row?.[j] ?? NaN);
  }
  return sum;
}

/** Coefficients A to E as parts of one, not degrees. */
type Coefficients = Record<'a' | 'b' | 'c' | 'd' | 'e', number>;

function coefficients(model: Model, { h_nt, z_nt }: Field): Coefficients {
  const p = parametersAt(model, h_nt);
  return {
    a: (p.chi21 - p.chi12) / 2,
    b: (p.bx_nt + p.chi13 * z_nt) / h_nt,
    c: (p.by_nt + p.chi23 * z_nt) / h_nt,
    d: p.chi11_minus_chi22 / 2,
    e: (p.chi21 + p.chi12) / 2,
  };
}

/** Degrees of deviation for each unit of each parameter, and 1 for the constant. */
function slopesOf(
  { a, b, c, d, e }: Coefficients,
  compassDeg: number,
  field: Field,
): number[] | null {
  const { h_nt, z_nt } = field;
  const zeta = compassDeg / degreesPerRadian;
  const k1 = 1 - d * Math.cos(2 * zeta) + e * Math.sin(2 * zeta);
  const k2 = a + d * Math.sin(2 * zeta) + e * Math.cos(2 * zeta);
  const k3 = b * Math.sin(zeta) + c * Math.cos(zeta);
  const g = Math.sqrt(k1 * k1 + k2 * k2 - k3 * k3);
  if (!(g > 0)) return null;
  const deviation = Math.asin(k3 / Math.hypot(k1, k2)) + Math.atan2(k2, k1);
  const hx = h_nt * Math.cos(zeta + deviation);
  const hy = -h_nt * Math.sin(zeta + deviation);
  const sin = Math.sin(zeta) / (g * h_nt);
  const cos = Math.cos(zeta) / (g * h_nt);
  const radians = [sin, z_nt * sin, cos, z_nt * cos, (hx * sin - hy * cos) / 2, hy * sin, hx * cos];
  return [...radians.map((slope) => slope * degreesPerRadian), 1];
}

/** Whether some directive force is left on every magnetic heading. */
function steers({ b, c, d, e }: Coefficients): boolean {
  return headings.every((heading) => {
    const psi = heading / degreesPerRadian;
    const force =
      1 + b * Math.cos(psi) - c * Math.sin(psi) + d * Math.cos(2 * psi) - e * Math.sin(2 * psi);
    return force > 0;
  });
}
