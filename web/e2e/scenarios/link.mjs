/** What a slow and dear link carries before the fleet can be seen. */
import assert from 'node:assert/strict';
import { chart, curve, fleetIsShown, notSignedIn, signIn, withModel } from '../helpers.mjs';
import { wireTo } from '../wire.mjs';

/** Sign-in, the fleet's page, coasts and data, compressed as they cross the wire. */
const mostOctets = 200_000;
/** Of these, what crosses until the fleet is shown. */
const mostUntilShown = 130_000;
/** Sign-in and a vessel's first tab with its curve. */
const mostOfVessel = 300_000;
/** A page of less was not loaded over this wire at all. */
const leastOctets = 60_000;

export const link = {
  'a first visit, sign-in and fleet, is at most 200 kB on the wire': {
    async run({ browser, settings }) {
      const wire = await wireTo(settings.url);
      const context = await browser.newContext({
        baseURL: wire.url,
        viewport: { width: 1440, height: 900 },
      });
      try {
        const page = await context.newPage();
        await signIn(page, settings);
        await fleetIsShown(page);
        const shown = wire.octets;
        // What the service worker fetches to keep is carried as well.
        await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
        for (let seen = -1; seen !== wire.octets; await page.waitForTimeout(1_000)) {
          seen = wire.octets;
        }
        console.log(`     ${shown} octets until the fleet is shown, ${wire.octets} in all`);
        assert.ok(shown >= leastOctets, `only ${shown} octets crossed: the wire was not watched`);
        assert.ok(shown <= mostUntilShown, `${shown} octets crossed until the fleet was shown`);
        assert.ok(wire.octets <= mostOctets, `${wire.octets} octets crossed the wire`);
      } finally {
        await context.close();
        wire.close();
      }
    },
  },

  'a first visit of a vessel’s page is at most 300 kB on the wire': {
    allowedErrors: [notSignedIn],
    async run({ browser, page: before, settings }) {
      await signIn(before, settings);
      const { id, name } = await withModel(before);
      const wire = await wireTo(settings.url);
      const context = await browser.newContext({
        baseURL: wire.url,
        viewport: { width: 1440, height: 900 },
      });
      try {
        const page = await context.newPage();
        await page.goto(`/vessels/${id}`);
        await page.getByLabel('E-mail').fill(settings.email);
        await page.getByLabel('Password').fill(settings.password);
        await page.getByRole('button', { name: 'Sign in' }).click();
        await page.getByRole('heading', { name, level: 1 }).waitFor();
        await chart(page).scrollIntoViewIfNeeded();
        await curve(page).waitFor();
        console.log(`     ${wire.octets} octets until the curve is shown`);
        assert.ok(wire.octets >= leastOctets, `only ${wire.octets} octets crossed`);
        assert.ok(wire.octets <= mostOfVessel, `${wire.octets} octets crossed the wire`);
      } finally {
        await context.close();
        wire.close();
      }
    },
  },

  'who returns is brought what she needs along with her page, and each answer once': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
      await page.waitForFunction(() => navigator.serviceWorker.controller);
      const { id, name } = await withModel(page);
      await page.goto(`/vessels/${id}`);
      await page.getByRole('heading', { name, level: 1 }).waitFor();
      await page.getByTestId('needs').waitFor();
      const begun = await page.evaluate(() =>
        performance
          .getEntriesByType('resource')
          .map((entry) => [entry.initiatorType, new URL(entry.name).pathname]),
      );
      const hers = ['', '/needs'].map((part) => `/api/v1/vessels/${id}${part}`);
      for (const path of [...hers, '/api/v1/fleet', '/api/v1/work-orders', '/api/v1/alerts']) {
        const by = begun.filter(([, asked]) => asked === path).map(([initiator]) => initiator);
        // By what came with the page, before any of its files ran.
        assert.deepEqual(by, ['link'], `${path} was asked for by ${by}`);
      }
    },
  },

  'over 64 kbit/s and 1,500 ms a first visit comes without timing out': {
    serviceWorkers: 'block',
    allowedErrors: [notSignedIn, /Service Worker registration blocked/],
    async run({ page, settings }) {
      const session = await page.context().newCDPSession(page);
      await session.send('Network.enable');
      await session.send('Network.emulateNetworkConditions', {
        offline: false,
        latency: 1_500,
        downloadThroughput: 8_000,
        uploadThroughput: 8_000,
      });
      const begun = performance.now();
      page.setDefaultTimeout(120_000);
      page.setDefaultNavigationTimeout(120_000);
      await signIn(page, settings);
      await fleetIsShown(page);
      const seconds = (performance.now() - begun) / 1000;
      console.log(`     shown after ${seconds.toFixed(1)} s`);
      // 60 kB over such a link alone take longer than this.
      assert.ok(seconds > 7.5, 'the link was not slow');
      assert.equal(await page.getByRole('alert').count(), 0);
    },
  },
};
