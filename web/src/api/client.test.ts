import { afterEach, describe, expect, test, vi } from 'vitest';
import { createVessel, findModel, listVessels, whenSignedOut } from './client';
import { Problem } from './problem';

// The client takes the browser's `fetch` and `Request` when it is loaded: these
// stand in for them, as there is neither a server nor a page to be relative to.
const network = vi.hoisted(() => {
  const state = { answers: [] as (Response | Error)[], asked: [] as Request[] };
  globalThis.fetch = (request) => {
    if (!(request instanceof Request)) throw new Error('not a request');
    state.asked.push(request);
    const answer = state.answers.shift();
    if (!answer) throw new Error(`not expected: ${request.url}`);
    return answer instanceof Error ? Promise.reject(answer) : Promise.resolve(answer);
  };
  globalThis.Request = class extends Request {
    constructor(url: string, init?: RequestInit) {
      super(new URL(url, 'http://server.example'), init);
    }
  } as typeof Request;
  return state;
});

/** Answers calls in their order; what was asked comes back. */
function serve(...answers: (Response | Error)[]): Request[] {
  network.answers = answers;
  network.asked = [];
  return network.asked;
}

const json = (body: unknown, status = 200) => Response.json(body, { status });
const problem = (status: number, kind: string, detail: string) =>
  json({ type: `https://binnacle.example/problems/${kind}`, title: kind, status, detail }, status);

afterEach(() => {
  whenSignedOut(() => undefined);
});

describe('a call', () => {
  test('carries the header without which the server takes no changes', async () => {
    const asked = serve(json({}, 201));
    await createVessel({ name: 'Arcturus' });
    expect(asked[0]?.headers.get('X-Binnacle-Request')).toBe('1');
    expect(await asked[0]?.json()).toEqual({ name: 'Arcturus' });
  });

  test('that asks sends no header of its own, so that an answer fetched ahead will do', async () => {
    const asked = serve(json({ items: [] }));
    await listVessels();
    expect(asked[0]?.headers.get('X-Binnacle-Request')).toBeNull();
  });

  test('that is refused throws the problem in the server’s words', async () => {
    serve(problem(404, 'no-model-yet', '3 samples, 20 needed'));
    await expect(findModel('v')).rejects.toMatchObject({
      status: 404,
      kind: 'no-model-yet',
      message: '3 samples, 20 needed',
      refusal: undefined,
    });
    const refusal = { reason: 'too_few_samples', found: 3, needed: 20 };
    serve(json({ type: '/problems/no-model-yet', detail: '3 samples', refusal }, 404));
    await expect(findModel('v')).rejects.toMatchObject({ refusal, cardWithdrawn: undefined });
  });

  test('that nobody answers is offline, whatever a proxy says of itself', async () => {
    serve(new TypeError('fetch failed'));
    await expect(findModel('v')).rejects.toMatchObject({ offline: true });
    serve(new Response('<h1>Bad gateway</h1>', { status: 502 }));
    const failure = await findModel('v').catch((error: unknown) => error);
    expect(failure).toBeInstanceOf(Problem);
    expect(failure).toMatchObject({ status: 502, offline: false });
  });

  test('without a session tells that it has ended; a wrong password does not', async () => {
    const tell = vi.fn();
    whenSignedOut(tell);
    serve(problem(401, 'wrong-password', 'wrong'));
    await expect(findModel('v')).rejects.toBeInstanceOf(Problem);
    expect(tell).not.toHaveBeenCalled();
    serve(problem(401, 'unauthenticated', 'sign in'));
    await expect(findModel('v')).rejects.toBeInstanceOf(Problem);
    expect(tell).toHaveBeenCalledOnce();
  });
});

describe('a list', () => {
  test('is followed page by page to its end', async () => {
    const asked = serve(json({ items: [{ id: 'a' }], next: 'c1' }), json({ items: [{ id: 'b' }] }));
    expect((await listVessels()).map((vessel) => vessel.id)).toEqual(['a', 'b']);
    expect(new URL(asked[1]?.url ?? '').searchParams.get('after')).toBe('c1');
  });
});
