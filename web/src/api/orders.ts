/** The calls about work orders: what is asked, and what is written at once. */

import { answer, client, everyPage, longestPage, page } from './client';
import type { Write } from '../orders/writes';
import { Problem } from './problem';
import type {
  BinnacleRevision,
  NewOffer,
  NewOrderMessage,
  NewRetime,
  NewWorkOrder,
  OfferAnswer,
  OfferProposal,
  WorkOrder,
} from './types';

/** What crosses a bad connection may take its time; the server waits two minutes. */
const patienceMs = 60_000;
const photoPatienceMs = 180_000;

export const listOrders = (vessel?: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/work-orders', {
        params: {
          query: { ...(vessel === undefined ? {} : { vessel }), ...page(longestPage, after) },
        },
      }),
    ),
  );

export const findOrder = (id: string) =>
  answer(
    client.GET('/api/v1/work-orders/{id}', {
      params: { path: { id } },
      signal: AbortSignal.timeout(patienceMs),
    }),
  );

export const listOrderEntries = (id: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/work-orders/{id}/entries', {
        params: { path: { id }, query: page(longestPage, after) },
      }),
    ),
  );

/** What the planner offers for the last reading. */
export const findOffer = (id: string) =>
  answer(client.GET('/api/v1/work-orders/{id}/plan', { params: { path: { id } } }));

export const createOrder = (body: NewWorkOrder, key: string): Promise<WorkOrder> =>
  answer(
    client.POST('/api/v1/work-orders', { params: { header: { 'Idempotency-Key': key } }, body }),
  );

const toPath = (id: string, key: string) => ({
  path: { id },
  header: { 'Idempotency-Key': key },
});

export const cancelOrder = (id: string, text: string, key: string) =>
  answer(
    client.POST('/api/v1/work-orders/{id}/cancel', { params: toPath(id, key), body: { text } }),
  );

export const closeOrder = (id: string, text: string, key: string) =>
  answer(
    client.POST('/api/v1/work-orders/{id}/close', {
      params: toPath(id, key),
      body: { text, without_verification: false },
    }),
  );

/** Closes an order that was adjusted, though no headings at sea have spoken. */
export const closeUnverified = (id: string, text: string, key: string) =>
  answer(
    client.POST('/api/v1/work-orders/{id}/close', {
      params: toPath(id, key),
      body: { text, without_verification: true },
    }),
  );

/** The binnacle of an order's compass, for a firm that is asked or has it; `null` where none was entered. */
export async function findOrderBinnacle(id: string): Promise<BinnacleRevision | null> {
  const params = { path: { id } };
  try {
    return await answer(client.GET('/api/v1/work-orders/{id}/binnacle', { params }));
  } catch (error) {
    if (error instanceof Problem && error.status === 404) return null;
    throw error;
  }
}

/** The model of an order's compass, for a firm that is asked or has it. */
export const findOrderModel = (id: string) =>
  answer(client.GET('/api/v1/work-orders/{id}/model', { params: { path: { id } } }));

export const offerOrder = (id: string, body: NewOffer, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/offer', { params: toPath(id, key), body }));

/** A firm takes what it is offered; an operator agrees to what a firm proposed. */
export const acceptOrder = (id: string, body: OfferAnswer, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/accept', { params: toPath(id, key), body }));

/** A firm will not have it, or gives it back; an operator does not agree. */
export const declineOrder = (id: string, body: OfferAnswer, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/decline', { params: toPath(id, key), body }));

export const proposeTerms = (id: string, body: OfferProposal, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/propose', { params: toPath(id, key), body }));

/** The operator asks the firm that has an order for another time. */
export const askRetime = (id: string, body: NewRetime, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/retime', { params: toPath(id, key), body }));

export const acceptRetime = (id: string, body: OfferAnswer, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/retime/accept', { params: toPath(id, key), body }));

/** The firm does not agree, or the operator takes its question back. */
export const declineRetime = (id: string, body: OfferAnswer, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/retime/decline', { params: toPath(id, key), body }));

/** What operator and firm wrote to each other, the oldest first. */
export const listOrderMessages = (id: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/work-orders/{id}/messages', {
        params: { path: { id }, query: page(longestPage, after) },
      }),
    ),
  );

export const sendOrderMessage = (id: string, body: NewOrderMessage, key: string) =>
  answer(client.POST('/api/v1/work-orders/{id}/messages', { params: toPath(id, key), body }));

/** Sends a write from the binnacle; the order as it is then. */
export function sendWrite({ order, key, content }: Write): Promise<WorkOrder> {
  const params = toPath(order, key);
  const signal = AbortSignal.timeout(content.kind === 'photo' ? photoPatienceMs : patienceMs);
  switch (content.kind) {
    case 'on_board':
      return answer(
        client.POST('/api/v1/work-orders/{id}/on-board', {
          params,
          body: { at: content.at },
          signal,
        }),
      );
    case 'as_found':
      return answer(
        client.POST('/api/v1/work-orders/{id}/as-found', {
          params,
          body: content.body,
          signal,
        }),
      );
    case 'reading':
      return answer(
        client.POST('/api/v1/work-orders/{id}/berth-reading', {
          params,
          body: content.body,
          signal,
        }),
      );
    case 'plan':
      return answer(
        client.POST('/api/v1/work-orders/{id}/plan', {
          params,
          body: { plan: content.plan },
          signal,
        }),
      );
    case 'step':
      return answer(
        client.POST('/api/v1/work-orders/{id}/steps/{n}', {
          params: { ...params, path: { id: order, n: content.number } },
          body: content.body,
          signal,
        }),
      );
    case 'settings':
      return answer(
        client.POST('/api/v1/work-orders/{id}/corrector-settings', {
          params,
          body: content.body,
          signal,
        }),
      );
    case 'second_reading':
      return answer(
        client.POST('/api/v1/work-orders/{id}/second-reading', {
          params,
          body: content.body,
          signal,
        }),
      );
    case 'remark':
      return answer(
        client.POST('/api/v1/work-orders/{id}/remarks', {
          params,
          body: { text: content.text },
          signal,
        }),
      );
    case 'completion':
      return answer(
        client.POST('/api/v1/work-orders/{id}/complete', { params, body: content.body, signal }),
      );
    case 'photo':
      return answer(
        client.POST('/api/v1/work-orders/{id}/photos', {
          params: { ...params, query: content.caption === '' ? {} : { caption: content.caption } },
          // The file goes as it is; the document calls its bytes a string.
          body: content.file as unknown as string,
          bodySerializer: () => content.file,
          headers: { 'Content-Type': 'application/octet-stream' },
          signal,
        }),
      );
  }
}
