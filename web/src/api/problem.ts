/** What went wrong with a call, as RFC 9457 problem documents say it. */

import { dated } from '../format';
import * as text from '../text';
import { invalidInWords } from './invalid';
import type { AdjustmentRefusal, CardWithdrawn, LeftOut, Refusal } from './types';

/** What the server refused, or `offline` when it could not be reached. */
export class Problem extends Error {
  constructor(
    readonly status: number,
    /** The last word of the problem's type, such as `no-model-yet`. */
    readonly kind: string,
    detail: string,
    /** Why there is no model, in `no-model-yet` once samples have been analysed. */
    readonly refusal?: Refusal,
    /** Since when and why the last model holds no more, in `no-model-yet`. */
    readonly cardWithdrawn?: CardWithdrawn,
    /** How many samples the logbook leaves out, in `no-model-yet` if there are any. */
    readonly leftOut?: LeftOut,
    /** What is wrong at the berth and what would cure it, in `not-adjustable`. */
    readonly refusals: AdjustmentRefusal[] = [],
    /** The field that is refused, as the document names it, in `invalid`. */
    readonly field?: string,
  ) {
    super(detail);
  }

  get offline(): boolean {
    return this.status === 0;
  }
}

/** Reads a refusal. A proxy in between may answer with something else: then only the status counts. */
export function readProblem(status: number, body: unknown): Problem {
  const about = typeof body === 'object' && body !== null ? body : {};
  const type = 'type' in about && typeof about.type === 'string' ? about.type : '';
  const detail =
    'detail' in about && typeof about.detail === 'string' && about.detail !== ''
      ? about.detail
      : text.problem.unexpected(status);
  const kind = type.split('/').at(-1) ?? '';
  const field = kind === 'invalid' ? /^(\w+): /.exec(detail)?.[1] : undefined;
  const words = kind === 'invalid' ? invalidInWords(detail) : detail;
  // What is said of a file quotes it: its own lines, as they stand there.
  const said = field === 'file' ? detail.slice('file: '.length) : dated(words);
  return new Problem(status, kind, said, ...reasonsIn(about), field);
}

function reasonsIn(
  about: object,
): [
  Refusal | undefined,
  CardWithdrawn | undefined,
  LeftOut | undefined,
  AdjustmentRefusal[] | undefined,
] {
  const { refusal, card_withdrawn, left_out, refusals } = about as {
    refusal?: Refusal | null;
    card_withdrawn?: CardWithdrawn | null;
    left_out?: LeftOut | null;
    refusals?: AdjustmentRefusal[] | null;
  };
  return [
    refusal ?? undefined,
    card_withdrawn ?? undefined,
    left_out ?? undefined,
    refusals ?? undefined,
  ];
}

/** Any error as a problem: what is not one is a fault of ours, and is logged. */
export function asProblem(error: unknown): Problem {
  if (error instanceof Problem) return error;
  console.error(error);
  return new Problem(-1, 'unreadable', text.problem.unreadable);
}
