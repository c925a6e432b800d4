import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import type { AuditLine } from './api/types';
import { actor, actors, auditCsvPath, auditQuery, deed, everything, result, routes } from './audit';
import * as text from './text';

const line = (of: Partial<AuditLine>): AuditLine => ({
  id: 'l1',
  at: '2026-11-21T07:00:00Z',
  actor_kind: 'user',
  actor_id: 'u1',
  actor_name: 'Ada',
  token_id: null,
  operator_id: 'o1',
  firm_id: null,
  address: '198.51.100.7',
  method: 'POST',
  route: '/api/v1/vessels',
  path: '/api/v1/vessels',
  vessel_id: null,
  order_id: null,
  status: 201,
  account: null,
  refusal: null,
  ...of,
});

describe('what was done', () => {
  it('has words for every change that the API knows, and for what firms read', () => {
    const document = JSON.parse(readFileSync('../server/openapi.json', 'utf8')) as {
      paths: Record<string, Record<string, unknown>>;
    };
    const known = Object.entries(document.paths).flatMap(([path, methods]) =>
      Object.keys(methods).map((method) => ({ method: method.toUpperCase(), route: path })),
    );
    const noted = known.filter(
      ({ method, route }) =>
        (method !== 'GET' || route.startsWith('/api/v1/work-orders/{id}')) &&
        !route.includes('/batches/'),
    );
    expect(noted.length).toBeGreaterThan(80);
    expect(noted.filter((one) => deed(one).includes('/'))).toEqual([]);
    // And none that there is no more.
    const called = new Set(known.map(({ method, route }) => `${method} ${route.slice(7)}`));
    expect(Object.keys(text.audit.deeds).filter((words) => !called.has(words))).toEqual([]);
  });

  it('is called as the server calls it where there are no words', () => {
    expect(deed({ method: 'PUT', route: '/api/v1/anchors/{id}' })).toBe('PUT /anchors/{id}');
    expect(deed({ method: '', route: 'admin create operator' })).toBe('admin create operator');
    expect(deed({ method: '', route: 'constructor' })).toBe('constructor');
  });

  it('can be chosen by route, each once, with all that is done by it', () => {
    const all = routes();
    expect(new Set(all.map(({ route }) => route)).size).toBe(all.length);
    expect(all.find(({ route }) => route === '/session')?.words).toBe('Signed in · Signed out');
  });
});

describe('what is asked for', () => {
  it('is everything unless something is chosen', () => {
    expect(auditQuery(everything)).toEqual({});
    expect(auditCsvPath(everything)).toBe('/api/v1/audit.csv');
  });

  it('has the last day in it, over the end of a month and of a year', () => {
    const choice = { who: 'u1', what: '/users/{id}', from: '2026-12-01', to: '2026-12-31' };
    expect(auditQuery(choice)).toEqual({
      actor: 'u1',
      route: '/api/v1/users/{id}',
      from: '2026-12-01T00:00:00Z',
      to: '2027-01-01T00:00:00Z',
    });
    expect(auditCsvPath(choice)).toBe(
      '/api/v1/audit.csv?actor=u1&route=%2Fapi%2Fv1%2Fusers%2F%7Bid%7D' +
        '&from=2026-12-01T00%3A00%3A00Z&to=2027-01-01T00%3A00%3A00Z',
    );
  });
});

describe('who did it, and how it went', () => {
  it('names people, tokens, agents and the command line', () => {
    expect(actor(line({}))).toBe('Ada');
    expect(actor(line({ actor_kind: 'token' }))).toBe('Ada, by an API token');
    expect(actor(line({ actor_kind: 'agent', actor_name: 'Nao' }))).toBe('the agent aboard Nao');
    expect(actor(line({ actor_kind: 'command' }))).toBe('The server’s command line');
    expect(actor(line({ actor_name: '' }))).toBe('a person');
  });

  it('says as whom someone unknown tried to sign in, and why it was refused', () => {
    const unknown = line({ actor_kind: 'unidentified', actor_id: null, actor_name: '' });
    expect(actor(unknown)).toBe('Someone unknown');
    expect(actor({ ...unknown, account: 'ada@example.com' })).toBe(
      'Someone unknown, as ada@example.com',
    );
    expect(result({ status: 401, refusal: 'wrong_password' })).toBe('refused: wrong password');
  });

  it('is told from the answer', () => {
    const of = (status: number | null) => result({ status, refusal: null });
    expect([201, 303, 404, 500, null].map(of)).toEqual([
      'done',
      'done',
      'refused (404)',
      'failed (500)',
      'done; how it was answered was not noted',
    ]);
  });

  it('offers the people and whoever else did something, each once', () => {
    const lines = [
      line({ actor_kind: 'token' }),
      line({ actor_id: 'f1', actor_name: 'Needle', actor_kind: 'token' }),
      line({ actor_id: null, actor_kind: 'command' }),
    ];
    expect(actors([{ id: 'u1', name: 'Ada Lovelace' }], lines)).toEqual([
      { id: 'u1', name: 'Ada Lovelace' },
      { id: 'f1', name: 'Needle' },
    ]);
  });
});
