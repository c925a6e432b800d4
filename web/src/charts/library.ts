/**
 * The chart library and what is drawn with it. It is as large as all else that a vessel's
 * page is made of, so it comes after that: in its turn (../turns.ts), or at
 * once for a drawing that is about to be seen.
 */

export type Drawings = typeof import('./drawings');

let coming: Promise<Drawings> | undefined;

export function library(): Promise<Drawings> {
  coming ??= import('./drawings').catch((error: unknown) => {
    coming = undefined;
    throw error;
  });
  return coming;
}
