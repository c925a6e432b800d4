/** The calls about binnacles, and about what a card says of ship and compass. */

import { answer, client, everyPage, longestPage, page } from './client';
import type {
  Binnacle,
  BinnacleRevision,
  CompassAmendment,
  NewCompass,
  VesselAmendment,
} from './types';

export const listBinnacleTypes = () => answer(client.GET('/api/v1/binnacle-types'));

/** What each compass of the fleet stands in. */
export const listBinnacles = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/binnacles', { params: { query: page(longestPage, after) } })),
  );

export const findBinnacleType = (name: string) =>
  answer(client.GET('/api/v1/binnacle-types/{name}', { params: { path: { name } } }));

/** How a compass's binnacle stands; `null` where none was ever entered. */
export async function findBinnacle(id: string, compass: string): Promise<BinnacleRevision | null> {
  const found = await answer(
    client.GET('/api/v1/vessels/{id}/compasses/{compass}/binnacle/revisions', {
      params: { path: { id, compass }, query: { limit: 1 } },
    }),
  );
  return found.items[0] ?? null;
}

/** Writes the next revision; under the same key the same one is written once. */
export const putBinnacle = (
  id: string,
  compass: string,
  body: Binnacle,
  reason: string,
  key: string,
) =>
  answer(
    client.PUT('/api/v1/vessels/{id}/compasses/{compass}/binnacle', {
      params: {
        path: { id, compass },
        query: reason === '' ? {} : { reason },
        header: { 'Idempotency-Key': key },
      },
      body,
    }),
  );

/** Where the browser gets the binnacle as a file. */
export const binnacleFile = (id: string, compass: string): string =>
  `/api/v1/vessels/${encodeURIComponent(id)}/compasses/${encodeURIComponent(compass)}/binnacle.json`;

export const amendVessel = (id: string, body: VesselAmendment) =>
  answer(client.PATCH('/api/v1/vessels/{id}', { params: { path: { id } }, body }));

export const amendCompass = (id: string, compass: string, body: CompassAmendment) =>
  answer(
    client.PATCH('/api/v1/vessels/{id}/compasses/{compass}', {
      params: { path: { id, compass } },
      body,
    }),
  );

export const createCompass = (id: string, body: NewCompass, key: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/compasses', {
      params: { path: { id }, header: { 'Idempotency-Key': key } },
      body,
    }),
  );
