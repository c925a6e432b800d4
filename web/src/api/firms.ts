/** The calls about firms that adjust compasses. */

import { answer, client, longestPage, page } from './client';
import type { FirmTeams, FirmTerms, NewFirmKey } from './types';

export const listFirmKeys = async (id: string) => {
  const params = { path: { id }, query: page(longestPage) };
  return (await answer(client.GET('/api/v1/firms/{id}/keys', { params }))).items;
};

/** Registers a key; under the same idempotency key the same one is registered once. */
export const registerFirmKey = (id: string, body: NewFirmKey, key: string) =>
  answer(
    client.POST('/api/v1/firms/{id}/keys', {
      params: { path: { id }, header: { 'Idempotency-Key': key } },
      body,
    }),
  );

export const revokeFirmKey = (id: string, key: string) =>
  answer(client.DELETE('/api/v1/firms/{id}/keys/{key}', { params: { path: { id, key } } }));

export const setTerms = (id: string, body: FirmTerms) =>
  answer(client.PUT('/api/v1/firms/{id}/terms', { params: { path: { id } }, body }));

export const endTerms = (id: string) =>
  answer(client.DELETE('/api/v1/firms/{id}/terms', { params: { path: { id } } }));

export const findTeams = (id: string) =>
  answer(client.GET('/api/v1/firms/{id}/teams', { params: { path: { id } } }));

export const setTeams = (id: string, body: FirmTeams) =>
  answer(client.PUT('/api/v1/firms/{id}/teams', { params: { path: { id } }, body }));
