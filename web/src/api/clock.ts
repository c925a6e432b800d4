/** The server's clock, as far as it is known: a phone's own may be minutes off. */

let aheadMs = 0;

/** Notes what an answer said the time is. */
export function noteServerTime(date: string | null): void {
  const at = Date.parse(date ?? '');
  if (!Number.isNaN(at)) aheadMs = at - Date.now();
}

/** Now by the server's clock, never after it. */
export const serverNow = (): Date => new Date(Date.now() + aheadMs);
