/**
 * The exact coefficients A–E at a place, in degrees.
 *
 * From Poisson's equations (Basterretxea-Iribar, Sotés & Uriarte 2016,
 * J. Navigation): A = (χ21−χ12)/2λ, B = (bx+χ13 Z)/λH, C = (by+χ23 Z)/λH,
 * D = (χ11−χ22)/2λ, E = (χ21+χ12)/2λ.
 */

import type { Model, ParameterName } from '../api/types';
import { standardError } from './band';
import { parametersAt } from './needles';
import { parameterOrder } from './parameters';

export type CoefficientName = 'A' | 'B' | 'C' | 'D' | 'E';
export const coefficientNames: CoefficientName[] = ['A', 'B', 'C', 'D', 'E'];

const degreesPerRadian = 180 / Math.PI;

/**
 * `h_nt` and `z_nt` are the earth's field at the place, down positive. The
 * model's constant is in A: headings cannot tell the two apart.
 */
export function exactCoefficients(
  model: Pick<Model, 'parameters_over_lambda' | 'constant_deg' | 'needles'>,
  h_nt: number,
  z_nt: number,
): Record<CoefficientName, number> {
  const p = parametersAt(model, h_nt);
  return {
    A: ((p.chi21 - p.chi12) / 2) * degreesPerRadian + model.constant_deg,
    B: ((p.bx_nt + p.chi13 * z_nt) / h_nt) * degreesPerRadian,
    C: ((p.by_nt + p.chi23 * z_nt) / h_nt) * degreesPerRadian,
    D: (p.chi11_minus_chi22 / 2) * degreesPerRadian,
    E: ((p.chi21 + p.chi12) / 2) * degreesPerRadian,
  };
}

/** Standard errors of the coefficients, degrees; none without a covariance. */
export function coefficientErrors(
  model: Pick<Model, 'covariance'>,
  h_nt: number,
  z_nt: number,
): Record<CoefficientName, number | null> {
  const half = degreesPerRadian / 2;
  const force = degreesPerRadian / h_nt;
  const error = (factors: Partial<Record<ParameterName, number>>) =>
    standardError(
      model.covariance,
      parameterOrder.map((name) => factors[name] ?? 0),
    );
  return {
    A: error({ chi21: half, chi12: -half, constant_deg: 1 }),
    B: error({ bx_nt: force, chi13: force * z_nt }),
    C: error({ by_nt: force, chi23: force * z_nt }),
    D: error({ chi11_minus_chi22: half }),
    E: error({ chi21: half, chi12: half }),
  };
}
