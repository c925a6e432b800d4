/** What is said of a vessel wherever she is shown, and adding one. */

export const vessels = {
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
};
