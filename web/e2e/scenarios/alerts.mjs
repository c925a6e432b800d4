/** Alerts, who is told of them, and what changed. */
import assert from 'node:assert/strict';
import { findings } from '../axe.mjs';
import {
  phone,
  notSignedIn,
  signIn,
  goToVessel,
  withModel,
  struck,
  limit,
  fitsItsWidth,
} from '../helpers.mjs';

export const alerts = {
  'an alert comes live, is acknowledged and cleared': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: /^Alerts/ }).click();
      await page.getByRole('heading', { name: 'Alerts', level: 1 }).waitFor();
      const vessel = await withModel(page);
      // A limit that she surely exceeds; what follows comes through the live events.
      await limit(page, vessel.id, { deviation_deg: 1 });
      const card = page
        .getByRole('article')
        .filter({ hasText: `${vessel.name}: Deviation over the limit` });
      await card.getByText('over the limit of 1°').waitFor();
      await page.getByTestId('alert-badge').waitFor();
      await shoot('alerts', { fullPage: true });

      await card.getByRole('button', { name: 'Acknowledge' }).click();
      await card.getByLabel(/^Note/).fill('Azimuth taken');
      await card.getByRole('button', { name: 'Acknowledge the alert' }).click();
      await card.getByText('Acknowledged by Test Officer').waitFor();
      // The form took the focus with it.
      await page.waitForFunction(() => document.activeElement?.textContent?.trim() === 'Clear');
      await card.getByText('What shows it').click();
      await card.getByText('By the model of the samples').waitFor();
      await page.getByRole('link', { name: 'Binnacle', exact: true }).click();
      await page
        .getByRole('row')
        .filter({ hasText: vessel.name })
        .getByText('acknowledged')
        .waitFor();
      await shoot('vessels-alerts');
      await page.goBack();

      await card.getByRole('button', { name: 'Clear' }).click();
      await card.getByRole('button', { name: 'Clear the alert' }).click();
      await card.getByRole('alert').getByText('Say why it is over').waitFor();
      await card.getByLabel('Why it is over').fill('A test');
      await card.getByRole('button', { name: 'Clear the alert' }).click();
      await page.getByText('Cleared lately').click();
      await page
        .getByText(/^Cleared by Test Officer.*: A test$/)
        .first()
        .waitFor();
      await limit(page, vessel.id, { deviation_deg: 45 });
    },
  },

  'the inbox is filtered, which the address keeps': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await withModel(page);
      await limit(page, vessel.id, { deviation_deg: 1 });
      await page.goto('/alerts');
      const hers = page
        .getByRole('article')
        .filter({ hasText: `${vessel.name}: Deviation over the limit` });
      await hers.waitFor();
      const id = await hers.getAttribute('id');
      const all = await page.getByRole('article').count();

      await page.getByRole('searchbox', { name: 'Vessel' }).fill(vessel.name.toLowerCase());
      await page.getByLabel('Cause').selectOption({ label: 'Deviation over the limit' });
      await page.getByText(/^1 of \d+ open alerts$/).waitFor();
      await hers.waitFor();
      await page.getByLabel('State').selectOption({ label: 'Acknowledged' });
      const none = page.getByTestId('none-fits');
      await none.getByText(/^No open alert fits\. There (is one|are \d+): /).waitFor();
      assert.deepEqual(await findings(page), []);
      await shoot('alerts-none-fits');
      assert.match(page.url(), /\?q=.*&state=acknowledged&cause=deviation_over_limit$/);
      await page.reload();
      await none.waitFor();
      assert.equal(await page.getByLabel('State').inputValue(), 'acknowledged');

      // A link to an alert shows it, whatever was asked for.
      await page.evaluate((named) => (location.hash = named), id);
      await hers.waitFor();
      await page.getByLabel('State').selectOption({ label: 'Acknowledged' });
      await none.getByRole('button', { name: 'Show all alerts' }).press('Enter');
      await hers.waitFor();
      const focused = page.locator(':focus');
      assert.match(await focused.innerText(), /open alerts?/, 'the focus is not lost');
      assert.ok((await page.getByRole('article').count()) >= all);
      assert.equal(new URL(page.url()).search, '');
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('alerts-filter-phone');
      await limit(page, vessel.id, { deviation_deg: 45 });
    },
  },

  'from when on there are alerts is said on her page, and holds': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await withModel(page);
      const path = `/api/v1/vessels/${vessel.id}/settings`;
      const before = await (await page.request.get(path)).json();
      await goToVessel(page, vessel.id, '#limits');
      const panel = page.getByRole('region', { name: 'Alert limits and settings' });
      await panel.getByRole('button', { name: 'Change the settings' }).click();
      const deviation = panel.getByLabel('Deviation, °');
      await deviation.fill('0.5');
      await panel.getByRole('button', { name: 'Save the settings' }).click();
      await panel.getByRole('alert').getByText('“Deviation, °” is a number from 1 to 45').waitFor();
      assert.equal(await deviation.getAttribute('aria-invalid'), 'true');
      await deviation.fill('1,5');
      await fitsItsWidth(page);
      await shoot('limits', {}, panel);
      assert.deepEqual(await findings(page), []);
      await panel.getByRole('button', { name: 'Save the settings' }).click();
      await panel.getByText('The settings are saved.').waitFor();
      const { alerts, analysis } = await (await page.request.get(path)).json();
      assert.deepEqual(alerts, { ...before.alerts, deviation_deg: 1.5 });
      assert.deepEqual(analysis, before.analysis);
      await page.goto('/alerts');
      const card = page.getByRole('article').filter({ hasText: `${vessel.name}: Deviation over` });
      await card.getByText('over the limit of 1.5°').waitFor();
      // A link to it leads to it, when it is over too.
      const id = await card.getAttribute('id');
      await page.goto('/');
      await page.goto(`/alerts#${id}`);
      const isFocused = (id) => document.activeElement?.id === id;
      await page.waitForFunction(isFocused, id);
      await limit(page, vessel.id, { deviation_deg: 45 });
      await page.getByText('Cleared lately').waitFor();
      await card.waitFor({ state: 'hidden' });
      await page.goto('/');
      await page.goto(`/alerts#${id}`);
      await page.waitForFunction(isFocused, id);
      await shoot('alert-sought');
      await page.goto('/');
      await page.goto('/alerts#of-nobody');
      await page.getByText('neither open nor among those cleared lately').waitFor();
    },
  },

  'what the reader writes at an alert stays when the alert is over meanwhile': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await withModel(page);
      await limit(page, vessel.id, { deviation_deg: 1 });
      await page.getByRole('link', { name: /^Alerts/ }).click();
      const card = page
        .getByRole('article')
        .filter({ hasText: `${vessel.name}: Deviation over the limit` });
      await card.getByRole('button', { name: 'Clear' }).click();
      const field = card.getByLabel('Why it is over');
      await field.fill('Half a sentence');
      const titles = () => page.getByRole('article').getByRole('heading').allInnerTexts();
      const stood = await titles();
      assert.ok(stood.length > 1, `nothing lies about it: ${stood}`);
      await limit(page, vessel.id, { deviation_deg: 45 });
      await card.getByText(/^Over since/).waitFor();
      assert.equal(await field.inputValue(), 'Half a sentence');
      assert.deepEqual(await titles(), stood);
      assert.ok(await field.evaluate((element) => element === document.activeElement));
      assert.ok(await card.getByRole('button', { name: 'Clear the alert' }).isDisabled());
      await shoot('alert-over-meanwhile', {}, card);
      await card.getByRole('button', { name: 'Cancel' }).press('Enter');
      await card.waitFor({ state: 'detached' });
      await page.waitForFunction(() => document.activeElement?.textContent?.includes('open alert'));
    },
  },

  'alerts, reports and changes are dated by the clocks that the reader chose': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const { id, name, last_position: last } = await struck(page);
      const headers = { 'X-Binnacle-Request': '1' };
      const data = { kind: 'note', from: last.at, note: 'Dated where she was' };
      const path = `/api/v1/vessels/${id}/logbook`;
      const noted = await page.request.post(path, { headers, data });
      assert.ok(noted.ok(), await noted.text());
      await limit(page, id, { deviation_deg: 1 });
      const zone = Math.round(last.lon / 15);
      const by = (clocks) => {
        if (zone === 0) return /\d UTC$/;
        const hers = `UTC\\${zone < 0 ? '−' : '+'}${Math.abs(zone)}`;
        return clocks === 'ship' ? new RegExp(`\\d ${hers}$`) : new RegExp(`UTC \\(.*${hers}\\)$`);
      };
      const choose = async (label) => {
        await page.goto('/settings');
        await page.getByText(label, { exact: true }).click();
      };
      for (const [clocks, label] of [
        ['both', 'Both'],
        ['ship', 'Ship’s time'],
      ]) {
        await choose(label);
        await page.goto('/alerts');
        const card = page.getByRole('article').filter({ hasText: `${name}: Deviation over` });
        await card.locator('time').getByText(by(clocks)).waitFor();
        await shoot(`alerts-${clocks}`, {}, card.first());
        await page.goto(`/vessels/${id}/changes`);
        const entry = page.getByTestId('logbook').locator('li', { hasText: data.note });
        await entry.locator('.when').getByText(by(clocks)).waitFor();
        const line = page.getByTestId('timeline').locator('li', { hasText: 'Reported: ' });
        await line.first().locator('p.small').getByText(by(clocks)).waitFor();
        // Where lightning struck her is a zone of its own.
        const struckAt = page.getByTestId('timeline').locator('li', { hasText: 'Lightning' });
        const said = await struckAt.first().locator('p.when').innerText();
        assert.match(said, clocks === 'both' ? / UTC\b/ : / UTC([+−]\d+)?$/);
      }
      await choose('UTC');
      await page.goto(`/vessels/${id}/changes`);
      const entry = page.getByTestId('logbook').locator('li', { hasText: data.note });
      await entry
        .locator('.when')
        .getByText(/\d UTC$/)
        .waitFor();
      const { items } = await (await page.request.get(path)).json();
      const mine = items.find(({ note }) => note === data.note);
      await page.request.post(`${path}/${mine.id}/withdraw`, { headers, data: { reason: '' } });
      await limit(page, id, { deviation_deg: 45 });
    },
  },

  'a webhook is made, tested and removed': {
    allowedErrors: [notSignedIn, /status of 422 .*\/api\/v1\/webhooks\b/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: /^Alerts/ }).click();
      await page.getByRole('link', { name: 'Webhooks' }).click();
      await page.getByText('No program or chat hears of alerts yet').waitFor();
      await page.getByRole('button', { name: 'Add a webhook' }).click();
      const made = page.getByRole('button', { name: 'Make the webhook' });
      await made.click();
      await page.getByRole('alert').getByText('Enter an address').waitFor();
      await page.getByLabel('Address').fill('https://127.0.0.1/hook');
      await made.click();
      await page.getByRole('alert').getByText('not an address of the public internet').waitFor();
      // A name that no resolver knows: it is in no zone of the root.
      await page.getByLabel('Address').fill('https://hooks.not-in-the-root/binnacle');
      await made.click();
      await page.getByText(/^bns_/).waitFor();
      await page.getByRole('button', { name: 'Done' }).click();
      const card = page.getByRole('article').filter({ hasText: 'hooks.not-in-the-root' });
      await card.getByRole('button', { name: 'Send a test' }).click();
      await card.getByTestId('deliveries').getByText('waiting').waitFor();
      await card.getByTestId('deliveries').getByText('1 try').waitFor();
      await shoot('webhooks', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('webhooks-phone', { fullPage: true });
      await card.getByRole('button', { name: 'Remove' }).click();
      await card.getByRole('button', { name: 'Remove the webhook' }).click();
      await page.getByText('No program or chat hears of alerts yet').waitFor();
    },
  },

  'an address gets mail, a test, and no more': {
    allowedErrors: [notSignedIn, /status of 422 .*\/api\/v1\/mail-recipients\b/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: /^Alerts/ }).click();
      await page.getByRole('link', { name: 'Mail' }).click();
      await page.getByText('Nobody gets mail yet').waitFor();
      await page.getByRole('button', { name: 'Add an address' }).click();
      const add = page.getByRole('button', { name: 'Add the address' });
      await add.click();
      await page.getByRole('alert').getByText('Enter an address').waitFor();
      await page.getByRole('textbox', { name: 'Address' }).fill('bridge at example.com');
      await add.click();
      await page.getByRole('alert').getByText('is not an address').waitFor();
      await page.getByRole('textbox', { name: 'Address' }).fill('bridge@example.com');
      await page.getByRole('combobox', { name: 'Alerts' }).selectOption('notice');
      await add.click();
      const card = page.getByRole('article').filter({ hasText: 'bridge@example.com' });
      await card.getByText('All alerts').first().waitFor();
      await card.getByRole('combobox').selectOption('critical');
      await card.locator('p', { hasText: 'Critical alerts only' }).waitFor();
      await card.getByRole('button', { name: 'Send a test' }).click();
      await card.getByTestId('deliveries').getByText('waiting').waitFor();
      await card.getByTestId('deliveries').getByText('1 try').waitFor();
      await shoot('mail', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('mail-phone', { fullPage: true });
      await card.getByRole('button', { name: 'Remove' }).click();
      await card.getByRole('button', { name: 'Remove the address' }).click();
      await page.getByText('Nobody gets mail yet').waitFor();
    },
  },

  'a struck ship shows what changed, why, and the curve before and after': {
    viewport: { width: 1280, height: 900 },
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await struck(page);
      await goToVessel(page, vessel.id, '/changes');
      const changes = page.getByRole('region', { name: 'What changed' });
      const change = changes.getByRole('listitem').filter({ hasText: 'Lightning or a shock' });
      await change.first().waitFor();
      const said = await change.first().innerText();
      assert.match(said, /\d{1,2} [A-Z][a-z]{2} 20\d\d, \d\d:\d\d UTC/);
      assert.match(
        said,
        /Largest change of deviation, where the vessel was then\s+changed by \d+\.\d°/,
      );
      assert.match(
        said,
        /Permanent field fore-and-aft, forward positive\s+changed by [+−]\d\.\d ± \d\.\d\sµT/,
      );
      await shoot('changes-closed', {}, changes);

      await change.getByText('Why this cause').press('Enter');
      await change
        .getByText(/\d+ %, (all but certain|likely)/)
        .first()
        .waitFor();
      const show = change.getByRole('button', { name: /^Curve before and after/ });
      assert.equal(await show.getAttribute('aria-expanded'), 'false');
      await show.press('Enter');
      const picture = changes.getByTestId('compared-chart');
      await picture.scrollIntoViewIfNeeded();
      await picture.locator('svg [aria-label="line"] path').nth(1).waitFor();
      assert.equal(await picture.locator('svg [aria-label="area"] path').count(), 2);
      assert.match(
        await picture.getByRole('img').getAttribute('aria-label'),
        /part most, by \d+\.\d°, on \d{3}°/,
      );
      await changes.getByText('The curves as a table').press('Enter');
      const rows = changes.getByRole('table').getByRole('row');
      assert.equal(await rows.count(), 13);
      assert.match(await rows.nth(4).innerText(), /090°\s+\d+\.\d° [EW]\s+± \d/);
      await fitsItsWidth(page);
      await shoot('changes', {}, changes);
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('changes-phone', {}, changes);
      await page.emulateMedia({ colorScheme: 'dark' });
      await shoot('changes-phone-dark', {}, changes);
      await changes.getByRole('button', { name: 'Hide the curve' }).click();
      await picture.waitFor({ state: 'detached' });
    },
  },

  'a link to a change shows its curves, from another tab of the same page too': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      const vessel = await struck(page);
      const found = await page.request.get(`/api/v1/vessels/${vessel.id}/changes`);
      const { changes, compass_id: compass } = await found.json();
      const { from } = changes.find((change) => change.cause === 'lightning_or_shock');
      const named = new URLSearchParams({ compass, change: from });
      await goToVessel(page, vessel.id);
      await page.evaluate((path) => {
        window.stayed = true;
        const link = Object.assign(document.createElement('a'), { href: path });
        document.querySelector('main').append(link);
        link.click();
        link.remove();
      }, `/vessels/${vessel.id}/changes?${named}#changes`);
      const changed = page.getByRole('region', { name: 'What changed' });
      await changed.getByRole('button', { name: 'Hide the curve' }).waitFor();
      await changed.getByTestId('compared-chart').waitFor();
      assert.ok(await page.evaluate(() => window.stayed), 'the page was not loaded anew');
    },
  },

  'a ship to whom nothing happened says since when': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const { id: other } = await struck(page);
      const listed = await (await page.request.get('/api/v1/vessels')).json();
      const calm = listed.items.find((vessel) => vessel.model && vessel.id !== other);
      await goToVessel(page, calm.id, '/changes');
      const changes = page.getByRole('region', { name: 'What changed' });
      await changes.getByText(/^No change found since \d{1,2} [A-Z][a-z]{2} 20\d\d/).waitFor();
      await shoot('changes-none', {}, changes);
    },
  },

  'a phone shows the alerts, by night too': {
    viewport: phone,
    colorScheme: 'dark',
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await withModel(page);
      await limit(page, vessel.id, { deviation_deg: 1.5 });
      const badge = page.getByTestId('alert-badge-short');
      await badge.waitFor();
      await fitsItsWidth(page);
      await shoot('vessels-alerts-phone', { fullPage: true });
      await badge.click();
      await page.getByRole('article').first().waitFor();
      await fitsItsWidth(page);
      await shoot('alerts-phone', { fullPage: true });
      // The other ship's deviation is over the limit since lightning struck her.
      const listed = await (await page.request.get('/api/v1/vessels')).json();
      for (const { id } of listed.items) await limit(page, id, { deviation_deg: 45 });
      await page.getByTestId('no-alerts').waitFor();
      await shoot('no-alerts-phone', { fullPage: true });
    },
  },
};
