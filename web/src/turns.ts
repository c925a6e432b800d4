/**
 * What need not be there at once is done one after another, whenever the browser has nothing
 * else to do: a finger waits for one of them at most.
 *
 * What always holds: first come, first served; and nothing waits for ever, also in a
 * browser that is never idle.
 */

const waiting: (() => void)[] = [];
/** A busy browser has the next one done after so long, ms. */
const patienceMs = 500;
let asked = false;

/** Acts when it is its turn; what calls it off. */
export function inTurn(act: () => void): () => void {
  waiting.push(act);
  ask();
  return () => {
    const place = waiting.indexOf(act);
    if (place >= 0) waiting.splice(place, 1);
  };
}

function ask(): void {
  if (asked || waiting.length === 0) return;
  asked = true;
  // Not every browser tells when it is idle.
  if ('requestIdleCallback' in globalThis) requestIdleCallback(next, { timeout: patienceMs });
  else setTimeout(next, 0);
}

function next(): void {
  asked = false;
  try {
    waiting.shift()?.();
  } finally {
    ask();
  }
}
