/**
 * Every English text that the dashboard shows, in one catalogue. A text with a
 * value in it is a function; values come in already written by `format.ts`.
 */

import { alerts } from './alerts';
import { changes } from './changes';
import { common } from './common';
import { deviation } from './deviation';
import { papers } from './papers';
import { trust } from './trust';
import { vessels } from './vessels';

export const text = {
  ...common,
  ...alerts,
  ...vessels,
  ...deviation,
  ...changes,
  ...trust,
  ...papers,
};
