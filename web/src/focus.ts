/** Where the focus goes. */

import { tick } from 'svelte';

/** Puts the focus on what has just appeared. */
export const focused = (node: HTMLElement): void => {
  node.focus();
};

/** Where a form opens in place of a button: the focus goes into it, and back when it closes. */
export function inPlace(): Record<'field' | 'button', (node: HTMLElement) => void> {
  let wasOpen = false;
  return {
    field: (node) => {
      wasOpen = true;
      node.focus();
    },
    button: (node) => {
      if (!wasOpen) return;
      wasOpen = false;
      void tick().then(() => {
        if (document.activeElement === document.body) node.focus();
      });
    },
  };
}
