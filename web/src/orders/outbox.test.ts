import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Problem } from '../api/problem';
import type { WorkOrder } from '../api/types';
import { Outbox } from './outbox.svelte';
import { inMemory, type Shelf } from './shelf';
import type { Content, Write } from './writes';

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

const offline = new Problem(0, 'offline', 'no answer');
const step = (number: number): Content => ({ kind: 'step', number, body: { after_deg: 10 } });
const confirmed = { id: 'o', last_step: { verdict: 'confirmed' } } as WorkOrder;
const settled = () => vi.advanceTimersByTimeAsync(0);

/** An outbox whose server answers as `answers` says, call by call; then it confirms. */
function withServer(answers: (WorkOrder | Problem)[], shelf: Shelf = inMemory()) {
  const sent: Write[] = [];
  const outbox = new Outbox(
    (write) => {
      sent.push(write);
      const answer = answers.shift() ?? confirmed;
      return answer instanceof Problem ? Promise.reject(answer) : Promise.resolve(answer);
    },
    () => Promise.resolve(shelf),
  );
  return { outbox, sent, shelf };
}

test('what got no answer is sent again under the same key, and nothing overtakes it', async () => {
  const { outbox, sent } = withServer([offline, offline]);
  await outbox.start('u');
  await outbox.add('o', step(1));
  await settled();
  await outbox.add('o', step(2));
  await settled();
  expect(outbox.writes).toHaveLength(2);
  expect(outbox.trouble?.offline).toBe(true);
  await vi.advanceTimersByTimeAsync(60_000);
  expect(outbox.writes).toHaveLength(0);
  expect(outbox.trouble).toBeUndefined();
  expect(sent.map((write) => (write.content as { number: number }).number)).toEqual([1, 1, 1, 2]);
  expect(new Set(sent.map((write) => write.key)).size).toBe(2);
  outbox.stop();
});

test('a closed page loses nothing: the next one sends it under the same key', async () => {
  const first = withServer([offline]);
  await first.outbox.start('u');
  await first.outbox.add('o', step(1));
  await settled();
  first.outbox.stop();
  const next = withServer([], first.shelf);
  await next.outbox.start('u');
  expect(next.sent).toHaveLength(1);
  expect(next.sent[0]?.key).toBe(first.sent[0]?.key);
  expect(await first.shelf.writes()).toEqual([]);
  next.outbox.stop();
});

test('what another user wrote is kept, and neither shown nor sent', async () => {
  const first = withServer([offline]);
  await first.outbox.start('u');
  await first.outbox.add('o', step(1));
  await settled();
  first.outbox.stop();
  const other = withServer([], first.shelf);
  await other.outbox.start('somebody else');
  expect(other.outbox.writes).toEqual([]);
  expect(other.sent).toEqual([]);
  expect(await first.shelf.writes()).toHaveLength(1);
  other.outbox.stop();
});

test('a refusal is kept with its reason, never sent again by itself, and holds what follows', async () => {
  const refusal = new Problem(409, 'wrong-state', 'the step to do now is 2');
  const { outbox, sent } = withServer([offline, refusal]);
  await outbox.start('u');
  await outbox.add('o', step(1));
  await settled();
  await outbox.add('o', step(2));
  await outbox.add('o', { kind: 'remark', text: 'crane alongside' });
  await vi.advanceTimersByTimeAsync(600_000);
  expect(sent.map((write) => write.content.kind)).toEqual(['step', 'step', 'remark']);
  expect(outbox.writes.map((write) => write.refused?.kind)).toEqual(['wrong-state', 'superseded']);
  expect(outbox.writes[0]?.refused?.detail).toBe('the step to do now is 2');

  const [first] = outbox.writes;
  if (first) await outbox.again(first);
  await settled();
  expect(sent).toHaveLength(4);
  const [held] = outbox.writes;
  if (held) await outbox.drop(held);
  expect(outbox.writes).toEqual([]);
  outbox.stop();
});

test('a step that the server judges otherwise holds the steps after it', async () => {
  const wrongEnd = { id: 'o', last_step: { verdict: 'wrong_end' } } as WorkOrder;
  const { outbox, sent } = withServer([offline, wrongEnd]);
  const told: WorkOrder[] = [];
  outbox.listen((order) => told.push(order));
  await outbox.start('u');
  await outbox.add('o', step(1));
  await settled();
  await outbox.add('o', step(2));
  await vi.advanceTimersByTimeAsync(60_000);
  expect(sent).toHaveLength(2);
  expect(told).toEqual([wrongEnd]);
  expect(outbox.writes.map((write) => write.refused?.kind)).toEqual(['superseded']);
  outbox.stop();
});

test('a write goes and its answer comes in one go: the order never stands as before it', async () => {
  const { outbox } = withServer([]);
  let told = 0;
  outbox.listen(() => (told += 1));
  await outbox.start('u');
  void outbox.add('o', step(1));
  const seen: string[] = [];
  for (let turn = 0; turn < 200; turn += 1) {
    await Promise.resolve();
    const stands = `${outbox.writes.length} waiting, ${told} answered`;
    if (stands !== seen.at(-1)) seen.push(stands);
  }
  expect(seen).toEqual(['0 waiting, 0 answered', '1 waiting, 0 answered', '0 waiting, 1 answered']);
  outbox.stop();
});

test('without a session nothing is tried until somebody signs in', async () => {
  const { outbox, sent } = withServer([new Problem(401, 'unauthenticated', 'sign in')]);
  await outbox.start('u');
  await outbox.add('o', step(1));
  await vi.advanceTimersByTimeAsync(600_000);
  expect(sent).toHaveLength(1);
  expect(outbox.writes).toHaveLength(1);
  await outbox.start('u');
  expect(sent).toHaveLength(2);
  outbox.stop();
});
