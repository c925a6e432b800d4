/** The calls about what a person is told, and how. */

import { answer, client, page } from './client';
import type { NotificationSettings } from './types';

/** The newest, and how many are unread. */
export const listNotifications = (most: number) =>
  answer(client.GET('/api/v1/notifications', { params: { query: page(most) } }));

export const markNotification = (id: string, read: boolean) =>
  answer(client.PATCH('/api/v1/notifications/{id}', { params: { path: { id } }, body: { read } }));

/** Marks all as read, up to one that was seen. */
export const markAllRead = (until: string) =>
  answer(client.POST('/api/v1/notifications/read', { body: { until } }));

export const findNotificationSettings = () => answer(client.GET('/api/v1/me/notifications'));

export const setNotificationSettings = (body: NotificationSettings) =>
  answer(client.PUT('/api/v1/me/notifications', { body }));
