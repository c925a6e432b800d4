/**
 * News from the server as it happens.
 *
 * The browser resumes a broken connection by itself, after the last event it
 * saw. When the server refused the connection it gives up; then a new one is
 * opened, ever more slowly, and everything counts as news, because events may
 * have been missed.
 */

import { findMe } from './client';

export interface News {
  /** The vessel it is about; none when anything may have changed. */
  vesselId: string | null;
  kind: (typeof kinds)[number] | 'all';
}

const kinds = ['batch', 'model', 'logbook', 'alert', 'work_order', 'port_call', 'need'] as const;

type Listener = (news: News) => void;

const firstWaitMs = 2_000;
const longestWaitMs = 60_000;

class LiveState {
  status = $state<'connecting' | 'live' | 'lost'>('connecting');
  /** Since when it is lost; none while it is not. */
  lostAt = $state.raw<Date | null>(null);
  #source: EventSource | null = null;
  #listeners = new Set<Listener>();
  #waitMs = firstWaitMs;
  #timer: ReturnType<typeof setTimeout> | undefined;

  start(): void {
    this.stop();
    this.status = 'connecting';
    this.#connect();
    addEventListener('online', this.#retryNow);
    addEventListener('offline', this.#lost);
  }

  stop(): void {
    removeEventListener('online', this.#retryNow);
    removeEventListener('offline', this.#lost);
    clearTimeout(this.#timer);
    this.#source?.close();
    this.#source = null;
    this.lostAt = null;
    this.#waitMs = firstWaitMs;
  }

  listen(listener: Listener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  #connect(): void {
    const source = new EventSource('/api/v1/events');
    this.#source = source;
    source.onopen = () => {
      // After the browser's own resume the server repeats what was missed; after a new
      // connection of ours nobody does, nor does anybody what a page asked for meanwhile.
      const again = this.status === 'lost';
      this.status = 'live';
      this.lostAt = null;
      if (again) this.#tell({ vesselId: null, kind: 'all' });
      this.#waitMs = firstWaitMs;
    };
    source.onerror = () => {
      this.#lost();
      if (source.readyState !== EventSource.CLOSED) return;
      this.#timer = setTimeout(() => {
        this.#reconnect();
      }, this.#waitMs);
      this.#waitMs = Math.min(this.#waitMs * 2, longestWaitMs);
    };
    source.addEventListener('vessel', (event: MessageEvent<string>) => {
      const news = parseNews(event.data);
      if (news) this.#tell(news);
    });
  }

  #reconnect(): void {
    this.#source?.close();
    // A closed stream may mean that the session has ended; asking says so.
    findMe().then(
      () => {
        if (this.#source) this.#connect();
      },
      () => {
        if (!this.#source) return;
        this.#timer = setTimeout(() => {
          this.#reconnect();
        }, this.#waitMs);
        this.#waitMs = Math.min(this.#waitMs * 2, longestWaitMs);
      },
    );
  }

  /** An open stream does not feel that the network is gone; the browser does. */
  #lost = (): void => {
    this.status = 'lost';
    this.lostAt ??= new Date();
  };

  #retryNow = (): void => {
    if (this.status !== 'lost') return;
    clearTimeout(this.#timer);
    this.#reconnect();
  };

  #tell(news: News): void {
    for (const listener of this.#listeners) listener(news);
  }
}

export function parseNews(data: string): News | null {
  try {
    const value: unknown = JSON.parse(data);
    if (typeof value !== 'object' || value === null) return null;
    if (!('vessel_id' in value) || typeof value.vessel_id !== 'string') return null;
    if (!('kind' in value)) return null;
    const kind = kinds.find((known) => known === value.kind);
    return kind ? { vesselId: value.vessel_id, kind } : null;
  } catch {
    return null;
  }
}

export const live = new LiveState();

/** Gathers calls and runs `act` once, `waitMs` after the first of them. */
export function gathered(act: () => void, waitMs: number): { call: () => void; stop: () => void } {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return {
    call: () => {
      timer ??= setTimeout(() => {
        timer = undefined;
        act();
      }, waitMs);
    },
    stop: () => {
      clearTimeout(timer);
      timer = undefined;
    },
  };
}

/** Acts when the connection is back; what calls it off. */
export function whenBack(act: () => void): () => void {
  const stop = live.listen((news) => {
    if (news.kind === 'all') act();
  });
  // Whoever runs the platform hears nothing live.
  addEventListener('online', act);
  return () => {
    stop();
    removeEventListener('online', act);
  };
}
