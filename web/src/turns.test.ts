import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { inTurn } from './turns';

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

test('each has a turn of its own, in the order of asking', () => {
  const done: string[] = [];
  for (const name of ['a', 'b', 'c']) inTurn(() => done.push(name));
  expect(done).toEqual([]);
  vi.advanceTimersToNextTimer();
  expect(done).toEqual(['a']);
  inTurn(() => done.push('d'));
  vi.runAllTimers();
  expect(done).toEqual(['a', 'b', 'c', 'd']);
});

test('who calls it off has no turn, and one that fails takes nobody else’s', () => {
  const done: string[] = [];
  const callOff = inTurn(() => done.push('off'));
  inTurn(() => {
    throw new Error('fails');
  });
  inTurn(() => done.push('last'));
  callOff();
  expect(() => vi.runAllTimers()).toThrow('fails');
  vi.runAllTimers();
  expect(done).toEqual(['last']);
});
