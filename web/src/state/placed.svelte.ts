/**
 * The deviation where the ship was last, and where the reader puts her instead.
 *
 * What always holds: while she is moved one question is under way at a time, and the last
 * place is always asked for; a place without an answer shows no other place's curve.
 */

import type { Place } from '../api/client';
import type { DeviationTable } from '../api/types';
import { Resource } from './resource.svelte';

export class PlacedDeviation {
  here = new Resource<DeviationTable>();
  there = new Resource<DeviationTable>();
  /** Where the reader put her; the last position if undefined. */
  place = $state.raw<Place | undefined>();
  /** Where she is while she is in the reader's hand. */
  inHand = $state.raw<Place | undefined>();
  #find: (place?: Place) => Promise<DeviationTable>;
  #asking = false;

  constructor(find: (place?: Place) => Promise<DeviationTable>) {
    this.#find = find;
  }

  get shown(): Resource<DeviationTable> {
    return this.#wanted ? this.there : this.here;
  }

  load = (): Promise<void> => this.here.load(() => this.#find());

  /** Asks again for what is shown. */
  again = (): Promise<void> => (this.#wanted ? this.#ask(this.#wanted) : this.load());

  /** Asks for everything anew, as after another fit. */
  reload(): void {
    void this.load();
    if (this.#wanted) void this.again();
  }

  move(place: Place): void {
    this.inHand = place;
    void this.#follow();
  }

  put(place: Place): void {
    this.place = place;
    this.inHand = undefined;
    void this.#follow();
  }

  reset(): void {
    this.place = undefined;
    this.inHand = undefined;
    this.there.clear();
  }

  /** Forgets the tables, for another compass at the same place. */
  clear(): void {
    this.here.clear();
    this.there.clear();
  }

  get #wanted(): Place | undefined {
    return this.inHand ?? this.place;
  }

  async #follow(): Promise<void> {
    // The curve she was taken from says itself of where it is, until the first answer.
    if (!this.there.value && this.here.value) this.there.show(this.here.value, new Date());
    if (this.#asking) return;
    this.#asking = true;
    for (let asked; this.#wanted && asked !== this.#wanted;) {
      asked = this.#wanted;
      await this.#ask(asked);
    }
    this.#asking = false;
  }

  async #ask(place: Place): Promise<void> {
    await this.there.load(() => this.#find(place));
    if (this.there.problem) this.there.value = undefined;
  }
}
