/** Terms of an order as they are typed and told. Pure. */

import type { WorkOrderTerms } from '../api/types';
import { count, hoursAtSea } from '../format';
import * as text from '../text';

const mostEuros = 1_000_000;

/** The euros that were typed, a comma for a point where one was; `null` for none. */
export const feeOf = (typed: string): number | null =>
  typed.trim() === '' ? null : Number(typed.trim().replace(',', '.'));

export function isFee(typed: string): boolean {
  const euros = feeOf(typed);
  return euros === null || (euros >= 0 && euros <= mostEuros);
}

/** A fee for people, with its cents where it has any; empty where none is said. */
export function feeInWords(euros: number | null | undefined): string {
  if (euros === null || euros === undefined) return '';
  const cents = Math.round(euros * 100);
  const rest =
    cents % 100 === 0 ? '' : `${text.formats.decimal}${String(cents % 100).padStart(2, '0')}`;
  return text.offers.terms.euros(`${count(Math.floor(cents / 100))}${rest}`);
}

/** Hours, berth and fee in a line, in UTC as a log has it. */
export function termsInWords(terms: WorkOrderTerms): string {
  return [
    hoursAtSea(terms.planned_at, terms.planned_until, undefined, 'utc'),
    terms.berth,
    feeInWords(terms.fee_eur),
  ]
    .filter((part) => part)
    .join(', ');
}
