/** The calls about the schedule: needs, port calls, the plan, what is pinned and offered. */

import { answer, client, everyPage, longestPage, page } from './client';
import type {
  NewPin,
  NewPortCall,
  NewScheduleOffer,
  PortCallAmendment,
  ScheduleSettings,
} from './types';

export const findSchedule = () => answer(client.GET('/api/v1/schedule'));

/** Makes the plan anew and waits for it. */
export const solveSchedule = () => answer(client.POST('/api/v1/schedule/solve'));

/** The last plans, the newest first. */
export const listPlans = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/schedule/plans', { params: { query: page(longestPage, after) } })),
  );

export const listNeeds = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/needs', { params: { query: page(longestPage, after) } })),
  );

/** The fleet's calls that touch the time from `from` to `to`. */
export const listCalls = (from: string, to: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/port-calls', {
        params: { query: { from, to, ...page(longestPage, after) } },
      }),
    ),
  );

export const enterCall = (vessel: string, body: NewPortCall, key: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/port-calls', {
      params: { path: { id: vessel }, header: { 'Idempotency-Key': key } },
      body,
    }),
  );

/** Amends a call: what is left out stays. */
export const amendCall = (vessel: string, call: string, body: PortCallAmendment) =>
  answer(
    client.PATCH('/api/v1/vessels/{id}/port-calls/{call}', {
      params: { path: { id: vessel, call } },
      body,
    }),
  );

export const withdrawCall = (vessel: string, call: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/port-calls/{call}/withdraw', {
      params: { path: { id: vessel, call } },
      body: {},
    }),
  );

/** A file of calls, as it is: a CSV of the whole fleet's. */
export const sendCallsCsv = (file: Blob, replace: boolean) =>
  answer(
    client.POST('/api/v1/port-calls.csv', {
      params: { query: { replace } },
      body: file as unknown as string,
      bodySerializer: () => file,
      headers: { 'Content-Type': 'text/csv' },
    }),
  );

/** A vessel's calendar. */
export const sendCallsCalendar = (vessel: string, file: Blob, replace: boolean) =>
  answer(
    client.POST('/api/v1/vessels/{id}/port-calls.ics', {
      params: { path: { id: vessel }, query: { replace } },
      body: file as unknown as string,
      bodySerializer: () => file,
      headers: { 'Content-Type': 'text/calendar' },
    }),
  );

export const searchPorts = async (q: string, limit = 12) =>
  (await answer(client.GET('/api/v1/ports', { params: { query: { q, limit } } }))).items;

export const listPins = async () => (await answer(client.GET('/api/v1/schedule/pins'))).items;

export const pinJob = (body: NewPin) => answer(client.POST('/api/v1/schedule/pins', { body }));

export const unpinJob = (compass: string) =>
  answer(client.DELETE('/api/v1/schedule/pins/{compass}', { params: { path: { compass } } }));

/** Writes the job's orders and offers them to its firm. */
export const offerJob = (body: NewScheduleOffer) =>
  answer(client.POST('/api/v1/schedule/offer', { body }));

export const listFirmTerms = async () => (await answer(client.GET('/api/v1/firm-terms'))).items;

export const findScheduleSettings = () => answer(client.GET('/api/v1/schedule/settings'));

export const setScheduleSettings = (body: ScheduleSettings) =>
  answer(client.PUT('/api/v1/schedule/settings', { body }));
