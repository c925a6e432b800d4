import { beforeEach, expect, test, vi } from 'vitest';
import { findVessel, listVesselNeeds } from '../api/client';
import type { Me } from '../api/types';
import { askAhead, needsAsked, vesselAsked } from './ahead';
import { keptMe } from './me';

vi.mock('../api/client', () => ({
  findVessel: vi.fn((id: string) => Promise.resolve({ id })),
  listVesselNeeds: vi.fn((id: string) => Promise.resolve([{ vessel_id: id }])),
}));
vi.mock('./me', () => ({ keptMe: vi.fn() }));

const hereLast = (role: Me['role']) => {
  vi.mocked(keptMe).mockReturnValue({ role } as Me);
};

beforeEach(() => {
  vi.mocked(findVessel).mockClear();
  vi.mocked(listVesselNeeds).mockClear();
});

test('a vessel asked for ahead is asked for once, and anew the next time', async () => {
  hereLast('viewer');
  askAhead('nao');
  expect(await vesselAsked('nao')).toEqual({ id: 'nao' });
  expect(findVessel).toHaveBeenCalledTimes(1);
  await vesselAsked('nao');
  expect(findVessel).toHaveBeenCalledTimes(2);
});

test('what is due is asked for ahead beside the vessel, once, and of her alone', async () => {
  hereLast('viewer');
  askAhead('nao');
  await vesselAsked('nao');
  expect(await needsAsked('nao')).toEqual([{ vessel_id: 'nao' }]);
  expect(listVesselNeeds).toHaveBeenCalledTimes(1);
  await needsAsked('nao');
  expect(listVesselNeeds).toHaveBeenCalledTimes(2);
  askAhead('nao');
  expect(await needsAsked('ada')).toEqual([{ vessel_id: 'ada' }]);
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
  expect(listVesselNeeds).not.toHaveBeenCalled();
});
