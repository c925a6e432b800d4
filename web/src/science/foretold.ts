/** A model that an adjustment foretold, what headings at sea say of it, and which samples do. */

import type {
  ModelVersion,
  SamplePicture,
  WorkOrder,
  WorkOrderSummary,
  OrderVerification,
} from '../api/types';
import { day, heading, position, type Place } from '../format';
import * as text from '../text';
import { dotsOf, type SampleDot } from './residuals';

/** What stands behind a foretold curve. */
export interface Foretold {
  orderId: string;
  /** The order as people know it: its port and its day. */
  order: string;
  /** When it was foretold. */
  at: string;
  place: Place;
  /** Whether headings at sea bear it out. */
  proof: 'none' | 'verified' | 'disproved';
  verification: OrderVerification | null;
}

/**
 * How a model was foretold; none where it was fitted to samples. As long as neither the order
 * nor the vessel's list of them says otherwise, nothing is verified.
 */
export function foretoldOf(
  version: ModelVersion | undefined,
  orders: readonly WorkOrderSummary[],
  whole: WorkOrder | undefined,
): Foretold | null {
  const orderId = version?.foretold_by;
  if (!version || !orderId) return null;
  const order = whole?.id === orderId ? whole : orders.find(({ id }) => id === orderId);
  const verification = whole?.id === orderId ? whole.verification : null;
  const at = version.epoch_from ?? version.created_at;
  return {
    orderId,
    order: order ? text.foretold.order(order.port, day(order.planned_at)) : text.foretold.anOrder,
    at,
    place: version,
    proof: proofOf(order?.state, verification),
    verification,
  };
}

function proofOf(
  state: string | undefined,
  verification: OrderVerification | null,
): Foretold['proof'] {
  const verdict = verification?.verification.verdict;
  if (verdict === 'alarm' || state === 'failed') return 'disproved';
  return verdict === 'passed' || state === 'verified' ? 'verified' : 'none';
}

/** What is to be said beside everything that is drawn from it. */
export function standing({ proof, verification, order, at, place }: Foretold): {
  title: string;
  words: string;
} {
  const t = text.foretold;
  const origin = t.origin(order, day(at), position(place));
  return { title: t.proof[proof], words: `${origin} ${headings(proof, verification)}` };
}

/** How far headings at sea have come. */
function headings(proof: Foretold['proof'], verification: OrderVerification | null): string {
  const t = text.foretold;
  const said = verification?.verification;
  if (said?.verdict === 'more_needed') {
    const best = said.needed.compass_deg.map((deg) => heading(deg)).join(', ');
    return t.needed(said.headings, said.needed.count, best);
  }
  return proof === 'none' ? t.noHeading : '';
}

/** The samples that tell of a model: none of another magnetism than the one it is of. */
export function evidence(
  picture: SamplePicture,
  version: ModelVersion | undefined,
): { dots: SampleDot[]; earlier: boolean } {
  const all = dotsOf(picture.dots);
  const from = version?.foretold_by ? version.epoch_from : version?.data_from;
  if (!from) return { dots: all, earlier: false };
  const fromS = Date.parse(from) / 1000;
  const dots = all.filter((_, i) => (picture.dots.unix_s[i] ?? 0) >= Math.floor(fromS));
  return { dots, earlier: dots.length < all.length };
}
