/**
 * The calls that the dashboard makes, typed by the server's own document. Every
 * failure is a `Problem`; an answer is only what was asked for.
 */

import createClient from 'openapi-fetch';
import * as text from '../text';
import { noteServerTime } from './clock';
import { Problem, readProblem } from './problem';
import type { paths } from './schema';
import type {
  Alert,
  Azimuth,
  LogbookEntry,
  MailRecipient,
  NewAzimuth,
  NewEntry,
  NewMailRecipient,
  NewVessel,
  NewWebhook,
  Severity,
  VesselSettings,
} from './types';

/** A place and a time at which to show the deviation. */
export interface Place {
  lat: number;
  lon: number;
  at: string;
}

/** The server's longest page. */
export const longestPage = 10_000;

export const client = createClient<paths>();
client.use({
  onRequest({ request }) {
    // The server takes changes only from pages that can set a header. A question has none of
    // its own, so that the browser's earlier answer to the same question will do for it.
    if (request.method !== 'GET') request.headers.set('X-Binnacle-Request', '1');
  },
});

let onSignedOut: () => void = () => undefined;

/** Says whom to tell when the server no longer knows the session. */
export function whenSignedOut(tell: () => void): void {
  onSignedOut = tell;
}

/** The data of an answer; a problem is thrown. */
export async function answer<T>(
  call: Promise<{ data?: T; error?: unknown; response: Response }>,
): Promise<T> {
  const { data, error, response } = await call.catch((reason: unknown) => {
    // `fetch` rejects with a TypeError when there was no answer at all.
    const none = reason instanceof TypeError;
    // A call that was given up for its length had none either.
    const late = reason instanceof DOMException && reason.name === 'TimeoutError';
    if (none || late) throw new Problem(0, 'offline', text.problem.offline);
    throw reason;
  });
  noteServerTime(response.headers.get('date'));
  if (response.ok) return data as T;
  const problem = readProblem(response.status, error);
  if (problem.status === 401 && problem.kind === 'unauthenticated') onSignedOut();
  throw problem;
}

/** Of who has a second factor a code is asked, as `second-factor-needed`. */
export const signIn = (email: string, password: string, code?: string) =>
  answer(client.POST('/api/v1/session', { body: { email, password, code: code ?? null } }));

/** By whose word one may sign in besides; none where the server was told of none. */
export const findProvider = async () => (await answer(client.GET('/api/v1/session/provider'))).name;

/** Goes there: not a call, but a page to be opened. */
export const providerPath = '/api/v1/session/provider/start';

/** The second factor's code, of whom the provider has vouched for. */
export const sendProviderCode = (code: string) =>
  answer(client.POST('/api/v1/session/provider/code', { body: { code } }));

/** Sets a password with a one-time code; says whose. */
export const acceptInvitation = (code: string, password: string) =>
  answer(client.POST('/api/v1/invitations/accept', { body: { code, password } }));

export const signOut = () => answer(client.DELETE('/api/v1/session'));

/** On a worse connection than this a page goes on with what the browser keeps. */
const meMs = 15_000;

export const findMe = () => answer(client.GET('/api/v1/me', { signal: AbortSignal.timeout(meMs) }));

/** Vessels of a page with tracks; a map of more of them would be unreadable. */
const withTracks = 200;

/** The whole fleet at a glance, with tracks where it is not too large for them. */
export const findFleet = async () => {
  const at = (limit: number, after?: string) =>
    answer(client.GET('/api/v1/fleet', { params: { query: page(limit, after) } }));
  let found = await at(withTracks);
  const vessels = [...found.vessels];
  while (found.next) {
    found = await at(longestPage, found.next);
    vessels.push(...found.vessels);
  }
  if (vessels.length <= withTracks) return vessels;
  return vessels.map((vessel) => ({ ...vessel, track: [] }));
};

/** One vessel of it; none when she is gone. */
export const findAtAGlance = async (vessel: string) => {
  const found = await answer(client.GET('/api/v1/fleet', { params: { query: { vessel } } }));
  return found.vessels[0];
};

/** Those in service, or those out of it. */
export const listVessels = (inService = true) =>
  everyPage((after) => {
    const query = { ...page(longestPage, after), ...(inService ? {} : { in_service: false }) };
    return answer(client.GET('/api/v1/vessels', { params: { query } }));
  });

export const createVessel = (body: NewVessel) => answer(client.POST('/api/v1/vessels', { body }));

export const findVessel = (id: string) =>
  answer(client.GET('/api/v1/vessels/{id}', { params: { path: { id } } }));

export const findModel = (id: string, compass?: string) =>
  answer(
    client.GET('/api/v1/vessels/{id}/model', {
      params: { path: { id }, query: which(compass) },
    }),
  );

export const findDeviation = (id: string, compass?: string, place?: Place) =>
  answer(
    client.GET('/api/v1/vessels/{id}/deviation', {
      params: { path: { id }, query: { ...which(compass), ...place, step_deg: 5 } },
    }),
  );

export const findCard = (id: string, compass?: string, place?: Place) =>
  answer(
    client.GET('/api/v1/vessels/{id}/card.json', {
      params: { path: { id }, query: { ...which(compass), ...place } },
    }),
  );

export const findCoverage = (id: string, compass?: string) =>
  answer(
    client.GET('/api/v1/vessels/{id}/coverage', {
      params: { path: { id }, query: which(compass) },
    }),
  );

/** What a compass's model started from. */
export const findPrior = (id: string, compass?: string) =>
  answer(
    client.GET('/api/v1/vessels/{id}/prior', {
      params: { path: { id }, query: which(compass) },
    }),
  );

/** A compass's epochs, and what changed between them. */
export const findTimeline = (id: string, compass?: string) =>
  answer(
    client.GET('/api/v1/vessels/{id}/changes', {
      params: { path: { id }, query: which(compass) },
    }),
  );

export const listAgents = (id: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/vessels/{id}/agents', {
        params: { path: { id }, query: page(longestPage, after) },
      }),
    ),
  );

/** What was reported, what happened last first; at most so many. */
export async function listLogbook(
  id: string,
  most: number,
): Promise<{ items: LogbookEntry[]; truncated: boolean }> {
  const found = await answer(
    client.GET('/api/v1/vessels/{id}/logbook', {
      params: { path: { id }, query: page(most) },
    }),
  );
  return { items: found.items, truncated: found.next !== null };
}

/** What stands in the logbook since an instant, withdrawn entries too. */
export const listLogbookSince = (id: string, from: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/vessels/{id}/logbook', {
        params: { path: { id }, query: { from, ...page(longestPage, after) } },
      }),
    ),
  );

/** A vessel's port calls that had not ended before an instant. */
export const listCallsSince = (id: string, from: string) =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/vessels/{id}/port-calls', {
        params: { path: { id }, query: { from, ...page(longestPage, after) } },
      }),
    ),
  );

/** What rules on adjusting ask about her. */
export const findParticulars = (id: string) =>
  answer(client.GET('/api/v1/vessels/{id}/particulars', { params: { path: { id } } }));

export const findSettings = (id: string) =>
  answer(client.GET('/api/v1/vessels/{id}/settings', { params: { path: { id } } }));

export const changeSettings = (id: string, body: VesselSettings) =>
  answer(client.PUT('/api/v1/vessels/{id}/settings', { params: { path: { id } }, body }));

/** A key that no other request has; `randomUUID` is for pages over TLS only. */
export function newKey(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** Writes an entry; under the same key the same entry is written once. */
export const reportEntry = (id: string, body: NewEntry, key: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/logbook', {
      params: { path: { id }, header: { 'Idempotency-Key': key } },
      body,
    }),
  );

export const amendEntry = (id: string, entry: string, body: NewEntry) =>
  answer(
    client.PATCH('/api/v1/vessels/{id}/logbook/{entry}', {
      params: { path: { id, entry } },
      body,
    }),
  );

export const withdrawEntry = (id: string, entry: string, reason: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/logbook/{entry}/withdraw', {
      params: { path: { id, entry } },
      body: { reason },
    }),
  );

/** A vessel's azimuths, the latest first; at most so many. */
export async function listAzimuths(
  id: string,
  most: number,
): Promise<{ items: Azimuth[]; truncated: boolean }> {
  const found = await answer(
    client.GET('/api/v1/vessels/{id}/azimuths', {
      params: { path: { id }, query: page(most) },
    }),
  );
  return { items: found.items, truncated: found.next !== null };
}

/** Enters an azimuth; under the same key the same azimuth is entered once. */
export const enterAzimuth = (id: string, body: NewAzimuth, key: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/azimuths', {
      params: { path: { id }, header: { 'Idempotency-Key': key } },
      body,
    }),
  );

export const withdrawAzimuth = (id: string, azimuth: string, reason: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/azimuths/{azimuth}/withdraw', {
      params: { path: { id, azimuth } },
      body: { reason },
    }),
  );

/** When each of her compasses is to be adjusted, and why. */
export const listVesselNeeds = async (id: string) =>
  (await answer(client.GET('/api/v1/vessels/{id}/needs', { params: { path: { id } } }))).items;

export const revokeAgent = (id: string, agent: string) =>
  answer(client.DELETE('/api/v1/vessels/{id}/agents/{agent}', { params: { path: { id, agent } } }));

export const createEnrolmentCode = (id: string, compass_id: string) =>
  answer(
    client.POST('/api/v1/vessels/{id}/agents', {
      params: { path: { id } },
      body: { compass_id, valid_for_s: null },
    }),
  );

/** Every alert that is not cleared. */
export const listOpenAlerts = () =>
  everyPage((after) =>
    answer(
      client.GET('/api/v1/alerts', {
        params: { query: { open: true, ...page(longestPage, after) } },
      }),
    ),
  );

/** The alerts that were cleared, the newest first; at most so many. */
export async function listClearedAlerts(most: number): Promise<Alert[]> {
  const query = { open: false, ...page(most) };
  const found = await answer(client.GET('/api/v1/alerts', { params: { query } }));
  return found.items;
}

export const acknowledgeAlert = (id: string, note: string) =>
  answer(
    client.POST('/api/v1/alerts/{id}/acknowledge', { params: { path: { id } }, body: { note } }),
  );

export const clearAlert = (id: string, reason: string) =>
  answer(client.POST('/api/v1/alerts/{id}/clear', { params: { path: { id } }, body: { reason } }));

export const listWebhooks = () =>
  everyPage((after) =>
    answer(client.GET('/api/v1/webhooks', { params: { query: page(longestPage, after) } })),
  );

export const createWebhook = (body: NewWebhook, key: string) =>
  answer(client.POST('/api/v1/webhooks', { params: { header: { 'Idempotency-Key': key } }, body }));

export const changeWebhook = (id: string, body: NewWebhook) =>
  answer(client.PUT('/api/v1/webhooks/{id}', { params: { path: { id } }, body }));

export const deleteWebhook = (id: string) =>
  answer(client.DELETE('/api/v1/webhooks/{id}', { params: { path: { id } } }));

export const testWebhook = (id: string) =>
  answer(client.POST('/api/v1/webhooks/{id}/test', { params: { path: { id } } }));

/** A webhook's latest deliveries; at most so many. */
export async function listDeliveries(id: string, most: number) {
  const params = { path: { id }, query: page(most) };
  const found = await answer(client.GET('/api/v1/webhooks/{id}/deliveries', { params }));
  return found.items;
}

export const sendDeliveryAgain = (id: string, delivery: string) =>
  answer(
    client.POST('/api/v1/webhooks/{id}/deliveries/{delivery}/resend', {
      params: { path: { id, delivery } },
    }),
  );

/** Who gets mail, and whether the server was told how to send it. */
export async function listRecipients(): Promise<{ items: MailRecipient[]; sending: boolean }> {
  let sending = false;
  const items = await everyPage(async (after) => {
    const query = page(longestPage, after);
    const found = await answer(client.GET('/api/v1/mail-recipients', { params: { query } }));
    sending = found.sending;
    return found;
  });
  return { items, sending };
}

export const addRecipient = (body: NewMailRecipient, key: string) =>
  answer(
    client.POST('/api/v1/mail-recipients', {
      params: { header: { 'Idempotency-Key': key } },
      body,
    }),
  );

export const changeRecipient = (id: string, severity: Severity) =>
  answer(
    client.PUT('/api/v1/mail-recipients/{id}', { params: { path: { id } }, body: { severity } }),
  );

export const removeRecipient = (id: string) =>
  answer(client.DELETE('/api/v1/mail-recipients/{id}', { params: { path: { id } } }));

export const testRecipient = (id: string) =>
  answer(client.POST('/api/v1/mail-recipients/{id}/test', { params: { path: { id } } }));

/** A recipient's latest letters; at most so many. */
export async function listLetters(id: string, most: number) {
  const params = { path: { id }, query: page(most) };
  const found = await answer(client.GET('/api/v1/mail-recipients/{id}/deliveries', { params }));
  return found.items;
}

export const sendLetterAgain = (id: string, delivery: string) =>
  answer(
    client.POST('/api/v1/mail-recipients/{id}/deliveries/{delivery}/resend', {
      params: { path: { id, delivery } },
    }),
  );

/** A compass's samples since an instant, as they are drawn. */
export const findPicture = (id: string, from: string, compass?: string) =>
  answer(
    client.GET('/api/v1/vessels/{id}/samples/picture', {
      params: { path: { id }, query: { ...which(compass), from } },
    }),
  );

/** All items of a list, page by page. */
export async function everyPage<T>(
  find: (after?: string) => Promise<{ items: T[]; next?: string | null }>,
): Promise<T[]> {
  let items: T[] = [];
  let after: string | undefined;
  do {
    const found = await find(after);
    items = items.concat(found.items);
    after = found.next ?? undefined;
  } while (after !== undefined);
  return items;
}

/** Which page of a list. */
export function page(limit: number, after?: string): { limit: number; after?: string } {
  return after === undefined ? { limit } : { limit, after };
}

function which(compass?: string): { compass?: string } {
  return compass === undefined ? {} : { compass };
}
