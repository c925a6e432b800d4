/** What a slow and dear link carries before the fleet can be seen. */
import assert from 'node:assert/strict';
import { notSignedIn, signIn } from '../helpers.mjs';

/** The fleet's page, coasts and data included, compressed as it crosses the wire. */
const mostOctets = 200_000;

/** Counts what crosses the wire from now on: headers, bodies, everything. */
export async function counted(page) {
  const session = await page.context().newCDPSession(page);
  const requests = new Map();
  await session.send('Network.enable');
  session.on('Network.responseReceived', ({ requestId, response }) => {
    requests.set(requestId, { url: response.url, octets: response.encodedDataLength });
  });
  session.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => {
    const request = requests.get(requestId);
    if (request) request.octets = encodedDataLength;
  });
  return {
    session,
    requests,
    octets: () => [...requests.values()].reduce((sum, { octets }) => sum + octets, 0),
  };
}

export const fleetIsShown = async (page, timeout) => {
  await page.getByRole('rowheader').first().waitFor({ timeout });
  await page.locator('path.mark[d^="M"]').first().waitFor({ state: 'attached', timeout });
  await page.locator('path.land[d^="M"]').first().waitFor({ state: 'attached', timeout });
};

export const link = {
  'the whole first load of the fleet is at most 200 kB on the wire': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      const wire = await counted(page);
      await wire.session.send('Network.clearBrowserCache');
      await page.reload();
      await fleetIsShown(page);
      await page.waitForTimeout(500);
      const { octets } = wire;
      console.log(`     ${octets()} octets in ${wire.requests.size} answers`);
      assert.ok(wire.requests.size > 4, 'the wire was not watched');
      assert.ok(
        octets() <= mostOctets,
        [...wire.requests.values()].map((r) => `${r.url} ${r.octets}`).join('\n'),
      );
    },
  },

  'over 64 kbit/s and 1,500 ms the fleet comes without timing out': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      const { session } = await counted(page);
      await session.send('Network.clearBrowserCache');
      await session.send('Network.emulateNetworkConditions', {
        offline: false,
        latency: 1_500,
        downloadThroughput: 8_000,
        uploadThroughput: 8_000,
      });
      const begun = performance.now();
      page.setDefaultNavigationTimeout(120_000);
      await page.reload({ waitUntil: 'commit' });
      await fleetIsShown(page, 120_000);
      console.log(`     shown after ${((performance.now() - begun) / 1000).toFixed(1)} s`);
      assert.equal(await page.getByRole('alert').count(), 0);
    },
  },
};
