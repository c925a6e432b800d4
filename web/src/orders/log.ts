/** An entry of an order's log as a line for people. Pure. */

import type { WorkOrderEntry, WorkOrderTerms } from '../api/types';
import { dated, degrees, fineHeading, fixed } from '../format';
import * as text from '../text';
import { feeInWords, termsInWords } from './terms';

interface Line {
  /** Neither is told of what is between the operator and another firm. */
  at: string | null;
  author: string | null;
  title: string;
  words: string;
}

/** What this page reads of entries; one of a kind that it does not know has a title all the same. */
interface Read {
  kind: string;
  at: string;
  author: { name: string };
  content: {
    firm_name?: string;
    firms?: { firm_name: string }[];
    text?: string;
    caption?: string | null;
    number?: number;
    after_deg?: number;
    verdict?: string;
    words?: string;
    chosen?: number;
    offered?: unknown[];
    refusal?: { words: string; could_be: string[] } | null;
    checked?: { lambda: number; consistency_deg: number } | null;
    adjuster_name?: string;
    note?: string | null;
    port?: string;
    fee_eur?: number;
    terms?: WorkOrderTerms;
  };
}

export function lineOf({ entry }: WorkOrderEntry): Line {
  const { kind, at, author, content } = entry as unknown as Partial<Read>;
  if (kind === undefined || author === undefined || at === undefined) {
    return { at: null, author: null, title: text.order.log.withheld, words: '' };
  }
  return {
    at,
    author: author.name,
    title: title(kind, content?.firm_name),
    words: words(kind, content ?? {}),
  };
}

function title(kind: string, firm: string | undefined): string {
  const { kinds, between } = text.order.log;
  const named = firm === undefined ? undefined : between[kind]?.(firm);
  return named ?? kinds[kind] ?? kind.replaceAll('_', ' ');
}

/** What was found, and what alone would explain it. */
function refused({ words, could_be }: { words: string; could_be: string[] }): string {
  return `${text.order.log.refused}: ${[dated(words), ...could_be].join('; ')}`;
}

function words(kind: string, content: Read['content']): string {
  switch (kind) {
    case 'opened':
      return content.port ?? '';
    case 'offered':
      return (content.firms ?? []).map(({ firm_name }) => firm_name).join(', ');
    case 'berth_reading':
      if (content.refusal) return refused(content.refusal);
      return content.checked
        ? `λ ${fixed(content.checked.lambda, 3)}, ${degrees(content.checked.consistency_deg)}`
        : '';
    case 'plan':
      return content.chosen === undefined
        ? ''
        : text.order.plan.chosen(content.chosen, content.offered?.length ?? 0);
    case 'step': {
      const said = text.berth.step.verdict[content.verdict ?? ''] ?? dated(content.words ?? '');
      return `${content.number ?? ''}, ${fineHeading(content.after_deg)}. ${said}`;
    }
    case 'photo':
      return content.caption ?? '';
    case 'second_reading':
      return text.berth.again.verdict[content.verdict ?? ''] ?? dated(content.words ?? '');
    case 'completion':
      return content.adjuster_name ?? '';
    case 'verification':
      return dated(content.words ?? '');
    default:
      return [
        feeInWords(content.fee_eur),
        content.terms ? termsInWords(content.terms) : '',
        content.text ?? content.note ?? '',
      ]
        .filter((part) => part !== '')
        .join('. ');
  }
}
