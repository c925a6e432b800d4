/**
 * Whether the page is being printed. What is drawn as wide as the screen is drawn anew for
 * paper, where it would be too wide, or its letters too small.
 */

import { flushSync } from 'svelte';

/** A panel's width on A4 upright, CSS pixels. */
const panelWidth = 650;

class Paper {
  /** How wide a panel is on it; none while there is none. */
  width = $state<number | null>(null);
}

export const paper = new Paper();

if (typeof window !== 'undefined') {
  // The browser prints what is there when this returns.
  addEventListener('beforeprint', () => {
    flushSync(() => (paper.width = panelWidth));
  });
  addEventListener('afterprint', () => (paper.width = null));
}
