/** Which ships need someone today: the map, the table and the views of them. */
import assert from 'node:assert/strict';
import { fitsItsWidth, notSignedIn, phone, signIn } from '../helpers.mjs';

const names = (page) => page.getByRole('rowheader').getByRole('link').allInnerTexts();
const map = (page) => page.getByRole('application', { name: 'Map of the fleet' });
const chosenRow = (page) => page.locator('tr[aria-current="true"]');

export const fleet = {
  'the fleet stands on the map and in the table': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('rowheader').first().waitFor();
      await page.locator('path.land').first().waitFor({ state: 'attached' });
      assert.ok((await page.locator('path.mark').count()) > 0);
      await shoot('fleet');

      // The most urgent vessel comes first, and says why.
      const first = page.getByRole('row').nth(1);
      await first.getByText(/Warning|Critical|Notice/).waitFor();

      await page.getByLabel('Search').fill('no such ship');
      await page.getByText('No vessel fits').waitFor();
      await page.getByRole('button', { name: 'Show all vessels' }).click();
      const all = await names(page);
      assert.ok(all.length > 1);

      await page.getByRole('button', { name: 'Vessel', exact: true }).click();
      const sorted = await names(page);
      assert.deepEqual(sorted, [...all].sort());
      await page.getByRole('button', { name: 'Vessel', exact: true }).click();
      assert.deepEqual(await names(page), sorted.toReversed());
      assert.match(page.url(), /sort=name/);
    },
  },

  'the map chooses a row, by pointer and by keys': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await map(page).focus();
      await page.keyboard.press('ArrowRight');
      await chosenRow(page).waitFor();
      const byKey = await chosenRow(page).getByRole('link').innerText();
      await page.getByRole('status').filter({ hasText: byKey }).waitFor({ state: 'attached' });
      await page.keyboard.press('Escape');
      await chosenRow(page).waitFor({ state: 'detached' });

      // Where a mark is on the screen, there a click chooses its vessel.
      const at = await page.evaluate(() => {
        const path = [...document.querySelectorAll('path.mark')].find((p) => p.getAttribute('d'));
        const point = path.getPointAtLength(0);
        const { x, y } = point.matrixTransform(path.getScreenCTM());
        return { x, y };
      });
      await page.mouse.click(at.x, at.y);
      await chosenRow(page).waitFor();
      await map(page).focus();
      await page.keyboard.press('Enter');
      await page.waitForURL(/\/vessels\//);
    },
  },

  'a view is saved and comes back': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.getByRole('combobox', { name: /^Show/ }).selectOption('large');
      await page.getByRole('button', { name: 'Save view…' }).click();
      await page.getByLabel('Name of the view').fill('Over five');
      await page.getByRole('button', { name: 'Save', exact: true }).click();
      await page.getByLabel('Saved views').selectOption('');
      assert.equal(await page.getByRole('combobox', { name: /^Show/ }).inputValue(), 'all');
      await page.reload();
      await page.getByLabel('Saved views').selectOption('Over five');
      assert.equal(await page.getByRole('combobox', { name: /^Show/ }).inputValue(), 'large');
      await page.getByRole('button', { name: 'Remove the view “Over five”' }).click();
      await page.getByLabel('Saved views').waitFor({ state: 'detached' });
    },
  },

  'a phone shows the fleet as cards, and folds the map': {
    viewport: phone,
    colorScheme: 'dark',
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('rowheader').first().waitFor();
      await fitsItsWidth(page);
      await shoot('fleet-phone', { fullPage: true });
      await page.getByRole('button', { name: 'Map', exact: true }).click();
      await map(page).waitFor({ state: 'hidden' });
      await page.reload();
      await page.getByRole('rowheader').first().waitFor();
      assert.equal(await map(page).isVisible(), false);
      await page.getByLabel('Sort by').selectOption('name');
      assert.match(page.url(), /sort=name/);
    },
  },
};
