/** What a form sends: what became of it, and that a repetition is known for one. */
import { tick } from 'svelte';
import { newKey } from './api/client';

export class Submission {
  /** Why it did not succeed, in words; empty while nothing is wrong. */
  failure = $state('');
  /** Whether it is on its way. */
  busy = $state(false);
  #key = newKey();
  #sent = '';

  /** Says what is wrong before anything is sent; true if nothing is. */
  holds(failure: string | undefined): boolean {
    this.failure = failure ?? '';
    return this.failure === '';
  }

  /**
   * Sends `content`, with the same key again as long as it is the same content, so
   * that a server which has it does not take it twice. Nothing if it failed.
   */
  async send<C, T>(
    content: C,
    by: (content: C, key: string) => Promise<T>,
  ): Promise<T | undefined> {
    const written = JSON.stringify(content);
    if (written !== this.#sent) this.#key = newKey();
    this.#sent = written;
    const focused = typeof document === 'undefined' ? null : document.activeElement;
    this.busy = true;
    this.failure = '';
    try {
      return await by(content, this.#key);
    } catch (error) {
      this.failure = error instanceof Error ? error.message : String(error);
      void this.#goBackTo(focused);
      return undefined;
    } finally {
      this.busy = false;
    }
  }

  /** A button that cannot be pressed while it sends loses the focus: then it gets it back. */
  async #goBackTo(focused: Element | null): Promise<void> {
    await tick();
    if (focused instanceof HTMLElement && document.activeElement === document.body) focused.focus();
  }
}
