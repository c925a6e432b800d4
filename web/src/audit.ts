/** Lines of the audit log as people read them, and what to ask for. Pure functions. */

import type { AuditLine } from './api/types';
import * as text from './text';

/** Read when it is needed: the texts may be in a file that is evaluated after this one. */
const t = () => text.audit;
const beginning = '/api/v1';

/** What the form says; empty is any. */
export interface AuditChoice {
  who: string;
  /** A route, without its beginning. */
  what: string;
  /** Days in UTC, the last one included. */
  from: string;
  to: string;
}

export const everything: AuditChoice = { who: '', what: '', from: '', to: '' };

/** What is asked of the server. */
export interface AuditQuery {
  actor?: string;
  route?: string;
  from?: string;
  to?: string;
}

export function auditQuery({ who, what, from, to }: AuditChoice): AuditQuery {
  return {
    ...(who === '' ? {} : { actor: who }),
    ...(what === '' ? {} : { route: beginning + what }),
    ...(from === '' ? {} : { from: `${from}T00:00:00Z` }),
    ...(to === '' ? {} : { to: dayAfter(to) }),
  };
}

function dayAfter(day: string): string {
  const next = new Date(`${day}T00:00:00Z`);
  next.setUTCDate(next.getUTCDate() + 1);
  return `${next.toISOString().slice(0, 10)}T00:00:00Z`;
}

/** Where the same lines are had as a file. */
export function auditCsvPath(choice: AuditChoice): string {
  const query = new URLSearchParams({ ...auditQuery(choice) }).toString();
  return `${beginning}/audit.csv${query === '' ? '' : `?${query}`}`;
}

/** What was done: in words, or as the server calls it where there are none yet. */
export function deed(line: Pick<AuditLine, 'method' | 'route'>): string {
  const route = line.route.startsWith(beginning) ? line.route.slice(beginning.length) : line.route;
  const called = `${line.method} ${route}`.trim();
  return Object.hasOwn(t().deeds, called) ? (t().deeds[called] ?? called) : called;
}

/** Every route that may be asked for, with what is done by it, in the order of the words. */
export function routes(): { route: string; words: string }[] {
  const byRoute = new Map<string, string[]>();
  for (const [called, words] of Object.entries(t().deeds)) {
    const route = called.slice(called.indexOf(' ') + 1);
    byRoute.set(route, [...(byRoute.get(route) ?? []), words]);
  }
  const all = [...byRoute].map(([route, words]) => ({ route, words: words.join(' · ') }));
  return all.sort((a, b) => a.words.localeCompare(b.words));
}

export function actor(line: Pick<AuditLine, 'actor_kind' | 'actor_name' | 'account'>): string {
  const { actor_kind: kind, actor_name: name } = line;
  if (kind === 'unidentified') return t().by.unidentified(line.account);
  if (kind === 'command') return t().by.command;
  if (kind === 'agent') return t().by.agent(name);
  const person = name === '' ? t().unnamed : name;
  return kind === 'token' ? t().by.token(person) : person;
}

/** How it went; an answer that sends a browser elsewhere is one too. */
export function result({ status, refusal }: Pick<AuditLine, 'status' | 'refusal'>): string {
  if (refusal !== null) return t().refusals[refusal];
  if (status === null) return t().notNoted;
  if (status < 400) return t().done;
  return status < 500 ? t().refused(status) : t().failed(status);
}

/** Whom one may choose: the company's people, and whoever else is in the lines. */
export function actors(
  people: { id: string; name: string }[],
  lines: AuditLine[],
): { id: string; name: string }[] {
  const found = new Map(people.map(({ id, name }) => [id, name]));
  for (const line of lines) {
    if (line.actor_id === null || found.has(line.actor_id)) continue;
    // A token stands for a person.
    const kind = line.actor_kind === 'token' ? 'user' : line.actor_kind;
    found.set(line.actor_id, actor({ ...line, actor_kind: kind }));
  }
  const all = [...found].map(([id, name]) => ({ id, name }));
  return all.sort((a, b) => a.name.localeCompare(b.name));
}
