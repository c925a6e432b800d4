import { beforeEach, expect, test, vi } from 'vitest';
import { findVessel } from '../api/client';
import type { Me } from '../api/types';
import { askAhead, vesselAsked } from './ahead';
import { keptMe } from './me';

vi.mock('../api/client', () => ({ findVessel: vi.fn((id: string) => Promise.resolve({ id })) }));
vi.mock('./me', () => ({ keptMe: vi.fn() }));

const hereLast = (role: Me['role']) => {
  vi.mocked(keptMe).mockReturnValue({ role } as Me);
};

beforeEach(() => {
  vi.mocked(findVessel).mockClear();
});

test('a vessel asked for ahead is asked for once, and anew the next time', async () => {
  hereLast('viewer');
  askAhead('nao');
  expect(await vesselAsked('nao')).toEqual({ id: 'nao' });
  expect(findVessel).toHaveBeenCalledTimes(1);
  await vesselAsked('nao');
  expect(findVessel).toHaveBeenCalledTimes(2);
});

test('another vessel is never taken for the one asked for ahead', async () => {
  hereLast('admin');
  askAhead('nao');
  expect(await vesselAsked('ada')).toEqual({ id: 'ada' });
});

test('for those who have no vessels nothing is asked ahead', () => {
  hereLast('adjuster');
  askAhead('nao');
  expect(findVessel).not.toHaveBeenCalled();
});
