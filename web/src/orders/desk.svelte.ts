/**
 * One order on the table: what the server said last, what is kept of it without a
 * connection, and what is waiting to be sent.
 */

import { findBinnacle } from '../api/binnacles';
import { findOffer, findOrder, findOrderBinnacle } from '../api/orders';
import type { BinnacleRevision, PlanOffer, WorkOrder } from '../api/types';
import { Resource } from '../state/resource.svelte';
import { session } from '../state/session.svelte';
import { ahead } from './ahead';
import { isUnderWay } from './order';
import { outbox } from './outbox.svelte';
import type { Content, Write } from './writes';

export class Desk {
  readonly id: string;
  order = new Resource<WorkOrder>();
  offer = new Resource<PlanOffer>();
  /** `null` where none was entered. */
  binnacle = new Resource<BinnacleRevision | null>();
  /** What is not answered yet of this order. */
  writes: Write[] = $derived(outbox.writes.filter((write) => write.order === this.id));
  /** How the order stands with all that is waiting. */
  now = $derived(
    this.order.value ? ahead(this.order.value, this.writes, this.offer.value) : undefined,
  );
  #offeredFor = '';
  #foundAs = '';

  constructor(id: string) {
    this.id = id;
  }

  /** What was kept first, then what the server says. */
  open = async (): Promise<void> => {
    const kept = await outbox.shelf.then((shelf) => shelf.order(this.id)).catch(() => undefined);
    if (kept && kept.user === session.me?.user_id) {
      this.order.show(kept.order, new Date(kept.at));
      if (kept.binnacle) this.binnacle.show(kept.binnacle, new Date(kept.at));
      if (kept.offer && kept.offeredFor === asked(kept.order)) {
        this.offer.show(kept.offer, new Date(kept.at));
        this.#offeredFor = kept.offeredFor;
      }
    }
    await this.load();
  };

  load = async (): Promise<void> => {
    await this.order.load(() => findOrder(this.id));
    await this.#follow();
  };

  /** Takes an order that came as an answer. */
  take = async (order: WorkOrder): Promise<void> => {
    this.order.show(order, new Date());
    await this.#follow();
  };

  /** Keeps what is written, in place of what was refused of its kind. */
  write = async (content: Content): Promise<void> => {
    const replaced = this.writes.filter(
      ({ refused, content: { kind } }) =>
        refused && (kind === content.kind || refused.kind === 'superseded'),
    );
    for (const write of replaced) await outbox.drop(write);
    await outbox.add(this.id, content);
  };

  /** Asks for the plans, when there is something to plan from that they are not of. */
  loadOffer = async (): Promise<void> => {
    const order = this.order.value;
    if (order?.state !== 'measured') return;
    const question = asked(order);
    if (question === this.#offeredFor && this.offer.value) return;
    this.offer.clear();
    await this.offer.load(() => findOffer(this.id));
    if (this.offer.value) this.#offeredFor = question;
    await this.#keep();
  };

  async #follow(): Promise<void> {
    const order = this.order.value;
    if (!order || this.order.problem) return;
    const found = JSON.stringify(order.as_found);
    if (!this.binnacle.value || this.binnacle.problem || found !== this.#foundAs) {
      // A report of the correctors as found may revise the record.
      await this.loadBinnacle();
      this.#foundAs = found;
    }
    await this.#keep();
    await this.loadOffer();
  }

  /** Asks for the record of the correctors as it is now. */
  loadBinnacle = async (): Promise<void> => {
    const order = this.order.value;
    if (!order) return;
    const { vessel_id, compass_id, state } = order;
    if (!order.has_binnacle) {
      this.binnacle.show(null, new Date());
    } else if (!session.isAdjuster) {
      await this.binnacle.load(() => findBinnacle(vessel_id, compass_id));
    } else if (isUnderWay(state)) {
      // A firm's business only until the work is done.
      await this.binnacle.load(() => findOrderBinnacle(this.id));
    }
  };

  async #keep(): Promise<void> {
    const order = this.order.value;
    if (!order) return;
    const kept = {
      id: this.id,
      user: session.me?.user_id ?? '',
      order,
      offer: this.offer.value,
      offeredFor: this.#offeredFor,
      binnacle: this.binnacle.value ?? undefined,
      at: (this.order.loadedAt ?? new Date()).toISOString(),
    };
    // What cannot be kept is only missed without a connection.
    await outbox.shelf.then((shelf) => shelf.keep(kept)).catch(() => undefined);
  }
}

/** What plans depend on: the reading, and how everything stands since. */
const asked = (order: WorkOrder): string =>
  JSON.stringify([order.reading, order.setting, order.compass_deg]);
