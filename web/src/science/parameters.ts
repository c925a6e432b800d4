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

/** Whether a value is from the ship's own headings or from ships at large. */
export type Basis = 'own' | 'mostly' | 'little' | 'ships' | 'unknown';

export interface ParameterRow {
  name: ParameterName;
  /** In nT, 1 or degrees, as the name says. */
  value: number;
  /** Standard error, in the same unit; none without a covariance. */
  error: number | null;
  basis: Basis;
  /** How much of what is known is from her own headings, 0 to 1; none if not stated. */
  share: number | null;
}

/** From these shares on a value is called her own, mostly so, or a little. */
const [own, mostly, little] = [0.9, 0.5, 0.1];

export function parameterRows(model: Model): ParameterRow[] {
  return parameterOrder.map((name, index) => {
    const share = model.quality?.from_data[name] ?? null;
    return {
      name,
      value: name === 'constant_deg' ? model.constant_deg : model.parameters_over_lambda[name],
      error: root(model.covariance?.[index]?.[index]),
      basis: basisOf(model.identifiable?.[name], share),
      share,
    };
  });
}

/**
 * A parameter that her data do not tell apart from another is never called her
 * own, however much their sum has taken from its variance.
 */
export function basisOf(identifiable: boolean | undefined, share: number | null): Basis {
  if (share === null) {
    if (identifiable === undefined) return 'unknown';
    return identifiable ? 'own' : 'ships';
  }
  if (share >= own && identifiable !== false) return 'own';
  if (share >= mostly) return 'mostly';
  return share >= little ? 'little' : 'ships';
}

function root(variance: number | undefined): number | null {
  if (variance === undefined || !(variance >= 0)) return null;
  return Math.sqrt(variance);
}
