import { render } from 'svelte/server';
import { describe, expect, test } from 'vitest';
import type { Token } from '../../api/types';
import { words } from '../testing';
import QuotaTable from './QuotaTable.svelte';
import TokenPanel from './TokenPanel.svelte';

describe('settings', () => {
  const token: Token = {
    id: 't1',
    name: 'ERP',
    scope: 'write',
    expires_at: '2027-11-21T07:00:00Z',
    created_at: '2026-11-21T07:00:00Z',
    last_used_at: null,
    made: [],
  };
  const shown = (tokens: Token[]) =>
    words(
      render(TokenPanel, {
        props: { tokens, make: () => Promise.reject(new Error()), end: () => Promise.resolve() },
      }),
    );

  test('show what a token made, and offer to end it with that', () => {
    const hook = { kind: 'webhook', id: 'w1', name: 'https://example.com/hook' } as const;
    expect(shown([{ ...token, made: [hook] }])).toContain(
      'Created with this token: webhook https://example.com/hook',
    );
    expect(shown([{ ...token, made: [hook] }])).toContain('End with what it made');
    expect(shown([token])).not.toContain('made');
  });

  test('show how much there may be', () => {
    const quotas = [
      { name: 'webhooks', used: 3, most: 50 },
      { name: 'later', used: 0, most: 1 },
    ];
    const table = words(render(QuotaTable, { props: { quotas } }));
    expect(table).toBe('Webhooks 3 of 50 later 0 of 1');
  });
});
