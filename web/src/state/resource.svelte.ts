/**
 * Something fetched from the server, and how that stands.
 *
 * What always holds: a failed refresh keeps the value that was there, and says
 * so; an answer that a later question overtook is dropped.
 */

import { asProblem, type Problem } from '../api/problem';

export class Resource<T> {
  value = $state.raw<T | undefined>();
  problem = $state.raw<Problem | undefined>();
  loading = $state(false);
  loadedAt = $state.raw<Date | undefined>();
  #asked = 0;

  async load(fetch: () => Promise<T>): Promise<void> {
    const asked = ++this.#asked;
    this.loading = true;
    try {
      const value = await fetch();
      if (asked !== this.#asked) return;
      this.value = value;
      this.problem = undefined;
      this.loadedAt = new Date();
    } catch (error) {
      if (asked !== this.#asked) return;
      this.problem = asProblem(error);
      // What is gone, or not ours, must not stay on the screen.
      if (this.problem.status === 404) this.value = undefined;
    } finally {
      if (asked === this.#asked) this.loading = false;
    }
  }

  /** Takes a value that came another way, or was kept from an earlier time. */
  show(value: T, at: Date): void {
    this.#asked++;
    this.value = value;
    this.problem = undefined;
    this.loading = false;
    this.loadedAt = at;
  }

  /** Forgets the value, for another vessel or compass. */
  clear(): void {
    this.#asked++;
    this.value = undefined;
    this.problem = undefined;
    this.loading = false;
    this.loadedAt = undefined;
  }
}

/** Loads now and then again and again, while the page is looked at; what stops it. */
export function kept(load: () => Promise<void>, everyMs: number): () => void {
  void load();
  const timer = setInterval(() => {
    if (!document.hidden) void load();
  }, everyMs);
  return () => {
    clearInterval(timer);
  };
}
