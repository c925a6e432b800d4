/** Who was signed in last, so that a page can be opened again without a connection. */

import type { Me } from '../api/types';

const name = 'binnacle.me';

export function keepMe(me: Me): void {
  try {
    localStorage.setItem(name, JSON.stringify(me));
  } catch {
    // Then a page without a connection asks to sign in.
  }
}

export function keptMe(): Me | null {
  try {
    return JSON.parse(localStorage.getItem(name) ?? 'null') as Me | null;
  } catch {
    return null;
  }
}

export function forgetMe(): void {
  try {
    localStorage.removeItem(name);
  } catch {
    // Nothing was kept.
  }
}
