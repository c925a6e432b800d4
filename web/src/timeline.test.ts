import { describe, expect, test } from 'vitest';
import type { Epoch, LogbookEntry, PortCall, Timeline } from './api/types';
import { marksIn, next, placed, rangeOf, type Mark } from './timeline';

const ms = (at: string) => Date.parse(at);
const range = { fromMs: ms('2026-05-01T00:00:00Z'), toMs: ms('2026-05-21T00:00:00Z') };
const call = (id: string, eta: string, etd: string) =>
  ({ id, eta, etd, port: 'NLRTM', port_name: 'Rotterdam', withdrawn_at: null }) as PortCall;
const entry = (more: Partial<LogbookEntry>): LogbookEntry =>
  ({
    id: 'e',
    kind: 'lightning',
    from: '2026-05-10T03:12:00Z',
    to: null,
    note: '',
    withdrawn_at: null,
    ...more,
  }) as LogbookEntry;
const timeline = {
  epochs: [
    { from: null, to: '2026-05-10T03:00:00Z', curve: null } as Epoch,
    { from: '2026-05-10T03:00:00Z', to: null, curve: null } as Epoch,
  ],
  changes: [],
} as unknown as Timeline;

describe('the time axis', () => {
  test('has what falls into it, cut at its ends', () => {
    const calls = [
      call('before', '2026-04-01T00:00:00Z', '2026-04-02T00:00:00Z'),
      call('reaching in', '2026-04-29T00:00:00Z', '2026-05-02T00:00:00Z'),
    ];
    const marks = marksIn(range, timeline, [entry({})], calls);
    expect(marks.map((mark) => mark.key)).toEqual([
      'epoch 0',
      'epoch 1',
      'entry e',
      'call reaching in',
    ]);
    expect(marks[3]?.fromMs).toBe(range.fromMs);
    expect(marks[0]?.toMs).toBe(ms('2026-05-10T03:00:00Z'));
    expect(marks[1]?.toMs).toBe(range.toMs);
  });

  test('leaves out what was withdrawn, and lets open cargo go on', () => {
    const marks = marksIn(
      range,
      undefined,
      [
        entry({ id: 'w', withdrawn_at: '2026-05-11T00:00:00Z' }),
        entry({ id: 'cargo', kind: 'magnetic_cargo' }),
      ],
      [],
    );
    expect(marks.map((mark) => [mark.key, mark.toMs])).toEqual([['entry cargo', range.toMs]]);
  });

  test('ends with the samples, or with a call soon after them', () => {
    const times = [new Date(range.fromMs), new Date(range.toMs)];
    const mark = (from: string, to: string) => ({ fromMs: ms(from), toMs: ms(to) });
    expect(rangeOf(times, [])).toEqual(range);
    const inPort = mark('2026-05-21T06:00:00Z', '2026-05-22T00:00:00Z');
    expect(rangeOf(times, [inPort])?.toMs).toBe(inPort.toMs);
    const yearsLater = mark('2028-01-01T00:00:00Z', '2028-01-02T00:00:00Z');
    expect(rangeOf(times, [yearsLater])).toEqual(range);
    expect(rangeOf([], [])).toBeNull();
  });

  test('gives each mark a finger’s width, and a row of its own where they would touch', () => {
    const at = (fromMs: number, toMs = fromMs) => ({ fromMs, toMs }) as Mark;
    const line = { fromMs: 0, toMs: 1000 };
    const [a, b, c, d] = placed([at(0), at(5), at(500, 900), at(1000)], line, 1000, 24);
    expect([a?.x, a?.width, a?.row]).toEqual([0, 24, 0]);
    expect(b?.row).toBe(1);
    expect([c?.x, c?.width, c?.row]).toEqual([500, 400, 0]);
    expect([d?.x, d?.row]).toEqual([976, 0]);
  });

  test('is walked by arrow keys, along a lane and to the nearest of the next', () => {
    const marks = marksIn(
      range,
      timeline,
      [entry({ id: 'a' }), entry({ id: 'b', from: '2026-05-18T00:00:00Z' })],
      [call('c', '2026-05-17T00:00:00Z', '2026-05-18T00:00:00Z')],
    );
    const go = (key: string, from: string) => {
      const mark = marks.find((known) => known.key === from);
      return mark ? (next(marks, mark, key)?.key ?? null) : undefined;
    };
    expect(go('ArrowRight', 'epoch 0')).toBe('epoch 1');
    expect(go('ArrowRight', 'epoch 1')).toBeNull();
    expect(go('ArrowDown', 'call c')).toBeNull();
    expect(go('ArrowUp', 'call c')).toBe('entry b');
    expect(go('ArrowDown', 'epoch 0')).toBe('entry a');
    expect(go('End', 'entry a')).toBe('entry b');
    expect(go('Enter', 'entry a')).toBeNull();
  });
});
