/** The curve, what it is made of, and what would better it. */

import type { ParameterName } from '../api/types';
import { translate } from './language';

export const deviation = translate('deviation', {
  title: 'Deviation',
  lead: 'What the compass is off the magnetic heading: magnetic = compass + deviation, east positive.',
  axisX: 'Compass heading',
  axisY: 'Deviation',
  band: '95 % band',
  curve: 'Deviation',
  used: 'Sample',
  unused: 'Left out of the fit',
  legend: 'Legend',
  samples: 'Samples',
  show: {
    here: 'At this place',
    measured: 'As measured',
    none: 'None',
  },
  showLong: {
    here: 'Samples are brought to this place: each stands as far from the curve as it was from the model where it was taken.',
    measured:
      'Samples stand at the deviation measured where they were taken, which differs from the deviation here.',
    none: '',
  },
  notDrawn: {
    adjusted: (none: boolean) =>
      `Samples from before the adjustment are not drawn: they say nothing of this curve.${none ? ' There is none since.' : ''}`,
    earlier: (from: string) =>
      `Samples from before ${from} are not drawn: her magnetism was another then.`,
  },
  drawn: (drawn: string, all: string) => `${drawn} of ${all} samples drawn.`,
  place: 'Place and time',
  latitude: 'Latitude',
  longitude: 'Longitude',
  date: 'Date',
  apply: 'Show',
  more: 'Other places, card and book',
  reset: 'Back to the last position',
  choose: 'Choose another place',
  close: 'Close',
  map: {
    label: 'Map of where the curve is for',
    help: 'Plus and minus zoom, Shift with an arrow key moves the map. The ship on it is moved by her own arrow keys.',
    home: 'Her track',
    ship: (place: string) => `The ship, at ${place}`,
    shipHelp: 'Arrow keys move the ship by one degree, with Shift by ten.',
    hint: 'Drag the ship, or click where she is to be: curve, table and card are for that place.',
    worstHere: 'Largest deviation where she is',
    worstThere: 'Largest deviation there',
  },
  latitudeWrong: 'Latitude: write it as 54 30 N or 54.5.',
  longitudeWrong: 'Longitude: write it as 018 40 E or 18.67.',
  dateWrong: 'Date: choose a day.',
  at: (place: string, day: string) => `At ${place} on ${day}`,
  variationThere: (variation: string) => `variation ${variation}`,
  fieldThere: (h: string, z: string) => `field ${h} horizontal, ${z} vertical`,
  summary: (max: string, on: string, min: string, onMin: string) =>
    `Deviation against compass heading, from ${min} on ${onMin} to ${max} on ${on}. The table of deviations has the same figures.`,
  bandSummary: (narrow: string, wide: string) =>
    narrow === wide ? `Band ${narrow} everywhere.` : `Band from ${narrow} to ${wide}.`,
  tip: (compass: string, deviation: string, band: string, magnetic: string) =>
    `Compass ${compass}\n${deviation} ${band}\nMagnetic ${magnetic}`,
  noBand: 'This model came without errors: no band can be given.',
  uncertain: (wide: string) =>
    `The band is ${wide} wide or more on some headings: data from this magnetic latitude are missing.`,
});

export const table = translate('table', {
  title: 'Table of deviations',
  caption: (place: string, day: string) =>
    `Deviation every 15° of compass heading at ${place} on ${day}`,
  compass: 'Compass',
  magnetic: 'Magnetic',
  point: 'Point',
  deviation: 'Deviation',
  band: '95 %',
});

export const residuals = translate('residuals', {
  title: 'Residuals over time',
  lead: 'Measured less predicted deviation, each sample by the model of its own epoch. What the models do not explain shows here: scatter, and a slope that is still too small to be called a change.',
  axisY: 'Residual',
  axisX: 'Day, UTC',
  mean: 'Daily mean',
  meanWeekly: 'Weekly mean',
  summary: (n: string, rms: string, from: string, to: string) =>
    `${n} residuals, ${rms} rms, from ${from} to ${to}. The table below has them by day or week.`,
  table: 'Residuals as a table',
  caption: 'Residuals by interval, samples used in the fit',
  from: 'From, UTC',
  samples: 'Samples',
  meanColumn: 'Mean',
  rmsColumn: 'rms',
  none: 'No residuals yet: they need a model.',
  period: 'Period',
  days: (n: number) => `${n} days`,
});

export const coverage = translate('coverage', {
  title: 'Coverage',
  lead: 'Samples by compass heading and magnetic latitude. Headings fix the curve where the ship has been; different magnetic latitudes fix it elsewhere.',
  caption: 'Number of samples by compass heading (columns) and magnetic latitude (rows)',
  band: 'Magnetic latitude',
  range: (from: string, to: string) => `${from} to ${to}`,
  total: 'All',
  summaryAll: (bands: number) =>
    `All headings are covered; ${bands === 1 ? 'one band' : `${bands} bands`} of magnetic latitude.`,
  summaryGaps: (gaps: string) => `No samples yet on compass headings ${gaps}.`,
  none: 'No samples yet.',
  rose: 'Samples by compass heading, north up, and by magnetic latitude, the northernmost ring outside. The table below has the figures.',
  ring: (from: string, to: string) => `${from} – ${to}`,
  density: 'from none to most samples',
  advised: 'worth sailing next',
  oneBand:
    'All samples are from one band of magnetic latitude: permanent and induced magnetism cannot be told apart yet, and the curve at a distant place rests on experience with other ships.',
  north: (v: string) => `${v} N`,
  south: (v: string) => `${v} S`,
});

export const sailNext = translate('sailNext', {
  title: 'What to sail next',
  lead: 'Where a watch would teach most about this compass: four hours on one compass heading; three watches are on three successive days. The band is the 95 % band, as a mean over all headings.',
  here: 'In these waters',
  elsewhere: 'For other waters',
  between: (from: string, to: string) => `Between ${from} and ${to}`,
  anyHeading: 'On any heading',
  latitudes: (from: string, to: string) => `Between ${from} and ${to}, magnetic latitude`,
  and: (before: string, last: string) => `${before} and ${last}`,
  gainHere: (now: string, one: string, three: string) =>
    `A watch would narrow the band from ${now} to ${one}, three watches on one of these headings to ${three}.`,
  gainElsewhere: (now: string, heading: string, one: string, headings: string, three: string) =>
    `A watch on about ${heading} there would narrow the band in other waters from ${now} to ${one}, three watches (${headings}) to ${three}.`,
  elsewhereNow: (mean: string, worst: string) =>
    `In other magnetic latitudes the band is ${mean} as a mean, ${worst} at worst.`,
  nothing: (band: string, floor: string, most: string) =>
    `Neither one watch nor three would narrow the band noticeably. It is ${band}, and the reference’s own constant error, which no heading shows, is ${floor} by itself: nothing sailed narrows the band by more than ${most}.`,
  takeAzimuths: 'Take an azimuth',
  gainAzimuths: (now: string, one: string, many: string) =>
    `Only azimuths show the error of the gyro or satellite compass itself. One, of the sun or of a transit, would narrow the band here from ${now} to ${one}; twenty in the course of a voyage to ${many}.`,
  magneticLatitude:
    'Magnetic latitude follows the dip of the earth’s field; it differs from the chart’s latitude by some ten degrees.',
});

export const parameters = translate('parameters', {
  title: 'The ship’s magnetism',
  lead: 'The seven quantities behind the curve, each in proportion to the mean shielding λ, and the constant.',
  name: 'Quantity',
  value: 'Value ± standard error',
  basis: 'Known from',
  bases: {
    own: 'her own headings',
    mostly: 'mostly her own',
    little: 'mostly ships at large',
    ships: 'ships at large',
    unknown: 'not stated',
  },
  shareTitle: (percent: string) => `${percent} of what was uncertain before has been settled`,
  names: {
    bx_nt: ['Permanent fore-and-aft magnetism', 'P, forward positive'],
    chi13: ['Fore-and-aft, induced by the vertical field', 'c'],
    by_nt: ['Permanent athwartship magnetism', 'Q, starboard positive'],
    chi23: ['Athwartship, induced by the vertical field', 'f'],
    chi11_minus_chi22: ['Horizontal soft iron, fore-and-aft less athwartship', 'a − e'],
    chi12: ['Fore-and-aft, induced by the athwartship field', 'b'],
    chi21: ['Athwartship, induced by the fore-and-aft field', 'd'],
    constant_deg: ['Constant', 'alignment, reference and variation offsets'],
  } satisfies Record<ParameterName, [string, string]>,
  summary: (own: number, all: number) =>
    own === all
      ? 'Her own headings tell all of them apart.'
      : `Her own headings tell ${own} of the ${all} apart. Where she has been the curve needs only their sums, the coefficients.`,
  help: 'What they do not tell leans on what is usual in ships, or on what she was before a repair.',
  about: 'What some are known for only together',
  pairs:
    'One magnetic latitude tells P + c Z and Q + f Z, the fields of coefficients B and C, much better than their parts; sailing to another tells the parts.',
  constant:
    'Headings cannot tell the constant from A = (d − b)/2, nor the lubber line’s offset from that of the reference or the variation: only the whole is known, shown as coefficient A (includes alignment, reference and variation offsets). E is half of b + d.',
  condition: (ratio: string) =>
    `By her own data the least known combination is ${ratio} times less certain than the best known.`,
  conditionOpen: 'Her own data leave one combination quite open.',
  details: 'Where these figures come from',
  hash: 'Input',
  estimator: 'Estimator',
  created: 'Computed',
  epoch: 'Epoch',
  epochOpen: 'now',
  epochStart: 'the beginning',
  to: 'to',
});

export const coefficients = translate('coefficients', {
  title: 'Coefficients',
  lead: 'At the last position. Exact ones, with their standard errors, give the curve by the exact formula; handbook ones are the five-term approximation that older tables and adjusters use.',
  name: 'Coefficient',
  exact: 'Exact',
  handbook: 'Handbook',
  meaning: {
    A: 'the same on all headings (includes alignment, reference and variation offsets)',
    B: 'fore-and-aft magnetism: greatest on east and west',
    C: 'athwartship magnetism: greatest on north and south',
    D: 'soft iron along and across: quadrantal, greatest on intercardinals',
    E: 'soft iron askew: quadrantal, greatest on cardinals',
  },
});
