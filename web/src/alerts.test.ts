import { render } from 'svelte/server';
import { describe, expect, test } from 'vitest';
import { againstCard, inOrder, ofVessel, raisedOf } from './alerts';
import type { Alert } from './api/types';
import AlertCard from './components/AlertCard.svelte';

const alert = (id: string, more: Partial<Alert> = {}): Alert => ({
  id,
  vessel_id: 'v',
  vessel_name: 'Nao Victoria',
  compass_id: 'c',
  compass_name: 'Standard compass',
  cause: 'deviation_over_limit',
  severity: 'warning',
  state: 'raised',
  since: '2026-11-20T00:00:00Z',
  summary: 'Deviation is 7.4° E on compass heading 095°, over the limit of 5°.',
  advice: 'Steer by the corrected heading.',
  evidence: ['Its 95 % band there is ±0.8°.'],
  raised_at: '2026-11-20T00:00:00Z',
  updated_at: '2026-11-20T00:00:00Z',
  acknowledged_at: null,
  acknowledged_by: null,
  acknowledgement_note: null,
  assigned_to: null,
  assigned_name: null,
  snoozed_until: null,
  cleared_at: null,
  cleared_by: null,
  clearing_reason: null,
  ...more,
});

test('a vessel has her own alerts, the worst first also when somebody knows of it', () => {
  const list = [
    alert('notice', { severity: 'notice' }),
    alert('another', { vessel_id: 'w', severity: 'critical' }),
    alert('known', { severity: 'critical', state: 'acknowledged' }),
  ];
  expect(ofVessel(list, 'v').map(({ id }) => id)).toEqual(['known', 'notice']);
});

test('only what says that the compass itself is wrong keeps a card from being made', () => {
  const of = (more: Partial<Alert>) => againstCard([alert('a', more)], 'c')?.id;
  expect(of({ cause: 'reported_aboard' })).toBe('a');
  expect(of({ cause: 'compass_fault' })).toBe('a');
  expect(of({ cause: 'lightning_or_shock' })).toBeUndefined();
  expect(of({ cause: 'compass_fault', compass_id: 'd' })).toBeUndefined();
});

describe('the order of alerts', () => {
  const list = [
    alert('known', { severity: 'critical', state: 'acknowledged' }),
    alert('notice', { severity: 'notice' }),
    alert('older'),
    alert('newer', { raised_at: '2026-11-21T00:00:00Z' }),
    alert('critical', { severity: 'critical' }),
  ];

  test('is by who knows, how bad, and how new', () => {
    const ids = inOrder(list).map((each) => each.id);
    expect(ids).toEqual(['critical', 'newer', 'older', 'notice', 'known']);
  });

  test('the badge counts those that nobody knows of, the worst first, none that is snoozed', () => {
    const now = new Date('2026-11-22T00:00:00Z');
    const ids = (of: readonly Alert[]) => raisedOf(of, now).map(({ id }) => id);
    expect(ids(list)).toEqual(['critical', 'newer', 'older', 'notice']);
    expect(ids(list.slice(0, 1))).toEqual([]);
    const until = (snoozed_until: string) => [alert('snoozed', { snoozed_until })];
    expect(ids(until('2026-11-22T00:00:01Z'))).toEqual([]);
    expect(ids(until('2026-11-21T23:59:59Z'))).toEqual(['snoozed']);
  });
});

describe('an alert', () => {
  const shown = (of: Alert, writes: boolean) => {
    const nothing = () => Promise.resolve();
    const props = { alert: of, writes, acknowledge: nothing, clear: nothing };
    const plain = render(AlertCard, { props }).body.replace(/<!--.*?-->/gs, '');
    return plain.replace(/<[^>]*>/g, ' ').replace(/\s+/g, ' ');
  };

  test('says what is so, what to do and what shows it', () => {
    const words = shown(alert('a'), true);
    expect(words).toContain('Nao Victoria : Deviation over the limit Warning');
    expect(words).toContain('over the limit of 5°. What to do: Steer by the corrected heading.');
    expect(words).toContain('What shows it Its 95 % band there is ±0.8°.');
    expect(words).toContain('Acknowledge Clear');
  });

  test('has no buttons for those who only look; once it is cleared there is nothing to do', () => {
    expect(shown(alert('a'), false)).not.toContain('Acknowledge');
    const cleared = alert('a', { state: 'cleared', cleared_at: '2026-11-21T07:00:00Z' });
    const words = shown(cleared, true);
    expect(words).toContain('Over since 21 Nov 2026, 07:00 UTC');
    expect(words).not.toContain('Acknowledge');
    expect(words).not.toContain('What to do');
  });

  test('tells who acknowledged it, with the note', () => {
    const known = alert('a', {
      state: 'acknowledged',
      acknowledged_at: '2026-11-21T07:00:00Z',
      acknowledged_by: 'Ada',
      acknowledgement_note: 'Azimuth taken',
    });
    const words = shown(known, true);
    expect(words).toContain('Acknowledged by Ada, 21 Nov 2026, 07:00 UTC: Azimuth taken');
    expect(words).not.toContain('Acknowledge Clear');
  });
});
