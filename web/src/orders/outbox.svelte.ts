/**
 * Sends what was written at the binnacle, one after the other, until it is answered.
 *
 * What always holds: a write is kept before anything is told of it, and let go only when
 * the server has answered; each try of it bears the same key, so that it is written
 * once; and of several pages of one browser one at a time sends.
 */

import { newKey } from '../api/client';
import { sendWrite } from '../api/orders';
import { asProblem, Problem } from '../api/problem';
import type { WorkOrder } from '../api/types';
import * as text from '../text';
import { openShelf, type Shelf } from './shelf';
import { bearsOut, builtOn, isRefusal, nextToSend, type Content, type Write } from './writes';

const firstWaitMs = 2_000;
const longestWaitMs = 30_000;

type Sender = (write: Write) => Promise<WorkOrder>;
type Listener = (order: WorkOrder) => void;

export class Outbox {
  /** What is not answered yet, in order. */
  writes = $state.raw<Write[]>([]);
  /** Whether one is on its way now. */
  sending = $state(false);
  /** Why the last try did not get through. */
  trouble = $state.raw<Problem | undefined>();
  /** Whether the browser keeps what is written when the page is closed. */
  durable = $state(true);

  #shelf: Promise<Shelf> | undefined;
  #user: string | undefined;
  #listeners = new Set<Listener>();
  #waitMs = firstWaitMs;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #channel: BroadcastChannel | undefined;

  #send: Sender;
  #open: () => Promise<Shelf>;

  constructor(send: Sender = sendWrite, open: () => Promise<Shelf> = openShelf) {
    this.#send = send;
    this.#open = open;
  }

  /** The browser's shelf, opened when it is first needed. */
  get shelf(): Promise<Shelf> {
    this.#shelf ??= this.#open().then((shelf) => {
      this.durable = shelf.durable;
      return shelf;
    });
    return this.#shelf;
  }

  /** Sends what this user wrote, now and whenever the connection is back. */
  async start(user: string): Promise<void> {
    this.#user = user;
    if (typeof addEventListener === 'function') addEventListener('online', this.now);
    if (typeof BroadcastChannel === 'function' && !this.#channel) {
      this.#channel = new BroadcastChannel('binnacle-outbox');
      this.#channel.onmessage = () => void this.#read();
    }
    await this.#read();
    await this.#drain();
  }

  stop(): void {
    if (typeof removeEventListener === 'function') removeEventListener('online', this.now);
    clearTimeout(this.#timer);
    this.#channel?.close();
    this.#channel = undefined;
    this.#user = undefined;
    this.writes = [];
  }

  /** Tells of every order that came as an answer. */
  listen(listener: Listener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /** Keeps a write and sends it when its turn comes. */
  async add(order: string, content: Content): Promise<void> {
    const write = {
      order,
      user: this.#user ?? '',
      key: newKey(),
      at: new Date().toISOString(),
      content,
    };
    const shelf = await this.shelf;
    await shelf.add(write);
    await this.#changed();
    void this.#drain();
  }

  /** Lets a refused write go. */
  async drop(write: Write): Promise<void> {
    await (await this.shelf).remove(write.seq);
    await this.#changed();
  }

  /** Sends a refused write once more, because a person says so. */
  async again(write: Write): Promise<void> {
    await (await this.shelf).change({ ...write, refused: undefined });
    await this.#changed();
    this.now();
  }

  /** Tries now rather than later. */
  now = (): void => {
    clearTimeout(this.#timer);
    this.#waitMs = firstWaitMs;
    void this.#drain();
  };

  async #read(answered?: WorkOrder): Promise<void> {
    const all = await (await this.shelf).writes();
    this.writes = all.filter((write) => write.user === this.#user);
    // In one go: without the write, the order of before its answer is not how it stands.
    if (answered) for (const listener of this.#listeners) listener(answered);
  }

  async #changed(answered?: WorkOrder): Promise<void> {
    await this.#read(answered);
    this.#channel?.postMessage('changed');
  }

  async #drain(): Promise<void> {
    if (this.sending || this.#user === undefined) return;
    this.sending = true;
    try {
      await alone(async () => {
        await this.#read();
        while (await this.#sendNext());
      });
    } finally {
      this.sending = false;
    }
  }

  /** Whether there may be another one to send now. */
  async #sendNext(): Promise<boolean> {
    const write = this.#user === undefined ? undefined : nextToSend(this.writes, this.#user);
    if (!write) return false;
    const shelf = await this.shelf;
    let answered: WorkOrder;
    try {
      answered = await this.#send(write);
    } catch (error) {
      return this.#failed(write, error);
    }
    this.trouble = undefined;
    this.#waitMs = firstWaitMs;
    await shelf.remove(write.seq);
    if (!bearsOut(write.content, answered)) await this.#hold(write);
    await this.#changed(answered);
    return true;
  }

  async #failed(write: Write, error: unknown): Promise<boolean> {
    const problem = error instanceof Problem ? error : asProblem(error);
    if (isRefusal(problem.status, problem.kind)) {
      const { status, kind, message: detail, refusals } = problem;
      await this.#refuse(write, { status, kind, detail, refusals });
      await this.#hold(write);
      await this.#changed();
      return true;
    }
    this.trouble = problem;
    // Without a session there is nothing to try; signing in starts anew.
    if (problem.status !== 401) {
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => void this.#drain(), this.#waitMs);
      this.#waitMs = Math.min(2 * this.#waitMs, longestWaitMs);
    }
    return false;
  }

  async #refuse(write: Write, refused: NonNullable<Write['refused']>): Promise<void> {
    await (await this.shelf).change({ ...write, refused });
  }

  /** What was built upon a write that did not hold waits for a person. */
  async #hold(failed: Write): Promise<void> {
    const detail = text.problem.superseded;
    for (const write of builtOn(this.writes, failed)) {
      await this.#refuse(write, { status: 0, kind: 'superseded', detail, refusals: [] });
    }
  }
}

/** Runs while no other page of this browser does. */
async function alone(act: () => Promise<void>): Promise<void> {
  // Not there on pages without TLS; then the server's keys alone keep writes single.
  const locks =
    typeof navigator === 'undefined' ? undefined : (navigator as Partial<Navigator>).locks;
  if (!locks) return act();
  await locks.request('binnacle-outbox', act);
}

export const outbox = new Outbox();
