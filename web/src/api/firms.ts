/** The calls about firms that adjust compasses. */

import { answer, client, longestPage, page } from './client';
import type { FirmTerms } from './types';

export const listFirmKeys = async (id: string) => {
  const params = { path: { id }, query: page(longestPage) };
  return (await answer(client.GET('/api/v1/firms/{id}/keys', { params }))).items;
};

export const setTerms = (id: string, body: FirmTerms) =>
  answer(client.PUT('/api/v1/firms/{id}/terms', { params: { path: { id } }, body }));

export const endTerms = (id: string) =>
  answer(client.DELETE('/api/v1/firms/{id}/terms', { params: { path: { id } } }));
