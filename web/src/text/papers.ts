/** The deviation card and the deviation book. */

import { translate } from './language';

export const card = translate('card', {
  title: 'Deviation card',
  lead: 'What the model predicts on each heading, with its 95 % band, on one sheet to be printed. It is marked as predicted until headings at sea have verified the adjustment that it comes from. It is no certificate: the place of a signature stays blank.',
  make: 'Make the card',
  making: 'Making…',
  again: 'Make it again',
  moved: 'For the place and day chosen above.',
  of: (place: string, day: string) => `For ${place} on ${day}.`,
  model: (version: number, band: string) => `By model ${version}, to ${band} or better.`,
  predicted: 'Predicted',
  verified: 'Verified at sea',
  byModel: 'by the model alone.',
  foretold: 'when the compass was adjusted at the berth; headings at sea have not verified it yet.',
  byOrder: (headings: number, until: string, adjusted: string) =>
    `by ${headings} headings up to ${until}, after the adjustment of ${adjusted}.`,
  order: 'Work order',
  alt: 'The deviation card as it is printed; the same as text is in the table of deviations.',
  forms: {
    pdf: 'Print (PDF)',
    svg: 'Picture (SVG)',
    csv: 'Table (CSV)',
    json: 'Data (JSON)',
  },
  refused: 'No card can be made now:',
  cure: 'There is one again when the alert is over.',
  toAlert: 'The alert',
  notRecorded: 'Not recorded here, for a person to write:',
  unrecorded: {
    correctors: 'how the correctors stand',
    degaussing_coils: 'how the degaussing coils are set',
    adjuster: 'adjuster, licence and firm',
    signature: 'an adjuster’s signature',
    next_due: 'when the next adjustment is due',
  },
});

export const book = translate('book', {
  title: 'Deviation book',
  lead: 'Compass errors as they were observed under way: one in each watch of four hours, and one after each alteration of course by 20° or more, beside what the card of the time said.',
  from: 'First day',
  to: 'Last day',
  whole: 'Without days, the whole book.',
  wrongOrder: 'The last day is before the first.',
  pdf: 'Print (PDF)',
  csv: 'Table (CSV)',
});
