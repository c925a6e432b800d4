/** How many notifications the reader has not read, for the bell on every page. */

import { gathered, live } from '../api/live.svelte';
import { listNotifications } from '../api/notifications';

class UnreadState {
  count = $state(0);

  /** What is not known stays as it was: nobody waits for it. */
  #load = async (): Promise<void> => {
    const found = await listNotifications(1).catch(() => undefined);
    if (found) this.count = found.unread;
  };

  /** Keeps it up to date until the function it returns is called. */
  follow(): () => void {
    void this.#load();
    const refresh = gathered(() => void this.#load(), 2_000);
    const stop = live.listen(({ kind }) => {
      if (kind !== 'batch' && kind !== 'model') refresh.call();
    });
    return () => {
      refresh.stop();
      stop();
      this.count = 0;
    };
  }
}

export const unread = new UnreadState();
