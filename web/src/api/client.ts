/**
 * The calls that the dashboard makes. Every failure is a `Problem`; an answer is
 * only what was asked for.
 */

import { text } from '../text';
import type * as api from './types';

/** What the server refused, or `offline` when it could not be reached. */
export class Problem extends Error {
  constructor(
    readonly status: number,
    readonly kind: string,
    detail: string,
  ) {
    super(detail);
  }

  get offline(): boolean {
    return this.status === 0;
  }
}

let onSignedOut: () => void = () => undefined;

/** Says whom to tell when the server no longer knows the session. */
export function whenSignedOut(tell: () => void): void {
  onSignedOut = tell;
}

export interface Place {
  lat: number;
  lon: number;
  at: string;
}

export const signIn = (email: string, password: string) =>
  post<api.Me>('/session', { email, password });
export const signOut = () => call<undefined>('DELETE', '/session');
export const findMe = () => get<api.Me>('/me');
export const listVessels = (after?: string) =>
  get<api.Page<api.Vessel>>('/vessels', { after, limit: 100 });
export const findVessel = (id: string) => get<api.Vessel>(`/vessels/${id}`);
export const createVessel = (vessel: api.NewVessel) => post<api.Vessel>('/vessels', vessel);
export const findModel = (id: string, compass?: string) =>
  get<api.ModelVersion>(`/vessels/${id}/model`, { compass });
export const findDeviation = (id: string, compass?: string, place?: Place) =>
  get<api.DeviationTable>(`/vessels/${id}/deviation`, { compass, step_deg: 5, ...place });
export const findCoverage = (id: string, compass?: string) =>
  get<api.Coverage>(`/vessels/${id}/coverage`, { compass });
export const listAgents = (id: string) =>
  get<api.Page<api.AgentStream>>(`/vessels/${id}/agents`, { limit: 100 });
export const createEnrolmentCode = (id: string, compass?: string) =>
  post<api.EnrolmentCode>(`/vessels/${id}/agents`, compass ? { compass_id: compass } : {});

type Query = Record<string, string | number | undefined>;

function get<T>(path: string, query: Query = {}): Promise<T> {
  const words = new URLSearchParams();
  for (const [name, value] of Object.entries(query)) {
    if (value !== undefined) words.set(name, String(value));
  }
  return call<T>('GET', words.size > 0 ? `${path}?${words}` : path);
}

function post<T>(path: string, body: unknown): Promise<T> {
  return call<T>('POST', path, body);
}

async function call<T>(method: string, path: string, body?: unknown): Promise<T> {
  const headers: Record<string, string> = { 'X-Binnacle-Request': '1' };
  const init: RequestInit = { method, headers };
  if (body !== undefined) {
    headers['Content-Type'] = 'application/json';
    init.body = JSON.stringify(body);
  }
  const response = await fetch(`/api/v1${path}`, init).catch(() => {
    throw new Problem(0, 'offline', text.problem.offline);
  });
  if (!response.ok) throw await readProblem(response);
  if (response.status === 204) return undefined as T;
  return (await response.json()) as T;
}

async function readProblem(response: Response): Promise<Problem> {
  const body: unknown = await response.json().catch(() => null);
  const about = typeof body === 'object' && body !== null ? body : {};
  const kind = 'type' in about && typeof about.type === 'string' ? about.type : '';
  const detail =
    'detail' in about && typeof about.detail === 'string'
      ? about.detail
      : text.problem.unexpected(response.status);
  const problem = new Problem(response.status, kind.split('/').at(-1) ?? '', detail);
  if (problem.status === 401 && problem.kind !== 'wrong-password') onSignedOut();
  return problem;
}

/** Samples of a period in order of time, at most `most` of them: the latest ones. */
export async function listSamples(id: string, from: string, most: number, compass?: string) {
  let items: api.Sample[] = [];
  let after: string | undefined;
  let truncated = false;
  do {
    const page = await get<api.Page<api.Sample>>(`/vessels/${id}/samples`, {
      from,
      compass,
      after,
      limit: 10_000,
    });
    items = items.concat(page.items);
    if (items.length > most) {
      items = items.slice(-most);
      truncated = true;
    }
    after = page.next ?? undefined;
  } while (after !== undefined);
  return { items, truncated };
}
