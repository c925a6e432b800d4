/**
 * Times where a ship is: in UTC, by her clocks, or both, as the reader chose. Her clocks are
 * the nautical zone of her longitude at sea, and the port's in port.
 */

import { SvelteMap } from 'svelte/reactivity';
import { searchPorts } from '../api/schedule';
import { atSea, zoneOf, type Clocks } from '../format';
import type { Where } from '../whereabouts';

export const clockChoices: Clocks[] = ['utc', 'ship', 'both'];

const key = 'binnacle-clocks';

class TimesState {
  clocks = $state<Clocks>(stored());
  #zones = new SvelteMap<string, number>();
  #asked = new Set<string>();
  /** One question at a time: what else a page asks for is looked at first. */
  #last: Promise<void> = Promise.resolve();

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

  /** The day alone, by the first of those clocks. */
  day = (value: string | Date, where: Where): string => this.at(value, where).replace(/,.*/, '');

  #zoneAt(where: Where): number | undefined {
    if (!where) return undefined;
    if ('lon' in where) return zoneOf(where.lon);
    // Only a UN/LOCODE is known, alone or behind the name: an order may name its port in words.
    const code = /^(?:.*\()?([A-Z]{2}[A-Z2-9]{3})\)?$/.exec(where.port ?? '')?.[1];
    if (code === undefined || this.clocks === 'utc') return undefined;
    if (!this.#asked.has(code)) {
      this.#asked.add(code);
      this.#last = this.#last.then(() => this.#learn(code));
    }
    return this.#zones.get(code);
  }

  async #learn(code: string): Promise<void> {
    const found = await searchPorts(code, 20).catch(() => []);
    const port = found.find((known) => known.code === code);
    if (port) this.#zones.set(code, port.zone_h);
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
