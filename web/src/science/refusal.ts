/** Why there is no model, in an officer's words: what is missing, and what to do. */

import type { LeftOut, Refusal } from '../api/types';
import { count, degrees, heading, microtesla } from '../format';
import * as text from '../text';

export interface RefusalWords {
  missing: string;
  todo: string;
}

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.refusal;

/** What the logbook leaves out, by kind of entry; nothing where it leaves out nothing. */
export function leftOutWords(leftOut: LeftOut | undefined): string | null {
  if (!leftOut) return null;
  const kinds = (['magnetic_cargo', 'berth'] as const)
    .filter((kind) => leftOut[kind] > 0)
    .map((kind) => t().leftOutFor(count(leftOut[kind]), text.logbook.kinds[kind].toLowerCase()));
  return kinds.length === 0 ? null : t().leftOut(kinds.join(', '));
}

/** None for a reason that a newer server knows and this page does not. */
export function refusalWords(refusal: Refusal): RefusalWords | null {
  switch (refusal.reason) {
    case 'too_few_samples':
      return {
        missing: t().tooFewSamples(count(refusal.found), count(refusal.needed)),
        todo: t().tooFewSamplesTodo,
      };
    case 'no_reference':
      return { missing: t().noReference(count(refusal.readings)), todo: t().noReferenceTodo };
    case 'no_steady_course':
      return {
        missing: t().noSteadyCourse(
          count(refusal.readings),
          count(refusal.found),
          count(refusal.needed),
          count(refusal.too_slow),
          count(refusal.least_sog_kn),
          count(refusal.turning),
        ),
        todo: t().noSteadyCourseTodo,
      };
    case 'no_weight':
      return { missing: t().noWeight(count(refusal.samples)), todo: t().noWeightTodo };
    case 'too_few_headings':
      return {
        missing: [
          t().tooFewHeadings(
            refusal.found,
            refusal.needed,
            degrees(refusal.widest_gap_deg, 0),
            degrees(refusal.allowed_gap_deg, 0),
          ),
          ...missingRanges(refusal.missing_deg),
        ].join(' '),
        todo: t().tooFewHeadingsTodo,
      };
    case 'field_too_weak':
      return {
        missing: t().fieldTooWeak(microtesla(refusal.strongest_nt), microtesla(refusal.needed_nt)),
        todo: t().fieldTooWeakTodo,
      };
    case 'ambiguous_headings':
      return {
        missing: t().ambiguousHeadings(microtesla(refusal.h_nt)),
        todo: t().ambiguousHeadingsTodo,
      };
    case 'one_magnetic_latitude':
      return { missing: t().oneMagneticLatitude, todo: t().oneMagneticLatitudeTodo };
    case 'references_disagree':
      return {
        missing: t().referencesDisagree(
          degrees(Math.abs(refusal.offset_deg)),
          degrees(refusal.allowed_deg, 0),
        ),
        todo: t().referencesDisagreeTodo,
      };
    case 'reference_stuck':
      return { missing: t().referenceStuck(count(refusal.readings)), todo: t().referenceStuckTodo };
    case 'contradictory':
      return {
        missing: t().contradictory(degrees(refusal.residual_deg), degrees(refusal.allowed_deg, 0)),
        todo: t().contradictoryTodo,
      };
    case 'reference_is_compass':
      return {
        missing: t().referenceIsCompass(
          count(refusal.samples),
          degrees(refusal.scatter_deg, 2),
          degrees(refusal.least_deg, 2),
        ),
        todo: t().referenceIsCompassTodo,
      };
    case 'variation_mistaken':
      return {
        missing: t().variationMistaken(
          t().variationMistakes[refusal.mistake],
          degrees(refusal.residual_deg),
          degrees(refusal.explained_deg),
        ),
        todo: t().variationMistakenTodo,
      };
    case 'few_samples_used':
      return {
        missing: t().fewSamplesUsed(count(refusal.used), count(refusal.found)),
        todo: t().fewSamplesUsedTodo,
      };
    case 'model_does_not_explain':
      return {
        missing: t().modelDoesNotExplain(
          degrees(refusal.residual_deg),
          degrees(refusal.allowed_deg, 0),
        ),
        todo: t().modelDoesNotExplainTodo,
      };
    case 'not_converged':
      return { missing: t().notConverged, todo: t().notConvergedTodo };
    default:
      return null;
  }
}

/** The headings to steer; nothing where a refusal of an older analysis lacks them. */
function missingRanges(ranges: number[][] | undefined): string[] {
  if (!ranges || ranges.length === 0) return [];
  const shown = ranges.map(([from = 0, to = 0]) => `${heading(from)} – ${heading(to % 360)}`);
  return [t().missing(shown.join(', '))];
}
