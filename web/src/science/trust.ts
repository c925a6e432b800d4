/** How far a model can be trusted, in an officer's words. */

import type { Caution, DeviationRow, Model, Predictions, Prior, References } from '../api/types';
import { count, day, degrees, fixed, heading, microtesla, time } from '../format';
import * as text from '../text';
import { size } from './advice';
import { normal95 } from './band';
import { magneticLatitude } from './coverage';
import type { Foretold } from './foretold';
import { goodDeg, goodRanges, worstWaters, type Range, type Waters } from './reach';

/** Fewer watches than these say nothing of a band that holds nineteen times in twenty. */
const fewestWatches = 20;

/** A figure to take in at a glance, and what it means. */
export interface Statement {
  figure: string;
  meaning: string;
}

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.trust;

/** The band at the place of a table; none where the model came without one. */
export function here(rows: DeviationRow[]): Statement | null {
  const banded = rows.flatMap(({ compass_deg, band95_deg }) =>
    typeof band95_deg === 'number' ? [{ compass_deg, band95_deg }] : [],
  );
  const [first] = banded;
  if (!first) return null;
  const widest = banded.reduce((a, b) => (b.band95_deg > a.band95_deg ? b : a), first);
  const narrowest = banded.reduce((a, b) => (b.band95_deg < a.band95_deg ? b : a), first);
  const [most, least] = [size(widest.band95_deg), size(narrowest.band95_deg)];
  if (most === least) return { figure: most, meaning: t().hereEven };
  return {
    figure: most,
    meaning: t().here(heading(widest.compass_deg), least, heading(narrowest.compass_deg)),
  };
}

/** Where the model is good, and how far it may be off where it is not. */
export function elsewhere(waters: Waters[]): Statement | null {
  const worst = worstWaters(waters);
  if (!worst) return null;
  const figure = size(worst.widest.band95_deg);
  const good = goodRanges(waters);
  const limit = size(goodDeg, 0);
  const at = rangeWords(worst);
  if (good.length === 0) return { figure, meaning: t().nowhereGood(limit, at) };
  const ranges = list(good.map(rangeWords));
  if (waters.every(({ widest }) => widest && widest.band95_deg <= goodDeg)) {
    return { figure, meaning: t().everywhereGood(limit, ranges) };
  }
  return { figure, meaning: t().elsewhere(limit, ranges, figure, at) };
}

/** What the samples are worth; none in a model that came without. */
export function worth(model: Model): Statement | null {
  if (!model.quality) return null;
  const { effective_samples: effective } = model.quality;
  return {
    figure: count(effective),
    meaning: t().worth(count(model.samples_used), count(effective)),
  };
}

/** What the model started from, before the vessel's own samples. */
export function startedFrom({ basis, refused }: Prior): Statement {
  if (!basis) {
    const meaning = refused.length > 0 ? t().priorTooFew : t().priorUsual;
    return { figure: t().priorAtLarge, meaning };
  }
  const ships = count(basis.ships);
  const published = day(basis.published_at);
  if (basis.class.kind === 'sisters') {
    const meaning = t().priorOfSisters(basis.class.name, published);
    return { figure: t().priorSisters(ships), meaning };
  }
  return { figure: t().priorFleet(ships), meaning: t().priorOfFleet(published) };
}

/** What has been measured since an adjustment that foretold the model. */
export function sinceAdjustment({ verification }: Foretold): Statement {
  const words = text.foretold;
  if (!verification) return { figure: words.worthNone, meaning: words.worthNoneLong };
  return { figure: count(verification.samples), meaning: words.worth(time(verification.until)) };
}

export function cautionWords(caution: Caution): string {
  switch (caution.caution) {
    case 'one_magnetic_latitude':
      return t().oneMagneticLatitude;
    case 'few_samples':
      return t().fewSamples;
    case 'no_times':
      return t().noTimes;
    case 'large_residuals':
      return t().largeResiduals(degrees(caution.residual_deg));
    case 'long_gap':
      return t().longGap(count(Math.round(caution.days)), day(caution.last));
    case 'weak_field':
      return t().weakField(microtesla(caution.h_nt));
    case 'variation_unproven':
      return t().variationUnproven(
        degrees(Math.abs(caution.zero_deg)),
        text.refusal.variationMistakes[caution.mistake],
      );
    default:
      // A newer server may know more than this page does.
      return t().unknown;
  }
}

/** How often what was predicted came true; none before enough watches. */
export function predictions(found: Predictions): Statement | null {
  if (found.watches < fewestWatches) return null;
  const figure = t().predictions(count(found.watches_inside), count(found.watches));
  const [from, to] = [count(found.expected_from), count(found.expected_to)];
  if (found.widening <= 1.05) return { figure, meaning: t().predictionsHeld(from, to) };
  return { figure, meaning: t().predictionsShort(from, to, fixed(found.widening, 1)) };
}

/** How gyro and satellite compass compare. */
export function references(found: References): Statement {
  const left = size(normal95 * found.constant_sd_deg);
  if (found.pairs === 0) return { figure: t().oneReference, meaning: t().oneReferenceLong(left) };
  const pairs = count(found.pairs);
  if (typeof found.offset_deg !== 'number') {
    return { figure: t().notCompared, meaning: t().notComparedLong(pairs, left) };
  }
  const apart = degrees(Math.abs(found.offset_deg));
  const usual = found.offset_deg < 0 ? t().gyroBehind(apart, pairs) : t().gyroAhead(apart, pairs);
  return { figure: t().apart(apart), meaning: `${usual} ${t().constantLeft(left)}` };
}

/** How many readings were not believed, and why; empty where all were. */
export function dropped(found: References): string {
  if (found.gyro_dropped + found.satellite_dropped === 0) return '';
  const counts = t().dropped(count(found.gyro_dropped), count(found.satellite_dropped));
  if (typeof found.offset_deg !== 'number') return `${counts} ${t().droppedStuck}`;
  return `${counts} ${t().droppedWhy(degrees(found.failed_beyond_deg))}`;
}

function rangeWords({ fromDeg, toDeg }: Range): string {
  // A latitude is never broken over two lines.
  const shown = (value: number) => magneticLatitude(value).replace(' ', '\u00a0');
  return t().between(shown(fromDeg), shown(toDeg));
}

function list(words: string[]): string {
  if (words.length < 2) return words.join('');
  return text.sailNext.and(words.slice(0, -1).join(', '), words.at(-1) ?? '');
}
