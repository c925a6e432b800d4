import { describe, expect, test, vi } from 'vitest';
import { gathered, parseNews } from '../api/live.svelte';
import { Problem } from '../api/problem';
import type { Place } from '../api/client';
import type { DeviationTable } from '../api/types';
import { PlacedDeviation } from './placed.svelte';
import { kept, Resource } from './resource.svelte';
import { parseRoute, vesselPanelPath } from './route.svelte';

describe('addresses', () => {
  test('name pages, and what names none is not found', () => {
    expect(parseRoute('/')).toEqual({ page: 'vessels' });
    expect(parseRoute('/vessels/')).toEqual({ page: 'vessels' });
    expect(parseRoute('/vessels/abc')).toEqual({ page: 'vessel', id: 'abc', tab: 'overview' });
    expect(parseRoute('/vessels/abc/changes')).toEqual({
      page: 'vessel',
      id: 'abc',
      tab: 'changes',
    });
    expect(parseRoute('/vessels/abc/changes/1')).toEqual({ page: 'not-found' });
    expect(parseRoute('/alerts')).toEqual({ page: 'alerts' });
    expect(parseRoute('/webhooks/')).toEqual({ page: 'webhooks' });
    expect(parseRoute('/binnacles')).toEqual({ page: 'binnacles' });
    expect(parseRoute('/invitation')).toEqual({ page: 'invitation' });
    expect(parseRoute('/work-orders')).toEqual({ page: 'work-orders' });
    expect(parseRoute('/work-orders/new')).toEqual({ page: 'new-work-order' });
    expect(parseRoute('/work-orders/abc')).toEqual({ page: 'work-order', id: 'abc' });
    expect(parseRoute('/work-orders/abc/else')).toEqual({ page: 'not-found' });
    expect(parseRoute('/alerts/else')).toEqual({ page: 'not-found' });
    expect(parseRoute('/vessels/abc/else')).toEqual({ page: 'not-found' });
    expect(parseRoute('/elsewhere')).toEqual({ page: 'not-found' });
  });

  test('lead to the tab that has a panel', () => {
    expect(vesselPanelPath('abc', 'binnacle')).toBe('/vessels/abc/adjustment#binnacle');
  });
});

describe('what was fetched', () => {
  const refuse = (status: number) => () => Promise.reject(new Problem(status, 'x', 'no'));

  test('stays on the screen when a refresh fails, with the problem beside it', async () => {
    const resource = new Resource<number>();
    await resource.load(() => Promise.resolve(1));
    await resource.load(refuse(500));
    expect(resource.value).toBe(1);
    expect(resource.problem?.status).toBe(500);
    await resource.load(() => Promise.resolve(2));
    expect(resource.problem).toBeUndefined();
  });

  test('goes when it is no longer there', async () => {
    const resource = new Resource<number>();
    await resource.load(() => Promise.resolve(1));
    await resource.load(refuse(404));
    expect(resource.value).toBeUndefined();
  });

  test('is kept fresh while the page is looked at, until that is stopped', () => {
    vi.useFakeTimers();
    const page = { hidden: false };
    vi.stubGlobal('document', page);
    const load = vi.fn(() => Promise.resolve());
    const stop = kept(load, 1000);
    expect(load).toHaveBeenCalledTimes(1);
    vi.advanceTimersByTime(2500);
    expect(load).toHaveBeenCalledTimes(3);
    page.hidden = true;
    vi.advanceTimersByTime(5000);
    expect(load).toHaveBeenCalledTimes(3);
    page.hidden = false;
    stop();
    vi.advanceTimersByTime(5000);
    expect(load).toHaveBeenCalledTimes(3);
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  test('an answer that was overtaken is dropped', async () => {
    const resource = new Resource<string>();
    let answer: (value: string) => void = () => undefined;
    const slow = resource.load(() => new Promise((resolve) => (answer = resolve)));
    await resource.load(() => Promise.resolve('second'));
    answer('first');
    await slow;
    expect(resource.value).toBe('second');
    expect(resource.loading).toBe(false);
  });
});

describe('news', () => {
  test('of a vessel is read, and anything else is passed over', () => {
    for (const kind of ['batch', 'model', 'logbook']) {
      expect(parseNews(JSON.stringify({ vessel_id: 'v', kind }))).toEqual({ vesselId: 'v', kind });
    }
    for (const odd of [
      '',
      '[]',
      'null',
      '{"vessel_id":1,"kind":"batch"}',
      '{"vessel_id":"v","kind":"x"}',
    ]) {
      expect(parseNews(odd), odd).toBeNull();
    }
  });

  test('that comes in bursts is acted on once', () => {
    vi.useFakeTimers();
    const act = vi.fn();
    const refresh = gathered(act, 1000);
    for (let i = 0; i < 50; i++) refresh.call();
    vi.advanceTimersByTime(1000);
    expect(act).toHaveBeenCalledTimes(1);
    refresh.call();
    refresh.stop();
    vi.advanceTimersByTime(5000);
    expect(act).toHaveBeenCalledTimes(1);
    vi.useRealTimers();
  });
});

describe('a ship put elsewhere', () => {
  const at = (lon: number): Place => ({ lat: 50, lon, at: '2026-05-01T12:00:00Z' });
  const table = (lon: number) => ({ ...at(lon), rows: [] }) as unknown as DeviationTable;

  test('is asked about one place at a time, and about the last one always', async () => {
    const waiting: ((lon: number) => void)[] = [];
    const asked: number[] = [];
    const placed = new PlacedDeviation((place) => {
      asked.push(place?.lon ?? 0);
      return new Promise((done) =>
        waiting.push((lon) => {
          done(table(lon));
        }),
      );
    });
    placed.move(at(1));
    placed.move(at(2));
    placed.put(at(3));
    expect(asked).toEqual([1]);
    waiting[0]?.(1);
    await vi.waitFor(() => {
      expect(asked).toEqual([1, 3]);
    });
    waiting[1]?.(3);
    await vi.waitFor(() => {
      expect(placed.shown.value?.lon).toBe(3);
    });
    placed.reset();
    expect(placed.shown).toBe(placed.here);
  });

  test('has no curve where there is none, not that of another place', async () => {
    const placed = new PlacedDeviation((place) =>
      place ? Promise.reject(new Problem(422, 'x', 'no answer')) : Promise.resolve(table(0)),
    );
    await placed.load();
    placed.put(at(9));
    await vi.waitFor(() => {
      expect(placed.shown.problem?.message).toBe('no answer');
    });
    expect(placed.shown.value).toBeUndefined();
  });
});
