/** Why there is no model, in an officer's words: what is missing, and what to do. */

import type { Refusal } from '../api/types';
import { count, degrees, microtesla } from '../format';
import { text } from '../text';

export interface RefusalWords {
  missing: string;
  todo: string;
}

const t = text.refusal;

/** None for a reason that a newer server knows and this page does not. */
export function refusalWords(refusal: Refusal): RefusalWords | null {
  switch (refusal.reason) {
    case 'too_few_samples':
      return {
        missing: t.tooFewSamples(count(refusal.found), count(refusal.needed)),
        todo: t.tooFewSamplesTodo,
      };
    case 'too_few_headings':
      return {
        missing: t.tooFewHeadings(
          refusal.found,
          refusal.needed,
          degrees(refusal.widest_gap_deg, 0),
          degrees(refusal.allowed_gap_deg, 0),
        ),
        todo: t.tooFewHeadingsTodo,
      };
    case 'field_too_weak':
      return {
        missing: t.fieldTooWeak(microtesla(refusal.strongest_nt), microtesla(refusal.needed_nt)),
        todo: t.fieldTooWeakTodo,
      };
    case 'ambiguous_headings':
      return {
        missing: t.ambiguousHeadings(microtesla(refusal.h_nt)),
        todo: t.ambiguousHeadingsTodo,
      };
    case 'one_magnetic_latitude':
      return { missing: t.oneMagneticLatitude, todo: t.oneMagneticLatitudeTodo };
    case 'references_disagree':
      return {
        missing: t.referencesDisagree(
          degrees(Math.abs(refusal.offset_deg)),
          degrees(refusal.allowed_deg, 0),
        ),
        todo: t.referencesDisagreeTodo,
      };
    case 'reference_stuck':
      return { missing: t.referenceStuck(count(refusal.readings)), todo: t.referenceStuckTodo };
    case 'not_converged':
      return { missing: t.notConverged, todo: t.notConvergedTodo };
    default:
      return null;
  }
}
