/** The calls about handling alerts: several at once, who sees to one, and what is said of it. */

import { answer, client } from './client';

/** Acknowledges all of them or none; those that are known already stay as they are. */
export const acknowledgeAlerts = (alerts: string[], note: string) =>
  answer(
    client.POST('/api/v1/alerts/acknowledge', {
      body: note === '' ? { alerts } : { alerts, note },
    }),
  );

export const assignAlert = (id: string, user_id: string | null) =>
  answer(
    client.PUT('/api/v1/alerts/{id}/assignee', { params: { path: { id } }, body: { user_id } }),
  );

export const snoozeAlert = (id: string, until: string | null) =>
  answer(client.PUT('/api/v1/alerts/{id}/snooze', { params: { path: { id } }, body: { until } }));

export const listAlertComments = (id: string) =>
  answer(client.GET('/api/v1/alerts/{id}/comments', { params: { path: { id } } }));

export const commentAlert = (id: string, text: string, key: string) =>
  answer(
    client.POST('/api/v1/alerts/{id}/comments', {
      params: { path: { id }, header: { 'Idempotency-Key': key } },
      body: { text },
    }),
  );
