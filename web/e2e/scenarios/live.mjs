/** The live connection: what is missed while it is cut is shown when it is back. */
import assert from 'node:assert/strict';
import { notSignedIn, signIn, withModel } from '../helpers.mjs';
import { wireTo } from '../wire.mjs';

export const live = {
  'what happened while the connection was cut is shown when it is back, without a reload': {
    async run({ browser, settings, shoot }) {
      const wire = await wireTo(settings.url);
      const context = await browser.newContext({ baseURL: wire.url });
      try {
        const page = await context.newPage();
        await signIn(page, settings);
        const { id } = await withModel(page);
        await page.goto(`/vessels/${id}/changes`);
        const logbook = page.getByRole('region', { name: 'Logbook' });
        await logbook.getByRole('button', { name: 'Report' }).waitFor();
        const banner = page.getByRole('banner');
        await banner.getByText('Live', { exact: true }).waitFor();
        await page.evaluate(() => (window.sameDocument = true));
        wire.cut();
        await banner.getByText('Not live').waitFor();
        // Past the relay, as from another desk.
        const answer = await page.request.post(`${settings.url}/api/v1/vessels/${id}/logbook`, {
          headers: { 'X-Binnacle-Request': '1' },
          data: { kind: 'note', from: new Date().toISOString(), note: 'While you were away' },
        });
        assert.ok(answer.ok(), await answer.text());
        assert.equal(await logbook.getByText('While you were away').count(), 0);
        // Said on the page too, when it lasts.
        await page.getByText(/^Not connected since \d\d:\d\d UTC\. /).waitFor();
        await shoot('not-live', {}, page);
        wire.mend();
        await banner.getByText('Live', { exact: true }).waitFor({ timeout: 40_000 });
        await logbook.getByText('While you were away').waitFor();
        assert.equal(await page.getByText(/^Not connected since/).count(), 0);
        assert.ok(await page.evaluate(() => window.sameDocument), 'the page was loaded anew');
      } finally {
        await context.close();
        wire.close();
      }
    },
  },

  'a page opened without a connection says so, and comes when there is one': {
    allowedErrors: [notSignedIn, /ERR_INTERNET_DISCONNECTED/],
    async run({ page, context, settings, shoot }) {
      await signIn(page, settings);
      await page.goto('/alerts');
      await page.getByRole('heading', { level: 1 }).waitFor();
      // The browser keeps what the page is made of, once it has taken over.
      await page.evaluate(() => navigator.serviceWorker.ready);
      await page.waitForFunction(async () => {
        const cache = await caches.open('binnacle-page-1');
        return (await cache.keys()).some((kept) => kept.url.includes('/assets/index'));
      });
      await context.setOffline(true);
      await page.reload();
      await page.getByText('nothing of this is kept here').waitFor();
      await page.getByRole('banner').getByText('Not live').waitFor();
      await shoot('no-connection');
      await context.setOffline(false);
      await page.getByText('nothing of this is kept here').waitFor({ state: 'detached' });
      await page.getByRole('banner').getByText('Live', { exact: true }).waitFor();
    },
  },
};
