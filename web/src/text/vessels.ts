/** What is said of a vessel wherever she is shown, and adding one. */

import { translate } from './language';

export const vessels = translate('vessels', {
  imo: 'IMO',
  onHeading: (heading: string) => `on ${heading}`,
  band: (band: string) => `${band} (95 %)`,
  noModel: 'No model yet',
  noUpload: 'nothing uploaded yet',
  noPosition: 'no position yet',
  emptyTitle: 'No vessels yet',
  emptyAdmin:
    'Add the first vessel; then enrol the agent on board, and its compass begins to be measured.',
  emptyViewer: 'An administrator of your company adds vessels.',
  add: 'Add a vessel',
  addTitle: 'Add a vessel',
  fieldName: 'Name',
  fieldImo: 'IMO number',
  fieldCallSign: 'Call sign',
  fieldFlag: 'Flag',

  create: 'Add vessel',
  creating: 'Adding…',
  nameMissing: 'A vessel needs a name.',
});

/** Taking a vessel out of service. */
export const service = translate('service', {
  end: 'Take her out of service…',
  question:
    'Sold, laid up or broken up? She will be in no list of the fleet, her alerts end, and she ' +
    'needs nothing any more. All that is stored of her stays, what her agents still send is ' +
    'kept, and she can be taken back at any time.',
  confirm: 'Take her out of service',
  resume: 'Take her back into service',
  out: (since: string) =>
    `Out of service since ${since}: she is in no list of the fleet and calls for no alert.`,
  list: 'Vessels out of service',
  none: 'All vessels are in service.',
  since: (since: string) => `since ${since}`,
});
