/** The calls of a beginning: an empty server, its vessels, invitations, a forgotten password. */

import { answer, client } from './client';
import type { NewCompanyUser, NewFirstOperator } from './types';

/** Whether the server has no user yet. */
export const isEmptyServer = async () => (await answer(client.GET('/api/v1/first-run'))).open;

/** Makes the first operator and its admin, who then signs in. */
export const beginServer = (body: NewFirstOperator) =>
  answer(client.POST('/api/v1/first-run', { body }));

/** Asks for a code by mail with which to set a new password. */
export const requestPasswordReset = (email: string) =>
  answer(client.POST('/api/v1/password-resets', { body: { email } }));

/** A file of vessels, as it is. */
export const sendVesselsCsv = (file: Blob) =>
  answer(
    client.POST('/api/v1/vessels.csv', {
      body: file as unknown as string,
      bodySerializer: () => file,
      headers: { 'Content-Type': 'text/csv' },
    }),
  );

/** Records in the logbook on which day a vessel's compass was last adjusted. */
export const recordAdjustment = (vessel: string, compass: string, day: string, key: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/logbook', {
      params: { path: { id: vessel }, header: { 'Idempotency-Key': key } },
      body: { kind: 'adjustment', from: `${day}T12:00:00Z`, compass_id: compass, note: '' },
    }),
  );

export const inviteAdmin = (operator: string, body: NewCompanyUser) =>
  answer(client.POST('/api/v1/operators/{id}/users', { params: { path: { id: operator } }, body }));

export const inviteAdjuster = (firm: string, body: NewCompanyUser) =>
  answer(client.POST('/api/v1/firms/{id}/users', { params: { path: { id: firm } }, body }));
