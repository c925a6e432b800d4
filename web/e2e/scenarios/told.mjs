/** What a superintendent is told, how, and what the month's report says. */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { fitsItsWidth, notSignedIn, phone, signIn } from '../helpers.mjs';

const invalid = /status of (400|422) .*\/(notifications|settings)/;

export const told = {
  'a superintendent says how to be told, and it is kept': {
    allowedErrors: [notSignedIn, invalid],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('banner').getByRole('link', { name: 'Notifications' }).click();
      await page.getByRole('heading', { name: 'Notifications', level: 1 }).waitFor();
      const form = page.getByRole('region', { name: 'How you are told' });
      await form.getByLabel('The adjuster is on board').selectOption('off');
      await form.getByLabel('Time zone').fill('Europe/Nowhere');
      const save = form.getByRole('button', { name: 'Save' });
      await save.click();
      await form.getByRole('alert').waitFor();
      await form.getByLabel('Time zone').fill('Europe/Madrid');
      await form.getByLabel(/^Digest/).selectOption('week');
      await form.getByLabel(/^On/).selectOption('friday');
      await form.getByLabel('Quiet hours: no mail').check();
      await form.getByLabel('From').fill('23:15');
      await save.click();
      await form.getByText('Saved.').waitFor();
      assert.equal(await form.getByRole('alert').count(), 0);
      await page.reload();
      await form.getByLabel('Time zone').waitFor();
      assert.equal(await form.getByLabel('Time zone').inputValue(), 'Europe/Madrid');
      assert.equal(await form.getByLabel('From').inputValue(), '23:15');
      assert.equal(await form.getByLabel(/^On/).inputValue(), 'friday');
      assert.equal(await form.getByLabel('The adjuster is on board').inputValue(), 'off');
      await fitsItsWidth(page);
      await shoot('notifications', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('notifications-phone', { fullPage: true });
    },
  },

  'an alert is told on the list, and marked as read there': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.goto('/notifications');
      const list = page.getByTestId('notifications');
      await list.getByRole('listitem').first().waitFor();
      await list.getByText('What it says').first().click();
      await list.getByText('Vessel: ').first().waitFor();
      const unread = async () =>
        (await (await page.request.get('/api/v1/notifications')).json()).unread;
      const before = await unread();
      assert.ok(before > 0, 'nothing is unread');
      const bell = page.getByTestId('unread-badge');
      await bell.getByText(String(before)).waitFor();
      await list
        .getByRole('button', { name: /^Mark as read/ })
        .first()
        .click();
      await page
        .getByRole('status')
        .getByText(`${before - 1} unread`, { exact: true })
        .waitFor();
      assert.equal(await unread(), before - 1);
      const left = before === 1 ? 0 : await bell.innerText();
      assert.equal(parseInt(left, 10), before - 1);
      await list.getByRole('link').first().click();
      await page.waitForURL((url) => url.pathname !== '/notifications');
      await page.getByRole('heading', { level: 1 }).waitFor();
      assert.equal(await page.getByText('Nothing here').count(), 0);
    },
  },

  'the settings’ pages lead to each other': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.getByRole('banner').getByRole('link', { name: 'Settings' }).click();
      const tabs = page.getByRole('navigation', { name: 'Settings' });
      for (const title of ['Mail', 'Webhooks', 'People', 'Mail']) {
        await tabs.getByRole('link', { name: title }).click();
        await page.getByRole('heading', { name: title, level: 1 }).waitFor();
        assert.equal(await tabs.locator('[aria-current=page]').innerText(), title);
      }
    },
  },

  'the report says what is due, how bad it is, and what was saved': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('banner').getByRole('link', { name: 'Reports' }).click();
      await page.getByTestId('saved').waitFor();
      const vessels = (await (await page.request.get('/api/v1/vessels')).json()).items.length;
      const deviations = page.getByTestId('report-deviation').locator('tbody tr');
      assert.ok((await deviations.count()) >= vessels);
      await page.getByText('This is no certificate').waitFor();
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('link', { name: 'Greatest deviation as CSV' }).click(),
      ]);
      const csv = await readFile(await download.path(), 'utf8');
      assert.equal(csv.trim().split('\n').length, 1 + (await deviations.count()));
      const [pdf] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('link', { name: 'PDF' }).click(),
      ]);
      assert.equal((await readFile(await pdf.path())).subarray(0, 5).toString(), '%PDF-');

      await page.getByLabel('From').fill('2026-02-01');
      await page.getByLabel('To, included').fill('2026-01-01');
      await page.getByRole('button', { name: 'Show' }).click();
      await page.getByRole('alert').getByText('must not be after').waitFor();

      const form = page.getByRole('region', { name: /^What is reckoned with/ });
      await form.getByLabel(/^A swing costs/).fill('dear');
      await form.getByRole('button', { name: 'Save' }).click();
      await form.getByRole('alert').getByText('This is no number').waitFor();
      await form.getByLabel(/^A swing costs/).fill('7500');
      await form.getByLabel(/^Each month/).fill('superintendent@test.example');
      await form.getByRole('button', { name: 'Save' }).click();
      await page.getByText(/A swing is reckoned with €\s7\s500/).waitFor();
      await fitsItsWidth(page);
      await shoot('report', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('report-phone', { fullPage: true });
    },
  },
};
