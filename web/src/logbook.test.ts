import { render } from 'svelte/server';
import { describe, expect, test } from 'vitest';
import type { LogbookEntry } from './api/types';
import LogbookPanel from './components/LogbookPanel.svelte';
import {
  cargoes,
  details,
  draftOf,
  entryOf,
  fault,
  field,
  groups,
  instant,
  isOpen,
  newDraft,
  period,
} from './logbook';
import * as text from './text';

const scrap: LogbookEntry = {
  id: 'e1',
  kind: 'magnetic_cargo',
  from: '2026-11-14T08:30:15Z',
  to: null,
  cargo: 'scrap',
  hatch: '2',
  port: 'Bilbao',
  note: 'Shredded',
  compass_id: null,
  author: 'agent',
  created_at: '2026-11-14T09:00:00Z',
  created_by: 'Li',
  revision: 1,
  revised_at: null,
  revised_by: null,
  withdrawn_at: null,
  withdrawn_by: null,
  withdrawal_reason: null,
};
const withdrawn: LogbookEntry = {
  ...scrap,
  id: 'e2',
  withdrawn_at: '2026-11-15T00:00:00Z',
  withdrawn_by: 'Ada',
  withdrawal_reason: 'Another ship',
};

describe('the times of a form', () => {
  test('are UTC, whatever the browser’s zone', () => {
    expect(field('2026-11-21T07:30:59Z')).toBe('2026-11-21T07:30');
    expect(field('2026-11-21T00:30:00+02:00')).toBe('2026-11-20T22:30');
    expect(instant('2026-11-21T07:30')).toBe('2026-11-21T07:30:00.000Z');
    expect([field(null), field('noon'), instant(''), instant('noon')]).toEqual([
      '',
      '',
      null,
      null,
    ]);
  });

  test('keep their seconds when nobody touched them', () => {
    const amended = entryOf({ ...draftOf(scrap), to: '2026-11-16T10:00' }, scrap);
    expect(amended.from).toBe(scrap.from);
    expect(amended.to).toBe('2026-11-16T10:00:00.000Z');
    const moved = entryOf({ ...draftOf(scrap), from: '2026-11-14T08:31' }, scrap);
    expect(moved.from).toBe('2026-11-14T08:31:00.000Z');
  });

  test('are refused where they cannot be', () => {
    const draft = newDraft(new Date('2026-11-21T07:00:00Z'));
    expect(fault(draft)).toBeNull();
    expect(fault({ ...draft, from: '' })?.field).toBe('from');
    expect(fault({ ...draft, to: '2026-11-21T06:59' })?.message).toBe(text.logbook.toBeforeFrom);
  });
});

describe('an entry', () => {
  test('comes out of the form as it went in', () => {
    const entry = entryOf(draftOf(scrap), scrap);
    const { kind, from, to, cargo, hatch, port, note, compass_id } = scrap;
    expect(entry).toEqual({ kind, from, to, cargo, hatch, port, note, compass_id });
  });

  test('says nothing of a cargo or a compass where its kind has none', () => {
    const draft = { ...draftOf(scrap), kind: 'lightning' as const, compass: 'c1', port: '  ' };
    const entry = entryOf(draft);
    expect([entry.cargo, entry.hatch, entry.port, entry.compass_id]).toEqual(Array(4).fill(null));
    expect(entryOf({ ...draft, kind: 'adjustment' }).compass_id).toBe('c1');
  });

  test('is written in a few words', () => {
    expect(details(scrap, String)).toBe('Scrap, hatch 2, Bilbao');
    expect(period(scrap)).toBe('since 14 Nov 2026, 08:30 UTC');
    expect(period({ ...scrap, to: '2026-11-14T16:00:00Z' })).toBe('14 Nov 2026, 08:30 – 16:00 UTC');
    expect(period({ ...scrap, to: '2026-11-15T16:00:00Z' })).toBe(
      '14 Nov 2026, 08:30 – 15 Nov 2026, 16:00 UTC',
    );
    expect(period({ ...scrap, kind: 'lightning' })).toBe('14 Nov 2026, 08:30 UTC');
    expect([isOpen(scrap), isOpen(withdrawn)]).toEqual([true, false]);
  });

  test('has a name for every kind in the form', () => {
    const listed = groups.flatMap((group) => group.kinds).sort();
    expect(listed).toEqual(Object.keys(text.logbook.kinds).sort());
    expect([...cargoes].sort()).toEqual(Object.keys(text.logbook.cargoes).sort());
  });
});

describe('the panel', () => {
  const nothing = () => Promise.resolve();
  const panel = (entries: LogbookEntry[], writes: boolean) =>
    render(LogbookPanel, {
      props: {
        entries,
        compasses: [],
        writes,
        report: nothing,
        amend: nothing,
        withdraw: nothing,
      },
    }).body;

  test('strikes through what is withdrawn, and says by whom', () => {
    const body = panel([withdrawn], true);
    expect(body).toMatch(/<s[ >]/);
    expect(body).toContain('Withdrawn by Ada, 15 Nov 2026, 00:00 UTC.');
    expect(body).toContain('Another ship');
    expect(body).not.toContain(text.logbook.amend);
    expect(panel([scrap], true)).not.toMatch(/<s[ >]/);
  });

  test('lets a viewer read and nothing else', () => {
    const body = panel([scrap], false);
    expect(body).toContain('Reported on board by Li');
    expect(body).not.toContain('<button');
    expect(panel([], false)).toContain(text.logbook.noneViewer);
    expect(panel([], true)).toContain(text.logbook.none);
  });
});
