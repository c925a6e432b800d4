/** Has the browser keep the dashboard's own files (public/sw.js). */

/** The page comes first: to keep it takes a phone's strength from drawing it, ms. */
const afterMs = 4_000;

/** Begins it, where the browser can; without TLS, but for this machine, it cannot. */
export function keepFiles(): void {
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return;
  setTimeout(() => {
    navigator.serviceWorker
      .register('/sw.js')
      .then(() => navigator.serviceWorker.ready)
      .then(tellLoaded)
      .catch(() => undefined);
  }, afterMs);
}

/** Tells it what this page has loaded, and goes on loading. */
function tellLoaded({ active }: ServiceWorkerRegistration): void {
  const tell = (entries: PerformanceEntryList) => {
    active?.postMessage({ keep: entries.map((entry) => entry.name) });
  };
  new PerformanceObserver((list) => {
    tell(list.getEntries());
  }).observe({ type: 'resource', buffered: true });
}
