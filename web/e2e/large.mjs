/**
 * Measures the pages of a large fleet and of one of its vessels: `node e2e/large.mjs`, with the
 * environment of e2e/run.mjs, against a server whose fleet scripts/thousand.py has filled, as
 * scripts/bench-web does. Prints medians of five loads; asserts nothing.
 */
import { chromium } from 'playwright-core';
import { chart, curve, fleetIsShown, signIn } from './helpers.mjs';
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
  const drawn = ['tbody th', 'path.mark[d^="M"]', 'path.land[d^="M"]'];
  const look = () => {
    if (drawn.every((part) => document.querySelector(part))) window.drawnAt = performance.now();
    else requestAnimationFrame(look);
  };
  look();
});

const runs = [];
for (let run = 0; run < 5; run++) {
  const session = await page.context().newCDPSession(page);
  await session.send('Network.clearBrowserCache');
  const before = wire.octets;
  // By its address: what was searched for in the last run is kept in the page's own.
  await page.goto('/');
  await fleetIsShown(page);
  const ofVessel = page.getByRole('rowheader').first().getByRole('link');
  await page.waitForTimeout(1_500);
  const fleet = await page.evaluate(
    async (sought) => {
      const fleet = performance
        .getEntriesByType('resource')
        .find(({ name }) => name.endsWith('/fleet'));
      const busyUntil = Math.max(
        fleet.responseEnd,
        window.drawnAt,
        ...window.longTasks.map((task) => task.startTime + task.duration),
      );
      const search = document.querySelector('input[type=search]');
      const typed = performance.now();
      search.value = sought;
      search.dispatchEvent(new InputEvent('input', { bubbles: true }));
      await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
      return {
        fleet_octets: fleet.encodedBodySize,
        server_and_wire_ms: fleet.responseEnd - fleet.requestStart,
        data_to_drawn_ms: window.drawnAt - fleet.responseEnd,
        data_to_interactive_ms: busyUntil - fleet.responseEnd,
        search_ms: performance.now() - typed,
      };
    },
    await ofVessel.innerText(),
  );
  const octets = wire.octets - before;
  await page.goto(new URL(await ofVessel.getAttribute('href'), wire.url).href);
  await chart(page).scrollIntoViewIfNeeded();
  await curve(page).waitFor();
  await page.waitForTimeout(1_500);
  const vessel = await page.evaluate(() => {
    const asked = performance
      .getEntriesByType('resource')
      .filter(({ name }) => name.includes('/api/') && !name.endsWith('/events'))
      .map(({ requestStart, responseEnd }) => responseEnd - requestStart);
    return {
      vessel_requests: asked.length,
      vessel_slowest_request_ms: Math.max(...asked),
      vessel_all_requests_ms: asked.reduce((sum, one) => sum + one, 0),
    };
  });
  runs.push({ ...fleet, octets, ...vessel });
  await session.detach();
}
await browser.close();
wire.close();
for (const figure of Object.keys(runs[0])) {
  console.log(`${figure}: ${Math.round(median(runs.map((run) => run[figure])))}`);
}
