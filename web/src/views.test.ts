import { describe, expect, test } from 'vitest';
import type { FleetView } from './api/types';
import { broughtOver, withView } from './views';

const view = (name: string, search = '?filter=silent'): FleetView => ({ name, search });

function given({ server = [], browser }: { server?: FleetView[]; browser?: string }) {
  const kept = new Map(browser === undefined ? [] : [['binnacle.views.ada', browser]]);
  const store = {
    getItem: (key: string) => kept.get(key) ?? null,
    removeItem: (key: string) => void kept.delete(key),
  };
  const put: FleetView[][] = [];
  const list = () => Promise.resolve(server);
  const take = (views: FleetView[]) => {
    put.push(views);
    return Promise.resolve(views);
  };
  return { kept, store, put, list, take };
}

test('a view takes the place of one of its name', () => {
  const views = withView([view('Atlantic'), view('Silent', '?a')], view('Silent', '?b'));
  expect(views).toEqual([view('Atlantic'), view('Silent', '?b')]);
});

describe('views that a browser kept', () => {
  const browser = JSON.stringify([view('Silent'), { name: 'broken' }]);

  test('are brought over once to a server that has none', async () => {
    const { kept, store, put, list, take } = given({ browser });
    expect(await broughtOver(store, 'ada', { list, put: take })).toEqual([view('Silent')]);
    expect(kept.size).toBe(0);
    expect(await broughtOver(store, 'ada', { list, put: take })).toEqual([]);
    expect(put).toHaveLength(1);
  });

  test('never take the place of what the server has', async () => {
    const server = [view('Atlantic')];
    const { store, put, list, take } = given({ server, browser });
    expect(await broughtOver(store, 'ada', { list, put: take })).toEqual(server);
    expect(put).toEqual([]);
  });

  test('stay where they are while the server refuses them or does not answer', async () => {
    const { kept, store, list } = given({ browser });
    const refuse = () => Promise.reject(new Error('refused'));
    expect(await broughtOver(store, 'ada', { list, put: refuse })).toEqual([]);
    await expect(broughtOver(store, 'ada', { list: refuse, put: refuse })).rejects.toThrow();
    expect(kept.size).toBe(1);
  });
});
