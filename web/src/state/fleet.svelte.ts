/** The fleet, kept up to date by what happens, vessel by vessel. */

import { findAtAGlance, findFleet } from '../api/client';
import { gathered, live } from '../api/live.svelte';
import { findSchedule, listNeeds } from '../api/schedule';
import type { AdjustmentNeed, FleetVessel, SchedulePlan } from '../api/types';
import { withNews } from '../fleet';
import { kept, Resource } from './resource.svelte';

/** News of more vessels than this at once: then the whole fleet is one question. */
const mostSingly = 6;
const waitMs = 1_500;
/** What is due changes by days. */
const needsWaitMs = 15_000;
/** So often everything is asked for: a vessel that was added meanwhile makes no news. */
const allEveryMs = 5 * 60_000;
/** Who comes back to the page after longer than this sees it asked for at once. */
const backAfterMs = 30_000;

export class FleetState {
  vessels = new Resource<FleetVessel[]>();
  /**
   * What is due when, and what is planned: asked for when the vessels are there, for they are
   * looked at first.
   */
  needs = new Resource<{ needs: AdjustmentNeed[]; plan: SchedulePlan | null }>();
  #stale = new Set<string>();
  #all = false;
  #tracked = new Set<string>();

  load = (): Promise<void> => {
    this.#tracked.clear();
    return this.vessels.load(findFleet);
  };

  /** Keeps it up to date until the function it returns is called. */
  follow(): () => void {
    const loadAll = () => this.load().then(this.loadNeeds);
    const stopAll = kept(loadAll, allEveryMs);
    const back = () => {
      const age = Date.now() - (this.vessels.loadedAt?.getTime() ?? 0);
      if (!document.hidden && age > backAfterMs) void loadAll();
    };
    document.addEventListener('visibilitychange', back);
    const needs = gathered(() => void this.loadNeeds(), needsWaitMs);
    const refresh = gathered(() => void this.#refresh(), waitMs);
    const stop = live.listen(({ vesselId, kind }) => {
      if (kind !== 'batch') needs.call();
      if (vesselId === null) this.#all = true;
      else this.#stale.add(vesselId);
      refresh.call();
    });
    return () => {
      refresh.stop();
      needs.stop();
      stop();
      stopAll();
      document.removeEventListener('visibilitychange', back);
    };
  }

  /** Asks for a vessel's track where the fleet is too large to bring them all. */
  async withTrackOf(id: string): Promise<void> {
    const vessel = this.vessels.value?.find((known) => known.id === id);
    if (!vessel?.position || vessel.track.length > 0 || this.#tracked.has(id)) return;
    this.#tracked.add(id);
    const news = await findAtAGlance(id).catch(() => undefined);
    if (news) this.vessels.value = withNews(this.vessels.value ?? [], id, news);
  }

  loadNeeds = (): Promise<void> =>
    this.needs.load(async () => {
      const [needs, { plan }] = await Promise.all([listNeeds(), findSchedule()]);
      return { needs, plan };
    });

  async #refresh(): Promise<void> {
    const [ids, all] = [[...this.#stale], this.#all];
    this.#stale.clear();
    this.#all = false;
    if (all || ids.length > mostSingly || !this.vessels.value) return this.load();
    await this.vessels.load(async () => {
      const news = await Promise.all(ids.map(findAtAGlance));
      return ids.reduce((fleet, id, i) => withNews(fleet, id, news[i]), this.vessels.value ?? []);
    });
  }
}
