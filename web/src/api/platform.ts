/** The calls of who runs the platform: operators, firms, who works with whom, its health. */

import { answer, client, everyPage, longestPage, page } from './client';

export const listOperators = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/operators', { params: { query: page(longestPage, after) } })),
  );

export const createOperator = (name: string, key: string) =>
  answer(
    client.POST('/api/v1/operators', {
      params: { header: { 'Idempotency-Key': key } },
      body: { name },
    }),
  );

export const listFirms = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/firms', { params: { query: page(longestPage, after) } })),
  );

export const createFirm = (name: string, key: string) =>
  answer(
    client.POST('/api/v1/firms', {
      params: { header: { 'Idempotency-Key': key } },
      body: { name },
    }),
  );

export const engage = (id: string, firm: string) =>
  answer(client.PUT('/api/v1/operators/{id}/firms/{firm}', { params: { path: { id, firm } } }));

export const dismiss = (id: string, firm: string) =>
  answer(client.DELETE('/api/v1/operators/{id}/firms/{firm}', { params: { path: { id, firm } } }));

/** Whether the server can serve requests: its database answers. */
export const isReady = async (): Promise<boolean> =>
  (
    await answer(
      fetch('/readyz', { cache: 'no-store' }).then((response) => ({
        data: { ready: response.ok },
        // Not being ready is an answer here, no failure.
        response: new Response(null, { status: 200, headers: response.headers }),
      })),
    )
  ).ready;
