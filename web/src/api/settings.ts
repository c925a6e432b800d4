/** The calls about people: oneself, one's company, and what may act for them. */

import { answer, client, everyPage, longestPage, page } from './client';
import type { AuditQuery } from '../audit';
import type { ChangedUser, NewToken, NewUser } from './types';

const all = { query: page(longestPage) };

export const changePassword = (current: string, wanted: string) =>
  answer(client.PUT('/api/v1/me/password', { body: { current, new: wanted } }));

/** What an authenticator app needs; nothing is asked for before it is confirmed. */
export const beginSecondFactor = (password: string) =>
  answer(client.POST('/api/v1/me/second-factor', { body: { password } }));

export const confirmSecondFactor = (code: string) =>
  answer(client.POST('/api/v1/me/second-factor/confirm', { body: { code } }));

export const renewRecoveryCodes = (password: string) =>
  answer(client.POST('/api/v1/me/second-factor/recovery-codes', { body: { password } }));

export const removeSecondFactor = (password: string) =>
  answer(client.POST('/api/v1/me/second-factor/remove', { body: { password } }));

export const listSessions = async () =>
  (await answer(client.GET('/api/v1/sessions', { params: all }))).items;

export const endSession = (id: string) =>
  answer(client.DELETE('/api/v1/sessions/{id}', { params: { path: { id } } }));

/** Ends all but this one. */
export const endOtherSessions = () => answer(client.DELETE('/api/v1/sessions'));

export const listTokens = async () =>
  (await answer(client.GET('/api/v1/tokens', { params: all }))).items;

export const makeToken = (body: NewToken) => answer(client.POST('/api/v1/tokens', { body }));

/** Ends a token, and what was made with it if that is wanted. */
export const endToken = (id: string, withMade = false) =>
  answer(
    client.DELETE('/api/v1/tokens/{id}', {
      params: { path: { id }, query: { with_made: withMade } },
    }),
  );

export const listQuotas = async () => (await answer(client.GET('/api/v1/quotas'))).items;

export const listUsers = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/users', { params: { query: page(longestPage, after) } })),
  );

export const inviteUser = (body: NewUser) => answer(client.POST('/api/v1/users', { body }));

export const inviteAgain = (id: string) =>
  answer(client.POST('/api/v1/users/{id}/invitation', { params: { path: { id } } }));

export const changeUser = (id: string, body: ChangedUser) =>
  answer(client.PATCH('/api/v1/users/{id}', { params: { path: { id } }, body }));

export const removeUser = (id: string) =>
  answer(client.DELETE('/api/v1/users/{id}', { params: { path: { id } } }));

export const resetSecondFactor = (id: string) =>
  answer(client.DELETE('/api/v1/users/{id}/second-factor', { params: { path: { id } } }));

export const findSignInRules = () => answer(client.GET('/api/v1/sign-in-rules'));

export const setSignInRules = (second_factor_required: boolean) =>
  answer(client.PUT('/api/v1/sign-in-rules', { body: { second_factor_required } }));

/** So many lines of the audit log are shown at once. */
const auditPage = 50;

export const listAudit = (query: AuditQuery, after?: string) =>
  answer(
    client.GET('/api/v1/audit', { params: { query: { ...query, ...page(auditPage, after) } } }),
  );
