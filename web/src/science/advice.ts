/** What to sail next, in an officer's words. */

import type { Advice, Band, HeadingRange, SailNext } from '../api/types';
import { degrees, heading, plusMinus } from '../format';
import * as text from '../text';
import { magneticLatitude } from './coverage';

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.sailNext;

/** A range of headings or latitudes, and what a watch and three would do. */
export interface Suggestion {
  where: string;
  gain: string;
}

export function headingSuggestions(advice: SailNext['here']): Suggestion[] {
  return advice.suggestions.map((suggestion) => {
    const [now, one, three] = widths(advice.band, suggestion.after_one, suggestion.after_three);
    return { where: headingRange(suggestion), gain: t().gainHere(now, one, three) };
  });
}

export function latitudeSuggestions(advice: NonNullable<SailNext['elsewhere']>): Suggestion[] {
  return advice.suggestions.map((suggestion) => {
    const [now, one, three] = widths(advice.band, suggestion.after_one, suggestion.after_three);
    const [first = '', ...others] = middles(suggestion.headings);
    return {
      where: latitudeRange(
        suggestion.magnetic_latitude_from_deg,
        suggestion.magnetic_latitude_to_deg,
      ),
      gain: t().gainElsewhere(now, first, one, list([first, ...others]), three),
    };
  });
}

/** What one azimuth and twenty would do. */
export function azimuthGain(azimuths: NonNullable<SailNext['azimuths']>): string {
  const { band, after_one, after_twenty } = azimuths;
  return t().gainAzimuths(...widths(band, after_one, after_twenty));
}

/** How wide the band is, and how much of it no sailing takes away. */
export function remains(advice: Advice, floorDeg: number): string {
  const [band, floor] = widths(advice.band, { rms_deg: floorDeg, worst_deg: floorDeg });
  const most = advice.narrows_at_most_deg;
  return t().nothing(band, floor, degrees(most, most < 0.1 ? 2 : 1));
}

/**
 * The bands' widths with one decimal, or with two where one would not show that
 * they differ.
 */
export function widths<Bands extends Band[]>(...bands: Bands): { [K in keyof Bands]: string } {
  const shown = (digits: number) => bands.map((band) => size(band.rms_deg, digits));
  const rough = shown(1);
  const alike = rough.some((width, i) => i > 0 && width === rough[i - 1]);
  return (alike ? shown(2) : rough) as { [K in keyof Bands]: string };
}

/** As `plusMinus`, but never broken over two lines. */
export function size(value: number, digits = 1): string {
  return plusMinus(value, digits).replace(' ', '\u00a0');
}

/** `Between 030° and 075°`; the whole circle is any heading. */
export function headingRange(range: HeadingRange): string {
  if (range.heading_to_deg - range.heading_from_deg === 360) return t().anyHeading;
  return t().between(heading(range.heading_from_deg), heading(range.heading_to_deg));
}

/** `Between 60° S and 20° N` */
export function latitudeRange(fromDeg: number, toDeg: number): string {
  return t().latitudes(magneticLatitude(fromDeg), magneticLatitude(toDeg));
}

/** The middles of the ranges to the nearest ten degrees, each once. */
function middles(ranges: HeadingRange[]): string[] {
  const middle = ({ heading_from_deg: from, heading_to_deg: to }: HeadingRange) =>
    heading(Math.round((from + (to > from ? to : to + 360)) / 20) * 10);
  return [...new Set(ranges.map(middle))];
}

function list(words: string[]): string {
  if (words.length < 2) return words.join('');
  return t().and(words.slice(0, -1).join(', '), words.at(-1) ?? '');
}
