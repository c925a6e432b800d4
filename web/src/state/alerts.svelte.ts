/** The fleet's open alerts, for the badge on every page and the page of their own. */

import { inOrder, raisedOf } from '../alerts';
import { listOpenAlerts } from '../api/client';
import { gathered, live } from '../api/live.svelte';
import type { Alert } from '../api/types';
import { clock } from './clock.svelte';
import { Resource } from './resource.svelte';

class AlertState {
  open = new Resource<Alert[]>();
  #raised = $derived(raisedOf(this.open.value ?? [], clock.now));
  raised = $derived(this.#raised.length);
  worst = $derived(this.#raised[0]?.severity ?? null);

  load = (): Promise<void> => this.open.load(async () => inOrder(await listOpenAlerts()));

  /** Keeps them up to date until the function it returns is called. */
  follow(): () => void {
    void this.load();
    const refresh = gathered(() => void this.load(), 500);
    const stop = live.listen((news) => {
      if (news.kind === 'alert' || news.kind === 'all') refresh.call();
    });
    return () => {
      refresh.stop();
      stop();
      this.open.clear();
    };
  }
}

export const alerts = new AlertState();
