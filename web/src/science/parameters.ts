/** What a model says of the ship, as rows for people to read. */

import type { Model, ParameterName } from '../api/types';

/** The order of the rows and columns of a model's covariance. */
export const parameterOrder: ParameterName[] = [
  'bx_nt',
  'chi13',
  'by_nt',
  'chi23',
  'chi11_minus_chi22',
  'chi12',
  'chi21',
  'constant_deg',
];

export type Basis = 'data' | 'prior' | 'unknown';

export interface ParameterRow {
  name: ParameterName;
  /** In nT, 1 or degrees, as the name says. */
  value: number;
  /** Half the width of the 95 % interval, in the same unit; none without a covariance. */
  error95: number | null;
  basis: Basis;
}

/** Two-sided 95 % of the normal distribution. */
const normal95 = 1.96;

export function parameterRows(model: Model): ParameterRow[] {
  return parameterOrder.map((name, index) => ({
    name,
    value: name === 'constant_deg' ? model.constant_deg : model.parameters_over_lambda[name],
    error95: error95(model.covariance?.[index]?.[index]),
    basis: basis(model.identifiable?.[name]),
  }));
}

function error95(variance: number | undefined): number | null {
  if (variance === undefined || !(variance >= 0)) return null;
  return normal95 * Math.sqrt(variance);
}

function basis(fromData: boolean | undefined): Basis {
  if (fromData === undefined) return 'unknown';
  return fromData ? 'data' : 'prior';
}
