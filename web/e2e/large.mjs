/**
 * Measures the fleet's page with many vessels: `node e2e/large.mjs`, with the same
 * environment as e2e/run.mjs, against a server whose fleet scripts/thousand.py has filled.
 * Prints medians of five loads; asserts nothing.
 */
import { chromium } from 'playwright-core';
import { fleetIsShown, signIn } from './helpers.mjs';
import { browserPath, flags, required } from './browser.mjs';
import { wireTo } from './wire.mjs';

const settings = {
  url: required('BINNACLE_URL').replace(/\/$/, ''),
  email: required('BINNACLE_EMAIL'),
  password: required('BINNACLE_PASSWORD'),
};
const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

const browser = await chromium.launch({ executablePath: browserPath(), args: flags });
const wire = await wireTo(settings.url);
const page = await browser.newPage({
  baseURL: wire.url,
  // Each load fetches everything, as a first visit does.
  serviceWorkers: 'block',
  viewport: { width: 1440, height: 900 },
});
await signIn(page, settings);
await page.addInitScript(() => {
  window.longTasks = [];
  new PerformanceObserver((list) => window.longTasks.push(...list.getEntries())).observe({
    type: 'longtask',
    buffered: true,
  });
});

const runs = [];
for (let run = 0; run < 5; run++) {
  const session = await page.context().newCDPSession(page);
  await session.send('Network.clearBrowserCache');
  const before = wire.octets;
  await page.reload();
  await fleetIsShown(page);
  await page.waitForTimeout(1_500);
  const measured = await page.evaluate(async () => {
    const fleet = performance
      .getEntriesByType('resource')
      .find(({ name }) => name.endsWith('/fleet'));
    const busyUntil = Math.max(
      fleet.responseEnd,
      ...window.longTasks.map((task) => task.startTime + task.duration),
    );
    const search = document.querySelector('input[type=search]');
    const typed = performance.now();
    search.value = 'noor';
    search.dispatchEvent(new InputEvent('input', { bubbles: true }));
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    return {
      fleet_octets: fleet.encodedBodySize,
      server_and_wire_ms: fleet.responseEnd - fleet.requestStart,
      data_to_interactive_ms: busyUntil - fleet.responseEnd,
      search_ms: performance.now() - typed,
    };
  });
  runs.push({ ...measured, octets: wire.octets - before });
  await session.detach();
}
await browser.close();
wire.close();
for (const figure of Object.keys(runs[0])) {
  console.log(`${figure}: ${Math.round(median(runs.map((run) => run[figure])))}`);
}
