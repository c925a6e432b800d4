/** The help. */

import { translate } from './language';

export const help = translate('help', {
  title: 'Help',
  lead: 'What each page is for and how its figures come about.',
  search: 'Search the help',
  searchHint: 'For example: deviation card, webhook, storm',
  topics: 'Topics',
  found: (n: number) => (n === 1 ? '1 passage' : `${n} passages`),
  none: (query: string) => `Nothing in the help has “${query}”.`,
  unknown: 'There is no such topic. Choose one from the list.',
  tryApi: 'Try the API in the browser',
  tryApiLead: 'Every operation with its fields and an example, to be tried with your own account.',
  all: 'All topics',
  about: (what: string) => `Help: ${what}`,
});
