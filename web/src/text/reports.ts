/** Reports: what is due, how bad it is, what was done and what it saved. */

import { translate } from './language';

export const reports = translate('reports', {
  title: 'Reports',
  lead: (fleet: string, vessels: number, compasses: number) =>
    `${fleet}: ${vessels} vessel${vessels === 1 ? '' : 's'}, ${compasses} compass${compasses === 1 ? '' : 'es'}`,
  from: 'From',
  to: 'To, included',
  show: 'Show',
  wrongSpan: 'The first day must not be after the last.',
  pdf: 'PDF',
  csv: 'CSV',
  csvOf: (table: string) => `${table} as CSV`,
  vessel: 'Vessel',
  compass: 'Compass',
  predicted: 'Predicted from headings at sea. This is no certificate.',

  saved: {
    title: 'Saved against swinging',
    lead: (swing: string, hours: string) =>
      `A swing is reckoned with ${swing} and ${hours} hours. One is spared for all compasses of a ship at a visit; the fees of all jobs are taken off.`,
    jobs: 'Adjusted without a swing',
    money: 'Saved',
    hours: "Ship's hours saved",
    fees: 'Fees',
    withoutFee: (jobs: number) =>
      `The fee of ${jobs === 1 ? 'one job' : `${jobs} jobs`} is not known: the figure is too high by it.`,
  },

  due: {
    title: 'Due',
    none: 'No compass is due on any known day.',
    on: 'Due on',
    why: 'Why',
    last: 'Last adjusted',
    order: 'Under way',
    never: 'not on record',
    nothing: '–',
  },

  deviation: {
    title: 'Greatest deviation',
    lead: 'Where each model was made, as of now.',
    none: 'There are no compasses.',
    deviation: 'Deviation',
    band: '95 % band',
    heading: 'On heading (C)',
    until: 'Last sample',
    noModel: 'no model yet',
  },

  jobs: {
    title: 'Adjusted',
    none: 'Nothing was adjusted in this time.',
    day: 'Day',
    port: 'Port',
    firm: 'Firm',
    state: 'State',
    fee: 'Fee',
    own: "the operator's own",
    byTerms: 'by its terms',
  },

  settings: {
    title: 'What is reckoned with, and who gets it each month',
    lead: 'The report of a month goes out by mail on the first of the next.',
    swing: 'A swing costs, €',
    hours: 'A swing takes, hours',
    monthly: 'Each month to (an address a line, at most 20)',
    submit: 'Save',
    busy: 'Saving…',
    done: 'Saved.',
    wrong: (field: string) => `This is no number: ${field}.`,
  },
});
