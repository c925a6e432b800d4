import { describe, expect, it } from 'vitest';
import type { Alert } from './api/types';
import {
  asTheyStood,
  causesOf,
  everyAlert,
  fromInboxSearch,
  matching,
  toInboxSearch,
  type InboxQuery,
} from './inbox';

const alert = (over: Partial<Alert>): Alert =>
  ({
    id: 'a',
    vessel_name: 'Costa Caribe',
    compass_name: 'Standard compass',
    cause: 'drift',
    severity: 'warning',
    state: 'raised',
    assigned_to: null,
    snoozed_until: null,
    ...over,
  }) as Alert;

const inbox = [
  alert({ id: 'drift' }),
  alert({ id: 'struck', cause: 'lightning_or_shock', severity: 'critical', state: 'acknowledged' }),
  alert({ id: 'quiet', cause: 'silent_agent', severity: 'notice', vessel_name: 'Almirante Señal' }),
];
const reader = { me: 'officer', now: new Date('2026-11-22T00:00:00Z') };
const found = (query: Partial<typeof everyAlert>) =>
  matching(inbox, { ...everyAlert, ...query }, reader).map(({ id }) => id);

describe('the inbox', () => {
  it('is whole unless something is asked for, and keeps its order', () => {
    expect(found({})).toEqual(['drift', 'struck', 'quiet']);
  });

  it('is filtered by state, severity, cause and the words of a vessel', () => {
    expect(found({ state: 'raised' })).toEqual(['drift', 'quiet']);
    expect(found({ state: 'acknowledged' })).toEqual(['struck']);
    expect(found({ severity: 'critical' })).toEqual(['struck']);
    expect(found({ cause: 'silent_agent' })).toEqual(['quiet']);
    expect(found({ search: 'senal almir' })).toEqual(['quiet']);
    expect(found({ search: 'caribe steering' })).toEqual([]);
    expect(found({ search: 'caribe', severity: 'critical', state: 'raised' })).toEqual([]);
  });

  it('asks what is over for no state', () => {
    const over = [alert({ state: 'cleared' })];
    expect(matching(over, { ...everyAlert, state: 'raised' }, reader)).toEqual(over);
  });

  it('asks for those of the reader, and for snoozed ones only by that name', () => {
    const some = [
      alert({ id: 'mine', assigned_to: 'officer' }),
      alert({ id: 'theirs', assigned_to: 'master' }),
      alert({ id: 'later', assigned_to: 'officer', snoozed_until: '2026-11-22T00:00:01Z' }),
      alert({ id: 'awake', snoozed_until: '2026-11-21T23:59:59Z' }),
    ];
    const ids = (state: InboxQuery['state']) =>
      matching(some, { ...everyAlert, state }, reader).map(({ id }) => id);
    expect(ids('mine')).toEqual(['mine']);
    expect(ids('snoozed')).toEqual(['later']);
    expect(ids('')).toEqual(['mine', 'theirs', 'awake']);
  });

  it('stays in the order in which it stood, what is new after what it follows', () => {
    const order = (stood: string[]) => asTheyStood(inbox, stood).map(({ id }) => id);
    expect(order(['quiet', 'drift', 'struck'])).toEqual(['quiet', 'drift', 'struck']);
    expect(order(['struck', 'gone', 'drift'])).toEqual(['struck', 'quiet', 'drift']);
    expect(order(['quiet', 'struck'])).toEqual(['drift', 'quiet', 'struck']);
    expect(order([])).toEqual(['drift', 'struck', 'quiet']);
  });

  it('offers the causes that there are, and the one that is asked for', () => {
    expect(causesOf(inbox, '')).toEqual(['lightning_or_shock', 'drift', 'silent_agent']);
    expect(causesOf([], 'wide_band')).toEqual(['wide_band']);
  });
});

describe('the address', () => {
  it('says what is asked for, and gives it back', () => {
    const query = {
      search: 'costa',
      state: 'raised',
      severity: 'critical',
      cause: 'drift',
    } as const;
    const written = '?q=costa&state=raised&severity=critical&cause=drift';
    expect(toInboxSearch(query)).toBe(written);
    expect(fromInboxSearch(written)).toEqual(query);
  });

  it('is bare for the whole inbox, and what it does not know is nothing', () => {
    expect(toInboxSearch({ ...everyAlert, search: ' ' })).toBe('');
    expect(fromInboxSearch('?state=cleared&severity=awful&cause=toString')).toEqual(everyAlert);
  });
});
