/** The calls about a user's own views of the fleet, and the tags of its vessels. */

import { answer, client } from './client';
import type { FleetView } from './types';

export const listViews = async () => (await answer(client.GET('/api/v1/me/fleet-views'))).items;

export const putViews = async (items: FleetView[]) =>
  (await answer(client.PUT('/api/v1/me/fleet-views', { body: { items } }))).items;

export const putTags = (vessel: string, tags: string[]) =>
  answer(
    client.PUT('/api/v1/vessels/{id}/tags', { params: { path: { id: vessel } }, body: { tags } }),
  );
