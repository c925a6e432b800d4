/** What the frame around the pages shows: of the connection, so that nothing says it twice, and of itself. */

import { untrack } from 'svelte';

class FrameState {
  /** Since when there is no connection, while the frame says so. */
  without = $state.raw<Date | null>(null);
  /** Whether a page wants a phone's whole screen, as at the binnacle. */
  isBare = $state(false);
  #elsewhere = $state(0);

  /** Whether the page, or a part of it, says so itself. */
  get isSaid(): boolean {
    return this.#elsewhere > 0;
  }

  /** It is said elsewhere until the function it returns is called. */
  said(): () => void {
    untrack(() => (this.#elsewhere += 1));
    return () => {
      untrack(() => (this.#elsewhere -= 1));
    };
  }
}

export const frame = new FrameState();
