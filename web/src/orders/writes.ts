/**
 * What is written of an order at the binnacle, on its way to the server. Pure.
 *
 * What always holds: writes are sent one after the other, in the order in which they
 * were made; what the server refused is not sent again by itself, and what was built
 * upon it waits for a person.
 */

import type {
  AdjustmentRefusal,
  AsFound,
  BerthReading,
  Completion,
  CorrectorSettings,
  SecondReading,
  WorkOrder,
} from '../api/types';

/** What is written. */
export type Content =
  | { kind: 'on_board'; at: string }
  | { kind: 'as_found'; body: AsFound }
  | { kind: 'reading'; body: BerthReading }
  | { kind: 'plan'; plan: number }
  | { kind: 'step'; number: number; body: { before_deg?: number; after_deg: number } }
  | { kind: 'settings'; body: CorrectorSettings }
  | { kind: 'second_reading'; body: SecondReading }
  | { kind: 'remark'; text: string }
  | { kind: 'photo'; caption: string; file: Blob }
  | { kind: 'completion'; body: Completion };

/** Why the server did not take it. */
export interface Refused {
  status: number;
  /** The problem's last word; `superseded` where what it was built upon did not hold. */
  kind: string;
  detail: string;
  refusals: AdjustmentRefusal[];
}

/** A write that the server has not taken yet. */
export interface Write {
  /** Counts up: their order. */
  seq: number;
  order: string;
  /** Who made it: nobody else's session sends it. */
  user: string;
  /** The same with each try, so that it is written once. */
  key: string;
  /** When it was made. */
  at: string;
  content: Content;
  refused?: Refused | undefined;
}

/** What follows from a plan and its steps, and is void with them. */
const builtUpon: Content['kind'][] = ['plan', 'step', 'completion'];
const foundations: Content['kind'][] = [
  'as_found',
  'reading',
  'plan',
  'step',
  'settings',
  'second_reading',
];

/** The write to be sent now. */
export function nextToSend(writes: Write[], user: string): Write | undefined {
  return writes.find((write) => write.user === user && !write.refused);
}

/** The writes that must not follow one that did not hold: up to the next reading. */
export function builtOn(writes: Write[], failed: Write): Write[] {
  if (!foundations.includes(failed.content.kind)) return [];
  const later = writes.filter(
    (write) => write.order === failed.order && write.seq > failed.seq && !write.refused,
  );
  const afresh = later.findIndex((write) => write.content.kind === 'reading');
  const until = afresh < 0 ? later : later.slice(0, afresh);
  return until.filter((write) => builtUpon.includes(write.content.kind));
}

/** Whether an answer bears out what was written, so that what was built upon it holds. */
export function bearsOut(content: Content, answered: WorkOrder): boolean {
  if (content.kind === 'second_reading') {
    return answered.second_reading?.verdict === 'as_planned';
  }
  if (content.kind !== 'step') return true;
  const verdict = answered.last_step?.verdict;
  return verdict === 'confirmed' || verdict === 'not_seen';
}

/** What the server said, if it is a refusal of its own and not a fault on the way. */
export function isRefusal(status: number, kind: string): boolean {
  // A portal or a proxy answers without a problem document; it speaks for nobody.
  if (kind === '' || status < 400 || status >= 500) return false;
  return ![401, 408, 425, 429].includes(status);
}
