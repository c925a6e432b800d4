import { expect, test } from 'vitest';
import { compassInSearch, placeInSearch, withCompass, withPlace } from './place';

const place = { lat: -31.45, lon: 15.207, at: '2026-11-23T12:00:00.000Z' };

test('a place in an address is read again as it was', () => {
  const search = withPlace('', place);
  expect(placeInSearch(search)).toEqual(place);
  expect(withPlace(search, place)).toBe(search);
});

test('an address without a place has what else stood there', () => {
  expect(withPlace(withPlace('?compass=c', place), undefined)).toBe('?compass=c');
  expect(withPlace(withPlace('', place), undefined)).toBe('');
});

test('a compass in an address is read again, and leaves the place as it was', () => {
  const search = withCompass(withPlace('', place), 'steering');
  expect(compassInSearch(search)).toBe('steering');
  expect(placeInSearch(search)).toEqual(place);
  expect(compassInSearch(withCompass(search, 'standard'))).toBe('standard');
  expect(compassInSearch('')).toBeUndefined();
});

test.each([
  '',
  '?lat=&lon=5&at=2026-11-23',
  '?lat=91&lon=5&at=2026-11-23',
  '?lat=1&lon=181&at=2026-11-23',
  '?lat=north&lon=5&at=2026-11-23',
  '?lat=1&lon=5',
  '?lat=1&lon=5&at=soon',
])('%s is no place', (search) => {
  expect(placeInSearch(search)).toBeUndefined();
});
