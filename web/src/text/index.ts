/**
 * Every English text that the dashboard shows, in one catalogue. A text with a
 * value in it is a function; values come in already written by `format.ts`.
 */

import { alerts } from './alerts';
import { audit } from './audit';
import { berth } from './berth';
import { binnacles } from './binnacles';
import { changes } from './changes';
import { common } from './common';
import { deviation } from './deviation';
import { fields } from './fields';
import { firms } from './firms';
import { fleet } from './fleet';
import { notifications } from './notifications';
import { offers } from './offers';
import { orders } from './orders';
import { papers } from './papers';
import { platform } from './platform';
import { reports } from './reports';
import { schedule } from './schedule';
import { settings } from './settings';
import { signing } from './signing';
import { trust } from './trust';
import { vessels } from './vessels';

export const text = {
  ...common,
  ...alerts,
  ...audit,
  ...vessels,
  ...fleet,
  ...deviation,
  ...changes,
  ...trust,
  ...papers,
  ...offers,
  ...orders,
  ...schedule,
  ...platform,
  ...reports,
  ...notifications,
  ...fields,
  ...firms,
  ...settings,
  ...signing,
  ...berth,
  ...binnacles,
};
