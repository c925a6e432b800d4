/**
 * Times where a ship is: in UTC, by her clocks, or both, as the reader chose. Her clocks are
 * the nautical zone of her longitude at sea, and the port's legal time in port.
 */

import { atSea, hoursAtSea, zoneOf, type Clocks } from '../format';
import type { Where } from '../whereabouts';
import type { Zone } from '../zone';
import { ports } from './ports.svelte';

export const clockChoices: Clocks[] = ['utc', 'ship', 'both'];

const key = 'binnacle-clocks';

class TimesState {
  clocks = $state<Clocks>(stored());

  set(clocks: Clocks): void {
    this.clocks = clocks;
    try {
      localStorage.setItem(key, clocks);
    } catch {
      // Without storage the choice lasts as long as the page.
    }
  }

  /** An instant as the reader wants it; in UTC alone as long as the port's zone is not known. */
  at = (value: string | Date | null | undefined, where: Where): string =>
    atSea(value, this.#zoneAt(where), this.clocks);

  /** Hours as the reader wants them. */
  hours = (
    from: string | null | undefined,
    until: string | null | undefined,
    where: Where,
  ): string => hoursAtSea(from, until, this.#zoneAt(where), this.clocks);

  /** The day alone, by the first of those clocks. */
  day = (value: string | Date, where: Where): string => this.at(value, where).replace(/,.*/, '');

  #zoneAt(where: Where): Zone | undefined {
    if (!where) return undefined;
    if ('lon' in where) return zoneOf(where.lon);
    return this.clocks === 'utc' ? undefined : ports.find(where.port)?.zone;
  }
}

function stored(): Clocks {
  try {
    const value = localStorage.getItem(key);
    return clockChoices.find((clocks) => clocks === value) ?? 'both';
  } catch {
    return 'both';
  }
}

export const times = new TimesState();
