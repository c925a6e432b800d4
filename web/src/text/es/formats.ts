import type * as en from '../formats';
import type { Translation } from './translation';

export const formats: Translation<typeof en.formats> = {
  months: 'ene feb mar abr may jun jul ago sep oct nov dic'.split(' '),
  locale: 'es-ES',
  decimal: ',',
  justNow: 'ahora mismo',
  ago: (lasting) => `hace ${lasting}`,
  days: (n) => `${n} días`,
  to: 'a',
  euros: (sign, whole) => `${sign}${whole}\u00a0€`,
};
