/** The calls about work orders: what is asked, and what is written at once. */

import { answer, client, everyPage, longestPage, page } from './client';
import type { Write } from '../orders/writes';
import type { NewWorkOrder, WorkOrder } from './types';

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
    client.POST('/api/v1/work-orders/{id}/close', { params: toPath(id, key), body: { text } }),
  );

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
          // The file goes as it is; the document calls its octets numbers.
          body: content.file as unknown as number[],
          bodySerializer: () => content.file,
          headers: { 'Content-Type': 'application/octet-stream' },
          signal,
        }),
      );
  }
}
