/** How far a model is to be trusted, and why there is none. */

import { translate } from './language';

export const trust = translate('trust', {
  title: 'How far to trust the curve',
  lead: 'The 95 % band: nineteen times in twenty the deviation is no further off than this.',
  hereTitle: 'In these waters',
  thereTitle: 'At the place chosen',
  here: (worst: string, least: string, best: string) =>
    `at worst, on ${worst}; ${least} at best, on ${best}.`,
  hereEven: 'on every heading.',
  hereNone: 'This model came without errors: how far it may be off is not known.',
  elsewhereTitle: 'In other waters, up to',
  elsewhere: (limit: string, good: string, worst: string, at: string) =>
    `About ${limit} or better on every heading ${good} magnetic latitude; elsewhere up to ${worst}, at worst ${at}.`,
  everywhereGood: (limit: string, all: string) =>
    `About ${limit} or better on every heading wherever ships sail: ${all} magnetic latitude.`,
  nowhereGood: (limit: string, at: string) =>
    `No magnetic latitude is known to ${limit} on every heading yet. It is worst ${at}.`,
  between: (from: string, to: string) => `between ${from} and ${to}`,
  worthTitle: 'Her samples are worth',
  worth: (samples: string, effective: string) =>
    `${samples} samples, worth ${effective} with independent errors: a gyro’s errors last for hours and days, the variation’s for tens of miles, so that samples repeat each other.`,
  priorTitle: 'The model started from',
  priorSisters: (ships: string) => `${ships} sister ships`,
  priorOfSisters: (name: string, published: string) =>
    `Class “${name}”, as published on ${published}. The vessel’s own samples come on top, and ships unlike this class stay possible.`,
  priorFleet: (ships: string) => `${ships} ships of this fleet`,
  priorOfFleet: (published: string) =>
    `As published on ${published}. The vessel’s own samples come on top, and ships unlike this fleet stay possible.`,
  priorAtLarge: 'Ships at large',
  priorUsual: 'It started from what is usual in ships, without other vessels of this fleet.',
  priorTooFew:
    'Too few other vessels of this fleet were known at the first analysis, so it started from what is usual in ships.',
  predictionsTitle: 'Predicted before it was read',
  predictions: (inside: string, watches: string) => `${inside} of ${watches}`,
  predictionsHeld: (from: string, to: string) =>
    `So many of her latest watches lay inside the 95 % band that was drawn before their first reading. Of an honest band, ${from} to ${to} do.`,
  predictionsShort: (from: string, to: string, factor: string) =>
    `So many of her latest watches lay inside the 95 % band that was drawn before their first reading. Of an honest band ${from} to ${to} would: her band is therefore drawn ${factor} times as wide as the model alone would have it.`,
  byCourse:
    'This model rests on the course over ground alone, because the ship has neither gyro nor satellite compass. Current and wind are estimated, and the band is wide. Take azimuths, and do not steer by it without them.',
  referencesTitle: 'Gyro and satellite compass',
  apart: (angle: string) => `${angle} apart`,
  gyroAhead: (angle: string, pairs: string) =>
    `The gyro usually reads ${angle} more than the satellite compass (${pairs} samples with both).`,
  gyroBehind: (angle: string, pairs: string) =>
    `The gyro usually reads ${angle} less than the satellite compass (${pairs} samples with both).`,
  constantLeft: (band: string) =>
    `No heading shows which of them is right: ${band} for that is in every band.`,
  oneReference: 'Only one',
  oneReferenceLong: (band: string) =>
    `No sample came with both, so that neither checks the other; ${band} for a constant error of the reference is in every band.`,
  notCompared: 'Not compared',
  notComparedLong: (pairs: string, band: string) =>
    `Only ${pairs} samples came with both; ${band} for a constant error of the reference is in every band.`,
  droppedTitle: 'Readings that were not believed',
  dropped: (gyro: string, satellite: string) =>
    `The gyro was left out in ${gyro} samples, the satellite compass in ${satellite}.`,
  droppedWhy: (beyond: string) =>
    `One of them is held to have failed where it stood still while the ship turned, or where the two were further than ${beyond} from their usual difference. Then the magnetic compass decides between them; where it cannot, both are left out.`,
  droppedStuck: 'It stood still while the ship turned.',
  oneMagneticLatitude:
    'Her samples are from too narrow a range of magnetic latitudes to tell permanent from induced magnetism. The curve is good where she has been; far from there it leans on what is usual in ships until she has sailed there.',
  fewSamples:
    'Her latitudes would tell permanent from induced magnetism, but her samples are too few yet. The curve is good where she has been; elsewhere it leans on what is usual in ships until more samples come in, which needs nothing but sailing on.',
  noTimes:
    'The rows have no times, or share them, so that nobody knows which of them share one error of the gyro. The band takes rows on like headings for half a day’s.',
  largeResiduals: (residual: string) =>
    `Measured and predicted deviation usually differ by ${residual}, more than sound instruments leave. Check compass, gyro and satellite compass, and which input is taken for which, before these figures are believed.`,
  variationUnproven: (zero: string, mistake: string) =>
    `The compass’s zero seems to be off by ${zero}. It would seem so, too, if something were wrong with the heading taken for the true one: ${mistake}. Check this on board, or take a bearing of the sun. The band allows for both.`,
  longGap: (days: string, last: string) =>
    `Before the last samples there were none for ${days} days. The curve is for ${last}, and its band allows for what a ship may change in such a time.`,
  unknown: 'This page does not know one of this model’s cautions: load it anew.',
  weakField: (h: string) =>
    `Some samples are from waters with a horizontal field of only ${h}. There a compass is sluggish, small fields disturb it much, and its heading needs checking often.`,
  tableTitle: 'The band by magnetic latitude',
  caption: 'Half the 95 % band on the worst heading, by magnetic latitude from north to south',
  waters: 'Magnetic latitude',
  band: 'Up to',
  sailed: 'she has samples from there',
  mark: 'here',
  noAnswer: 'no answer',
  noAnswerLong:
    'No answer: on some heading the ship’s magnetism would outweigh the earth’s field there.',
});

export const refusal = translate('refusal', {
  withdrawn: (since: string, reason: string) =>
    `The last card has not held since ${since} (${reason}): do not steer by it.`,
  todo: 'What to do',
  tooFewSamples: (found: string, needed: string) =>
    `${found} samples can be used so far; at least ${needed} are needed.`,
  leftOutFor: (samples: string, kind: string) => `${samples} for “${kind}”`,
  leftOut: (kinds: string) =>
    `Entries of the logbook leave out further samples: ${kinds}. If one of them is over, write its end into the logbook.`,
  tooFewSamplesTodo:
    'Keep sailing: the agent takes a sample from every ten minutes or so on a steady heading at speed, away from the berth. If few come in, what became of the ten-second windows stands under “On board”, with the reasons.',
  noReference: (readings: string) =>
    `None of the ${readings} samples has a heading by gyro or satellite compass to hold the compass against.`,
  noReferenceTodo:
    'Check on board that a gyro or satellite compass is connected, and which sentence is taken for it.',
  noSteadyCourse: (
    readings: string,
    found: string,
    needed: string,
    tooSlow: string,
    least: string,
    turning: string,
  ) =>
    `No sample has a heading by gyro or satellite compass. The course over ground shows the heading in ${found} of ${readings} samples; at least ${needed} are needed. ${tooSlow} are below ${least} knots, ${turning} in a turn or just after one.`,
  noSteadyCourseTodo:
    'Steer straight courses under way on different headings, or connect a gyro or satellite compass.',
  noWeight: (samples: string) => `The weight is 0 in all of ${samples} samples.`,
  noWeightTodo: 'Give the rows that are to count a weight above 0.',
  contradictory: (residual: string, allowed: string) =>
    `Measured and predicted deviation differ by ${residual}, where no instruments leave more than ${allowed}: no ship’s magnetism explains these samples.`,
  contradictoryTodo:
    'Check on board which input is taken for the compass and which for the gyro, and in a file the sign of the variation, which is positive to the east.',
  tooFewHeadings: (found: number, needed: number, gap: string, allowed: string) =>
    `Samples are on ${found} of 24 sectors of 15°, with a gap of ${gap} between them. At least ${needed} sectors are needed, and no gap wider than ${allowed}.`,
  missing: (ranges: string) => `Missing: ${ranges}.`,
  tooFewHeadingsTodo:
    'Steer the missing headings, marked empty under “Coverage”: ten minutes steady on each will do, such as when waiting for a pilot or a berth, or on the passage back.',
  fieldTooWeak: (strongest: string, needed: string) =>
    `All samples are from waters with a horizontal field of at most ${strongest}; a magnetic compass needs ${needed} or more to steer by.`,
  fieldTooWeakTodo:
    'Nothing is wrong with the compass. A model comes with samples from lower magnetic latitudes; until then steer by gyro or satellite compass.',
  ambiguousHeadings: (h: string) =>
    `The samples ask for so much magnetism that, at a horizontal field of ${h}, one compass heading would belong to several courses.`,
  ambiguousHeadingsTodo:
    'Do not rely on this compass. Look for correctors that are missing or turned about and for steel near the binnacle, check that the agent reads the right instrument, and have the compass adjusted.',
  oneMagneticLatitude:
    'All samples are from one magnetic latitude, where permanent and induced magnetism cannot be told apart.',
  oneMagneticLatitudeTodo: 'A passage to another magnetic latitude tells them apart.',
  referencesDisagree: (apart: string, allowed: string) =>
    `Gyro and satellite compass differ by ${apart} throughout; ${allowed} is the most that alignment explains. One of them is wrong, and headings cannot tell which.`,
  referencesDisagreeTodo:
    'Check both against a transit or the sun’s bearing: the satellite compass for its antenna’s alignment and offset, the gyro for its latitude and speed settings. Put the wrong one right, or leave it out on board; a model comes with the samples after that.',
  referenceStuck: (readings: string) =>
    `The only reference stood still in ${readings} readings while the compass turned: it is stuck, or another source is taken for it.`,
  referenceStuckTodo:
    'Check on board which instrument and which sentence is taken for the gyro or satellite compass, and that it follows the ship round. A model comes with the samples after that.',
  referenceIsCompass: (samples: string, scatter: string, least: string) =>
    `The heading taken for the true one is the compass’s own. In ${samples} samples their difference scatters by only ${scatter}, where two instruments with these digits leave at least ${least}.`,
  referenceIsCompassTodo:
    'Check on board which instrument and which sentence is taken for the gyro or satellite compass. It must not be a heading computed from the magnetic compass and the variation.',
  variationMistaken: (mistake: string, residual: string, explained: string) =>
    `The heading taken for the true one is not true: ${mistake}. As it stands, no ship’s magnetism fits the samples to less than ${residual}; without this mistake one fits them to ${explained}.`,
  variationMistakes: {
    missing: 'the variation is missing in it, it is magnetic',
    wrong_sign: 'the variation is in it with the wrong sign',
    doubled: 'the variation is in it twice',
  },
  variationMistakenTodo:
    'Check on board which instrument gives the true heading, and how it adds the variation: true heading is magnetic heading plus variation, east positive. The samples taken so far cannot be used.',
  fewSamplesUsed: (used: string, found: string) =>
    `Only ${used} of ${found} samples agree with any one ship’s magnetism.`,
  fewSamplesUsedTodo:
    'Check whether the compass was moved, or the gyro was wrong, for part of the time, and report it in the logbook. A file is better split there.',
  modelDoesNotExplain: (residual: string, allowed: string) =>
    `The best model misses its own samples by ${residual}. A compass that deviates by more than ${allowed} has to be adjusted.`,
  modelDoesNotExplainTodo:
    'Check whether the compass, its correctors or the gyro were changed in between, and report it in the logbook.',
  notConverged: 'The samples contradict each other, or any ship.',
  notConvergedTodo:
    'Check on board that compass, gyro and satellite compass are taken from the right instruments, and report in the logbook what changed the ship’s magnetism meanwhile: cargo, repairs, lightning, correctors.',
  none: 'No sample has been analysed yet.',
  noneTodo:
    'Have the agent on board enrolled if that is not done. Once the ship is at sea, samples come in with its uploads.',
});
