/** The search over everything. */

import { translate } from './language';

export const finder = translate('finder', {
  title: 'Find',
  open: 'Find…',
  keys: 'Ctrl K',
  label: 'Vessel, port, work order, page or setting',
  results: 'Found',
  none: (query: string) => `Nothing is called “${query}”.`,
  count: (n: number) => (n === 1 ? '1 found' : `${n} found`),
  loading: 'Asking for vessels and orders…',
  failed: 'Vessels and orders could not be loaded: only pages are found.',
  help: 'Arrow keys choose, Enter opens, Esc closes.',
  close: 'Close',
  kinds: {
    vessel: 'Vessel',
    port: 'Port',
    order: 'Work order',
    page: 'Page',
    setting: 'Setting',
  },
  /** What is found on the reader's own page of the settings. */
  settings: [
    'Password',
    'Second factor',
    'API tokens',
    'Times: UTC or ship’s time',
    'Language · Idioma',
  ],
  order: (vessel: string) => `Adjustment of ${vessel}`,
  call: (vessel: string, on: string) => `${vessel} arrives ${on}`,
});
