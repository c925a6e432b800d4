/** What `format.ts` writes around its figures. */

import { translate } from './language';

export const formats = translate('formats', {
  months: 'Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec'.split(' '),
  locale: 'en-GB',
  decimal: '.',
  justNow: 'just now',
  ago: (lasting: string) => `${lasting} ago`,
  days: (n: number) => `${n} days`,
  /** From one hour to another. */
  to: 'to',
  euros: (sign: string, whole: string) => `${sign}€\u00a0${whole}`,
});
