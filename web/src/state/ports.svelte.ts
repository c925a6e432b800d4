/** What is known of ports by their UN/LOCODE: their names, and legal time there. */

import { SvelteMap } from 'svelte/reactivity';
import { searchPorts } from '../api/schedule';
import type { Port } from '../api/types';
import { codeOf, portWritten } from '../ports';

class PortsState {
  #known = new SvelteMap<string, Port>();
  #asked = new Set<string>();
  /** One question at a time: what else a page asks for is looked at first. */
  #last: Promise<void> = Promise.resolve();

  /** The port that words name by its code, once the server has told. */
  find(words: string | null | undefined): Port | undefined {
    const code = codeOf(words);
    if (code === undefined) return undefined;
    if (!this.#asked.has(code)) {
      this.#asked.add(code);
      this.#last = this.#last.then(() => this.#learn(code));
    }
    return this.#known.get(code);
  }

  /** The words with the port's name, where they are its code alone. */
  named = (words: string): string => {
    if (codeOf(words) !== words) return words;
    const port = this.find(words);
    return port ? portWritten(port) : words;
  };

  async #learn(code: string): Promise<void> {
    try {
      const found = await searchPorts(code, 20);
      const port = found.find((known) => known.code === code);
      if (port) this.#known.set(code, port);
    } catch {
      // Whoever looks next asks again.
      this.#asked.delete(code);
    }
  }
}

export const ports = new PortsState();
