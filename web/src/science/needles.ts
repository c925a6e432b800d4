/**
 * The part of D and E that the compass's needles induce in the Kelvin spheres: it grows as 1/H
 * (docs/science.md, §10; docs/model.md). Pure.
 */

import type { Model } from '../api/types';

/** By how much each parameter, in the covariance's order, is more than in the model's field. */
export function needlesChange(model: Pick<Model, 'needles'>, h_nt: number): number[] {
  const needles = model.needles;
  if (!needles) return [0, 0, 0, 0, 0, 0, 0, 0];
  const byField = 1 / h_nt - 1 / needles.reference_h_nt;
  const [d, e] = [needles.d_nt * byField, needles.e_nt * byField];
  return [0, 0, 0, 0, 2 * d, e, e, 0];
}

/** The seven ratios in a horizontal field. */
export function parametersAt(
  model: Pick<Model, 'parameters_over_lambda' | 'needles'>,
  h_nt: number,
): Model['parameters_over_lambda'] {
  const p = model.parameters_over_lambda;
  const [, , , , d = 0, b = 0, e = 0] = needlesChange(model, h_nt);
  return {
    ...p,
    chi11_minus_chi22: p.chi11_minus_chi22 + d,
    chi12: p.chi12 + b,
    chi21: p.chi21 + e,
  };
}
