/** Which ships need someone today: the map, the table and the views of them. */
import assert from 'node:assert/strict';
import {
  fitsItsWidth,
  fleetIsShown,
  notSignedIn,
  phone,
  signIn,
  goToVessel,
  openTab,
  withModel,
} from '../helpers.mjs';

const names = (page) => page.getByRole('rowheader').getByRole('link').allInnerTexts();
const map = (page) => page.getByRole('application', { name: 'Map of the fleet' });
/** Requests for pages of the fleet, not for one vessel of it. */
const wholeFleet = /\/api\/v1\/fleet\?limit=/;
/** How many pixels each mark's middle lies within the map; negative where it is off it. */
const marksWithin = (page) =>
  page.evaluate(() => {
    const box = document.querySelector('[role=application]').getBoundingClientRect();
    return [...document.querySelectorAll('path.mark:not(.under)')].flatMap((path) =>
      [...(path.getAttribute('d') ?? '').matchAll(/M(\S+) (\S+?)h0/g)].map(([, x, y]) => {
        const at = new DOMPoint(Number(x), Number(y)).matrixTransform(path.getScreenCTM());
        const [right, below] = [box.right - at.x, box.bottom - at.y];
        return Math.round(Math.min(at.x - box.left, right, at.y - box.top, below));
      }),
    );
  });
/** Far from each other: Callao, Cape Town, Gothenburg, the Coral Sea, New Zealand. */
const farApart = [
  [-12, -77.2],
  [-33.9, 18.4],
  [57.7, 11.9],
  [-16, 160],
  [-46, 170],
];
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

  'the whole fleet is on the map, with room around it, on every screen': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await page.route(wholeFleet, async (route) => {
        const response = await route.fetch();
        const body = await response.json();
        const [vessel] = body.vessels.filter(({ position }) => position);
        const vessels = farApart.map(([lat, lon], i) => ({
          ...vessel,
          id: i === 0 ? vessel.id : crypto.randomUUID(),
          name: `Ship ${i + 1}`,
          position: { ...vessel.position, lat, lon },
          track: [],
        }));
        await route.fulfill({ response, json: { ...body, vessels } });
      });
      await signIn(page, settings);
      await page.getByRole('rowheader').first().waitFor();
      const sizes = [
        [1440, 900],
        [1024, 768],
        [3840, 2160],
        [390, 844],
        [320, 640],
        [900, 700],
        [1920, 1080],
      ];
      for (const [width, height] of sizes) {
        await page.setViewportSize({ width, height });
        // The map is told how large it is after the page was laid out.
        const least = 20;
        const inView = async () => {
          const within = await marksWithin(page);
          return within.length === farApart.length && Math.min(...within) >= least;
        };
        for (let tries = 0; tries < 60 && !(await inView()); tries++) {
          await page.evaluate(() => new Promise(requestAnimationFrame));
        }
        assert.ok(await inView(), `at ${width} × ${height}: ${await marksWithin(page)} px`);
      }
      await shoot('fleet-far-apart');
    },
  },

  'a row leads in one click to what is to be done': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      const needs = page.locator('td[data-label="Needs"]');
      const alert = needs.getByRole('link', { name: 'Deviation over the limit' }).first();
      await alert.click();
      await page.waitForURL(/\/alerts#/);
      await page.goBack();
      await page.getByRole('combobox', { name: /^Show/ }).selectOption('attention');
      const due = needs.getByRole('link', { name: /^(not scheduled|no adjustment on record)$/ });
      await due.first().click();
      await page.waitForURL(/\/(schedule#|vessels\/)[0-9a-f-]{36}$/);
    },
  },

  'what is due and could not be found out is not shown as nothing': {
    allowedErrors: [notSignedIn, /status of 500 .*needs/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByText(/ · \d+ needs? attention/).waitFor();
      const { id } = await withModel(page);
      const problem = { type: 'https://binnacle.example/problems/internal', status: 500 };
      await page.route(/\/needs\b/, (route) =>
        route.fulfill({
          status: 500,
          contentType: 'application/problem+json',
          body: JSON.stringify(problem),
        }),
      );
      await page.goto('/');
      await page.getByText('Which compasses are due could not be found out').waitFor();
      const needs = await page
        .getByRole('cell')
        .filter({ hasText: /^nothing$/ })
        .count();
      assert.equal(needs, 0, 'a vessel of which it is not known needs nothing');
      await shoot('fleet-dues-unknown');
      await goToVessel(page, id);
      await page.getByText('What is needed could not be found out in full').waitFor();
      await page.unrouteAll();
      await page.getByRole('button', { name: 'Try again' }).click();
      await page.getByText('What is needed could not be found out').waitFor({ state: 'detached' });
    },
  },

  'on paper the fleet is a table that says of when it is': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await fleetIsShown(page);
      // A sheet of A4 is this wide.
      await page.setViewportSize({ width: 718, height: 1000 });
      await page.emulateMedia({ media: 'print' });
      assert.equal(
        await page
          .getByRole('row')
          .nth(1)
          .evaluate((row) => getComputedStyle(row).display),
        'table-row',
      );
      await page.getByText(/^As of \d+ \w{3} \d{4}, \d\d:\d\d UTC$/).waitFor();
      await fitsItsWidth(page);
      await shoot('fleet-on-paper', { fullPage: true });
    },
  },

  'a vessel that is sold leaves the fleet, and may come back': {
    allowedErrors: [notSignedIn, /status of 404 .*\/(model|deviation)\b/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const name = 'Sold Ship';
      await page.getByRole('button', { name: 'Add a vessel' }).click();
      await page.getByLabel('Name', { exact: true }).fill(name);
      await page.getByRole('button', { name: 'Add vessel' }).click();
      await page.getByRole('rowheader').getByRole('link', { name }).click();
      await openTab(page, 'Settings');
      const particulars = page.getByRole('region', { name: 'Particulars' });
      await particulars.getByRole('button', { name: 'Take her out of service…' }).click();
      await shoot('vessel-out-of-service-asked');
      await particulars.getByRole('button', { name: 'Take her out of service' }).click();
      await page.getByText(/^Out of service since/).waitFor();
      await shoot('vessel-out-of-service');

      await openTab(page, 'Overview');
      await page.getByText('nothing is due').waitFor();

      await page.getByRole('link', { name: '← Fleet' }).click();
      await page.getByRole('rowheader').first().waitFor();
      assert.ok(!(await names(page)).includes(name));
      await page.getByText('Vessels out of service').click();
      await page.getByRole('listitem').getByRole('link', { name }).click();
      await openTab(page, 'Settings');
      await particulars.getByRole('button', { name: 'Take her back into service' }).click();
      await particulars.getByRole('button', { name: 'Take her out of service…' }).waitFor();
      assert.equal(await page.getByText(/^Out of service since/).count(), 0);
      // The other scenarios' fleet is without her.
      await particulars.getByRole('button', { name: 'Take her out of service…' }).click();
      await particulars.getByRole('button', { name: 'Take her out of service' }).click();
      await page.getByText(/^Out of service since/).waitFor();
    },
  },

  'a band stands on one line, and the search knows no accents': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await page.route(wholeFleet, async (route) => {
        const response = await route.fetch();
        const body = await response.json();
        const vessels = body.vessels.map((vessel) => ({
          ...vessel,
          name: `Östersjön ${vessel.name}`,
          next_call: {
            port: 'NLRTM',
            port_name: 'Rotterdam',
            eta: new Date(Date.now() + 86_400_000).toISOString(),
            etd: new Date(Date.now() + 172_800_000).toISOString(),
            worst: vessel.worst && { ...vessel.worst, deviation_deg: -22.5 },
          },
        }));
        await route.fulfill({ response, json: { ...body, vessels } });
      });
      await signIn(page, settings);
      const band = page.getByRole('row').getByText(/\(95 %\)$/);
      await band.first().waitFor();
      for (const one of await band.all()) {
        const lines = await one.evaluate((node) => node.getClientRects().length);
        assert.equal(lines, 1, 'the band is broken in two');
      }
      // As little as this is read without a line for each word.
      const needs = await page.locator('td[data-label="Needs"]').first().boundingBox();
      assert.ok(needs.width >= 200, `the needs have ${needs.width} px`);
      for (const width of [320, 768, 961, 1024, 1399, 1400, 1440, 1920]) {
        await page.setViewportSize({ width, height: 900 });
        const cut = await page
          .getByRole('table', { name: 'Vessels' })
          .evaluate(({ parentElement: list }) => list.scrollWidth - list.clientWidth);
        assert.ok(cut <= 0, `${cut} px of the table are beyond its edge at ${width} px`);
      }
      const all = await names(page);
      await page.getByLabel('Search').fill('ostersjon');
      assert.deepEqual(await names(page), all);
      await page.getByLabel('Search').fill('ostersjoner');
      await page.getByText('No vessel fits').waitFor();
    },
  },

  'a vessel that was added meanwhile comes without a reload': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      let added = false;
      await page.route(wholeFleet, async (route) => {
        const response = await route.fetch();
        const body = await response.json();
        const [vessel] = body.vessels;
        const another = { ...vessel, id: crypto.randomUUID(), name: 'Added Meanwhile' };
        const vessels = added ? [...body.vessels, another] : body.vessels;
        await route.fulfill({ response, json: { ...body, vessels } });
      });
      await page.clock.install();
      await signIn(page, settings);
      await page.getByRole('rowheader').first().waitFor();
      added = true;
      await page.clock.fastForward('06:00');
      await page.getByRole('link', { name: 'Added Meanwhile' }).waitFor();
    },
  },

  'the map chooses a row, by pointer and by keys': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await map(page).focus();
      await page.keyboard.press('ArrowRight');
      await chosenRow(page).waitFor();
      const byKey = await chosenRow(page).getByRole('rowheader').getByRole('link').innerText();
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
