/** A curve that comes from an adjustment, and not yet from headings at sea. */

import { translate } from './language';

export const foretold = translate('foretold', {
  anOrder: 'a work order',
  order: (port: string, day: string) => `work order ${port}, ${day}`,
  proof: {
    none: 'Predicted, not verified at sea',
    verified: 'Predicted, and verified at sea',
    disproved: 'Predicted, and not confirmed at sea',
  },
  origin: (order: string, day: string, place: string) =>
    `This curve is foretold: by ${order}, from the work done on ${day} at ${place}. It is not fitted to any sample.`,
  noHeading: 'No settled heading has come in since the adjustment.',
  needed: (agree: number, more: number, best: string) =>
    `${agree === 1 ? '1 heading agrees' : `${agree} headings agree`} so far; ${more} more ${more === 1 ? 'is' : 'are'} needed${best === '' ? '' : `, best of all on ${best}`}.`,
  toOrder: 'The order',
  shortOf: {
    none: 'predicted, not verified at sea',
    verified: 'predicted, verified at sea',
    disproved: 'predicted, not confirmed at sea',
  },
  noResiduals: (order: string) => `none: foretold by ${order}, fitted to no sample`,
  modelLine: (version: number, day: string) => `Model ${version}, foretold ${day}`,
  worstThere: 'Largest deviation where she was adjusted',
  worthTitle: 'Samples since the adjustment',
  worthNone: 'None',
  worthNoneLong:
    'Nothing has been measured since: the band is of the model before it, of the reading at the berth and of the correctors that were moved.',
  worth: (until: string) =>
    `Held against what was foretold; the last of ${until}. They tell whether it holds, the curve is not fitted to them.`,
});
