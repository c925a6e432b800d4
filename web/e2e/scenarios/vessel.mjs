/** A vessel: her curve, her cargo, her agents. */
import assert from 'node:assert/strict';
import {
  phone,
  notSignedIn,
  signIn,
  goToVessel,
  openVessel,
  openTab,
  chart,
  curve,
  fitsItsWidth,
  struck,
} from '../helpers.mjs';

/** How many dots a chart has. */
const dots = (picture) =>
  picture.locator('svg .dots path').evaluateAll(
    (paths) =>
      paths
        .map((path) => path.getAttribute('d'))
        .join('')
        .match(/M/g)?.length,
  );

export const vessel = {
  'an officer signs in, opens a vessel and sees the curve with its samples': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page
        .getByRole('banner')
        .getByText(/^Live$/)
        .waitFor();
      await shoot('vessels');
      await openVessel(page);

      const path = await curve(page).getAttribute('d');
      assert.ok(path.length > 500, 'the curve has points all round');
      assert.ok(!/NaN/.test(path), 'the curve has no hole');
      await chart(page).locator('svg [aria-label="area"] path').first().waitFor();
      await chart(page).locator('svg .dots path').first().waitFor({ state: 'attached' });
      assert.ok((await dots(chart(page))) > 100, 'the samples are drawn');
      assert.match(
        await chart(page).getByRole('img').getAttribute('aria-label'),
        /° [EW] on \d{3}°/,
      );
      assert.match(await page.getByTestId('worst').innerText(), /^\d+\.\d° [EW]$|^0\.0°$/);

      await openTab(page, 'Deviation');
      const rows = page.getByTestId('deviation-table').locator('tbody tr');
      assert.equal(await rows.count(), 24);
      for (const [index, start] of [
        [0, '000°'],
        [12, '180°'],
        [23, '345°'],
      ]) {
        const row = await rows.nth(index).innerText();
        assert.ok(row.startsWith(start), `row ${index} is ${row}`);
        assert.match(row, /\d+\.\d°( [EW])?\s+± \d+\.\d°\s+\d{3}\.\d°/);
      }

      const rose = page.getByTestId('coverage-rose');
      assert.match(await rose.getAttribute('aria-label'), /^Samples by compass heading/);
      assert.ok((await rose.locator('path.cell').count()) >= 24, 'the rose has its sectors');
      await page.getByTestId('coverage-table').waitFor();
      const advice = await page.getByTestId('sail-next').innerText();
      assert.match(advice, /(would narrow the band|narrows the band by more than) .*\d\.\d/);
      const trust = page.getByRole('region', { name: 'How far to trust the curve' });
      const trusted = await trust.innerText();
      assert.match(trusted, /In these waters\s+±\s\d+\.\d°\s+(at worst, on \d{3}°|on every)/);
      assert.match(trusted, /In other waters, up to\s+±\s\d+\.\d°/);
      assert.match(trusted, /samples, worth \d+ with independent errors/);
      assert.match(trusted, /Gyro and satellite compass\s+\d\.\d° apart|Only one/);
      assert.equal(
        await trust
          .getByRole('row')
          .filter({ hasText: /\bhere\b/ })
          .count(),
        1,
      );
      await shoot('trust', {}, trust);
      const magnetism = page.getByRole('region', { name: 'The ship’s magnetism' });
      const parameters = magnetism.getByRole('row');
      assert.equal(await parameters.count(), 9);
      assert.match(
        await parameters.nth(1).innerText(),
        /Permanent fore-and-aft magnetism[^]*± \d+\.\d\d\sµT[^]*(her own|ships at large)/,
      );
      await magnetism.getByText('What some are known for only together').press('Enter');
      await magnetism.getByText('Headings cannot tell the constant from A').waitFor();
      await shoot('parameters', {}, magnetism);
      await page.getByRole('heading', { name: 'Coefficients' }).waitFor();
      await fitsItsWidth(page);
      await shoot('vessel', { fullPage: true });

      await openTab(page, 'Changes');
      const residuals = page.getByTestId('residual-chart');
      await residuals.waitFor();
      assert.equal(await residuals.locator('svg').count(), 0, 'drawn only when it is near');
      await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
      await residuals.locator('svg').first().waitFor();
      assert.ok((await dots(residuals)) > 100, 'on paper it is drawn all the same');
      await openTab(page, 'Agent');
      await page.getByText('accepted', { exact: true }).first().waitFor();
    },
  },

  'the page says what to do first, and each tab has its address, on a phone and by keys': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
      const now = page.getByTestId('now');
      const said = await now.boundingBox();
      assert.ok(said.y + said.height < phone.height, 'what to do is on the first screen');
      await shoot('vessel-now-phone');
      const tabs = page.getByRole('navigation', { name: 'About the vessel' });
      assert.equal(await tabs.getByRole('link').count(), 6);
      const path = new URL(page.url()).pathname;
      await tabs.getByRole('link', { name: 'Changes' }).focus();
      await page.keyboard.press('Enter');
      await page.waitForURL(`**${path}/changes`);
      // The keyboard stays where it was, and Tab leads on.
      assert.equal(await page.evaluate(() => document.activeElement?.dataset.tab), 'changes');
      await page.getByRole('region', { name: 'Deviation over time' }).waitFor();
      await page
        .getByRole('navigation', { name: 'On this page' })
        .getByRole('link', { name: 'Logbook' })
        .click();
      await page.waitForFunction(() => {
        const { bottom } = document
          .querySelector('nav[aria-label="About the vessel"]')
          .getBoundingClientRect();
        const { top } = document.getElementById('logbook').getBoundingClientRect();
        return top >= bottom && top < innerHeight / 2;
      });
      await page.goBack();
      await page.goBack();
      await page.waitForURL(`**${path}`);
      await page.getByRole('region', { name: 'Needs' }).waitFor();
      // Addresses from before the tabs lead to the tab that has the panel.
      await page.goto(`${path}#binnacle`);
      await page.waitForURL(`**${path}/adjustment#binnacle`);
      await page.getByRole('region', { name: 'Binnacle and correctors' }).waitFor();
      await fitsItsWidth(page);
    },
  },

  'the deviation is shown for another place': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      const before = await curve(page).getAttribute('d');
      await page.getByRole('button', { name: 'Choose another place' }).click();
      await page.getByLabel('Latitude', { exact: true }).fill('95 N');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await page.getByRole('alert').filter({ hasText: 'Latitude' }).waitFor();
      await page.getByLabel('Latitude', { exact: true }).fill('62 30.5 N');
      await page.getByLabel('Longitude').fill('005 12 E');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await page.getByText('At 62° 30.5′ N, 005° 12.0′ E', { exact: false }).first().waitFor();
      assert.notEqual(await curve(page).getAttribute('d'), before);
      const trust = page.getByTestId('trust');
      await trust.getByText('At the place chosen').waitFor();
      // North of where ships usually sail: no row of the table is hers.
      assert.equal(
        await trust
          .getByRole('row')
          .filter({ hasText: /\bhere\b/ })
          .count(),
        0,
      );
      await page.waitForURL(/[?&]lat=62\.5083&lon=5\.2&at=/);
      await page.reload();
      await page.getByText('At 62° 30.5′ N, 005° 12.0′ E', { exact: false }).first().waitFor();
      await page.getByRole('button', { name: 'Back to the last position' }).click();
      await page.waitForURL((url) => url.search === '');
    },
  },

  'the ship is dragged on the map, and curve, worst deviation and card follow': {
    allowedErrors: [notSignedIn, /status of 409 .*\/card\.json/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      await curve(page).waitFor();
      const panel = page.getByRole('region', { name: 'Deviation', exact: true });
      const card = page.getByRole('region', { name: 'Deviation card' });
      await card.getByRole('button', { name: 'Make the card' }).click();
      await card.getByTestId('card').waitFor();
      const before = await curve(page).getAttribute('d');
      const worst = panel.getByTestId('worst-there');
      const here = await worst.innerText();
      const ship = panel.getByTestId('ship');
      await ship.scrollIntoViewIfNeeded();
      const from = await ship.boundingBox();
      await page.mouse.move(from.x + 22, from.y + 22);
      await page.mouse.down();
      await page.mouse.move(from.x + 10, from.y - 30, { steps: 3 });
      // Before she is let go.
      await panel.getByRole('button', { name: 'Choose another place' }).waitFor();
      await page.waitForFunction(
        ([was]) => !document.querySelector('[data-testid=worst-there]').innerText.includes(was),
        [here],
      );
      await page.mouse.up();
      await worst.getByText('Largest deviation there').waitFor();
      const to = await ship.boundingBox();
      assert.ok(Math.abs(to.y - (from.y - 52)) < 6, 'she is where she was let go');
      assert.notEqual(await curve(page).getAttribute('d'), before);
      await card.getByText('For the place and day chosen above').waitFor();
      await card.getByTestId('card').or(card.getByRole('alert')).waitFor();

      const place = panel.getByText(/^At \d\d° /).first();
      const dragged = await place.innerText();
      await ship.focus();
      await page.keyboard.press('ArrowDown');
      await page.keyboard.press('Shift+ArrowLeft');
      await page.waitForFunction(
        (was) => ![...document.querySelectorAll('#deviation p')].some((p) => p.innerText === was),
        dragged,
      );
      await shoot('vessel-elsewhere', {}, panel);
      await panel.getByRole('button', { name: 'Back to the last position' }).click();
      await worst.getByText('Largest deviation where she is').waitFor();
      assert.equal(await curve(page).getAttribute('d'), before);
    },
  },

  'a strike is a step in the deviation over time, with what happened on one axis, by keys too': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const hit = await struck(page);
      await page.goto(`/vessels/${hit.id}/changes`);
      const panel = page.getByRole('region', { name: 'Deviation over time' });
      const drawn = panel.getByTestId('history-chart');
      assert.match(await drawn.getByRole('img').getAttribute('aria-label'), /with one change\./);
      await panel.getByText('Deviation as a table').press('Enter');
      const epochs = panel.getByRole('table', { name: /Deviation on each heading/ });
      const east = (row) => epochs.getByRole('row').nth(row).getByRole('cell').nth(3).innerText();
      const [before, after] = [await east(1), await east(2)].map(
        (cell) => parseFloat(cell) * (/ W/.test(cell) ? -1 : 1),
      );
      assert.ok(Math.abs(after - before) > 1, `on 090° ${before} and then ${after}`);
      await panel.getByRole('button', { name: '060°' }).click();
      await epochs.getByRole('columnheader', { name: '060°' }).waitFor();
      const lanes = panel.getByTestId('time-lanes');
      const epoch = lanes.getByRole('button', { name: /^Epoch 1, / });
      await epoch.focus();
      await page.keyboard.press('ArrowRight');
      await panel.getByRole('status').getByText('Epoch 2').waitFor();
      await page.keyboard.press('ArrowDown');
      const said = panel.getByRole('status');
      await said.getByText('Lightning or a shock').waitFor();
      assert.match(await said.innerText(), /Nov|UTC/);
      await panel.getByText('What happened as a table').press('Enter');
      await panel
        .getByRole('row')
        .filter({ hasText: /Lightning or a shock\s*Change/ })
        .waitFor();
      await fitsItsWidth(page);
      await shoot('vessel-time', {}, panel);
    },
  },

  'times are written by the clocks that the reader chose': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      const { id, last_position: last } = await struck(page);
      const zone = Math.round(last.lon / 15);
      const position = page.locator('dl').first().locator('div', { hasText: 'Last position' });
      await page.goto(`/vessels/${id}`);
      // Both at first; where her clocks show UTC there is nothing to add.
      await position.getByText(zone === 0 ? /UTC$/ : /UTC \(.*UTC[+−]\d+\)$/).waitFor();
      await page.goto('/settings');
      await page.getByText('Ship’s time', { exact: true }).click();
      await page.getByText(/two hours ahead: .*, \d\d:\d\d UTC\+2\. /).waitFor();
      await page.goto(`/vessels/${id}`);
      await position.getByText(zone === 0 ? /\d UTC$/ : /\d UTC[+−]\d+$/).waitFor();
    },
  },

  'on paper what happened ends where the chart above it does': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const { id } = await struck(page);
      await page.goto(`/vessels/${id}#history`);
      await page.getByTestId('time-lanes').getByRole('listitem').first().waitFor();
      // Sheets and their margins differ; how wide a panel is on one, only the printer knows.
      for (const width of [560, 718, 760]) {
        await page.setViewportSize({ width, height: 1000 });
        await page.emulateMedia({ media: 'print' });
        await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
        const right = (found) =>
          found.evaluateAll((all) =>
            Math.max(...all.map((node) => node.getBoundingClientRect().right)),
          );
        const chart = page.getByTestId('history-chart').locator('svg');
        await chart.first().waitFor();
        const chartEnds = await right(chart);
        const lanesEnd = await right(page.getByTestId('time-lanes').getByRole('listitem'));
        assert.ok(
          lanesEnd <= chartEnds && lanesEnd > chartEnds - 40,
          `at ${width} px the lanes end at ${lanesEnd}, the chart at ${chartEnds}`,
        );
        await fitsItsWidth(page);
        await shoot(`history-on-paper-${width}`, {}, page.locator('#history'));
        await page.evaluate(() => dispatchEvent(new Event('afterprint')));
        await page.emulateMedia({ media: 'screen' });
      }
    },
  },

  'on a slow phone nothing moves once it is there': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      const { id } = await struck(page);
      // Alerts, needs, orders and the fleet's line of her come in whatever order.
      let late = 0;
      await page.route(
        /\/api\/v1\/(alerts|fleet|work-orders|vessels\/[^/]+\/needs)\b/,
        async (route) => {
          late += 250;
          await new Promise((done) => setTimeout(done, late));
          await route.continue();
        },
      );
      await page.addInitScript(() => {
        window.moved = 0;
        new PerformanceObserver((seen) => {
          for (const { value, hadRecentInput } of seen.getEntries())
            if (!hadRecentInput) window.moved += value;
        }).observe({ type: 'layout-shift', buffered: true });
      });
      await page.goto(`/vessels/${id}`);
      await chart(page).waitFor({ state: 'attached' });
      assert.ok(late > 0, 'nothing came late');
      const moved = await page.evaluate(() => window.moved);
      assert.ok(moved < 0.005, `the layout shifted by ${moved}`);
    },
  },

  'cargo is reported, discharged and withdrawn': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Changes');
      const logbook = page.getByRole('region', { name: 'Logbook' });
      await logbook.getByText('Nothing has been reported yet').waitFor();
      await shoot('logbook-empty', {}, logbook);

      await logbook.getByRole('button', { name: 'Report' }).click();
      await logbook.getByRole('combobox', { name: /^What/ }).selectOption({ label: 'Lightning' });
      assert.equal(await logbook.getByLabel('Hatch').count(), 0);
      await logbook
        .getByRole('combobox', { name: /^What/ })
        .selectOption({ label: 'Magnetic cargo' });
      await logbook.getByLabel('Loaded').fill('2026-05-09T06:00');
      await logbook.getByLabel('Discharged').fill('2026-05-08T06:00');
      await logbook.getByRole('combobox', { name: /^Cargo/ }).selectOption({ label: 'Scrap' });
      await logbook.getByLabel('Hatch').fill('2');
      await logbook.getByRole('textbox', { name: /^Port/ }).fill('Bilbao');
      await logbook.getByLabel('Remarks').fill('Shredded, some 4000 t');
      await logbook.getByRole('button', { name: 'Report' }).click();
      await logbook.getByRole('alert').filter({ hasText: 'before it begins' }).waitFor();
      await shoot('logbook-form', {}, logbook);
      const discharged = logbook.getByLabel('Discharged');
      await discharged.and(page.locator(':focus')).waitFor();
      // A day without its hour is no time yet, and not as if nothing had been typed.
      await discharged.fill('');
      await page.keyboard.type('05102026');
      await page.keyboard.press('Enter');
      assert.equal(
        await discharged.evaluate((field) => field.validationMessage),
        'Finish this, or clear it.',
      );
      assert.equal(await logbook.getByRole('listitem').count(), 0);
      await discharged.fill('2026-05-10T06:00');
      await discharged.fill('');
      await logbook.getByLabel('Remarks').press('Tab');
      await page.keyboard.press('Enter');
      await logbook.getByText('since 9 May 2026, 06:00 UTC').first().waitFor();
      await logbook.getByText('Scrap, hatch 2, Bilbao').waitFor();

      await logbook.getByRole('button', { name: /^Discharged/ }).click();
      await logbook.getByLabel('Discharged').fill('2026-05-09T09:00');
      await logbook.getByRole('button', { name: 'Save' }).click();
      await logbook.getByText('9 May 2026, 06:00 – 09:00 UTC').first().waitFor();

      await logbook.getByRole('button', { name: 'Report' }).click();
      await logbook.getByRole('combobox', { name: /^What/ }).selectOption({ label: 'Lightning' });
      await logbook.getByLabel(/^When /).fill('2026-05-10T03:12');
      await logbook.getByRole('button', { name: 'Report' }).click();
      await logbook.getByRole('listitem').nth(1).waitFor();
      await logbook.getByRole('button', { name: /^Withdraw: Lightning/ }).click();
      await shoot('logbook-withdraw', {}, logbook);
      await logbook.getByRole('button', { name: 'Keep it' }).click();
      await logbook.getByRole('button', { name: /^Withdraw: Lightning/ }).click();
      await logbook.getByLabel('Why').fill('It was another ship');
      await logbook.getByRole('button', { name: 'Withdraw the entry' }).click();
      await logbook.locator('s', { hasText: 'Lightning' }).waitFor();
      await logbook.getByText(/Withdrawn by Test Officer/).waitFor();
      await fitsItsWidth(page);
      await shoot('logbook', {}, logbook);
    },
  },

  'what the reader begins while a report is on its way stays open': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Changes');
      const logbook = page.getByRole('region', { name: 'Logbook' });
      let release = () => undefined;
      const released = new Promise((resolve) => (release = resolve));
      await page.route('**/logbook', async (route) => {
        if (route.request().method() !== 'POST') return route.continue();
        const response = await route.fetch();
        // It is written, and told live; its answer is still on the way.
        await released;
        return route.fulfill({ response });
      });
      await logbook.getByRole('button', { name: 'Report' }).click();
      await logbook.getByRole('combobox', { name: /^What/ }).selectOption({ label: 'Remark' });
      await logbook.getByLabel('Remarks').fill('Slow answer');
      await logbook.getByRole('button', { name: 'Report' }).click();
      const entry = logbook.getByRole('listitem').filter({ hasText: 'Slow answer' });
      await entry.getByRole('button', { name: /^Withdraw/ }).click();
      await entry.getByLabel('Why').fill('Half a sen');
      const answered = page.waitForResponse(
        (response) => response.url().endsWith('/logbook') && response.request().method() === 'POST',
      );
      release();
      await answered;
      await logbook.getByRole('status').getByText('Reported.').waitFor();
      assert.equal(await entry.getByLabel('Why').inputValue(), 'Half a sen');
      await entry.getByLabel('Why').fill('A test');
      await entry.getByRole('button', { name: 'Withdraw the entry' }).click();
      await logbook.locator('s', { hasText: 'Slow answer' }).waitFor();
    },
  },

  'an entry that is amended stays when newer ones take its place in the list': {
    allowedErrors: [notSignedIn, /status of 404 .*\/(model|deviation)\b/],
    async run({ page, settings }) {
      await signIn(page, settings);
      const post = async (path, data) => {
        const headers = { 'X-Binnacle-Request': '1' };
        const answer = await page.request.post(path, { headers, data });
        assert.ok(answer.ok(), await answer.text());
        return answer.json();
      };
      const { id } = await post('/api/v1/vessels', { name: 'Long Book' });
      const note = (day, words) =>
        post(`/api/v1/vessels/${id}/logbook`, {
          kind: 'note',
          from: `2026-05-${String(day).padStart(2, '0')}T06:00:00Z`,
          note: words,
        });
      await note(1, 'The oldest');
      await goToVessel(page, id, '/changes');
      const logbook = page.getByRole('region', { name: 'Logbook' });
      const oldest = logbook.getByRole('listitem').filter({ hasText: 'The oldest' });
      await oldest.getByRole('button', { name: /^Amend/ }).click();
      await logbook.getByLabel('Remarks').fill('Half a sen');
      for (let day = 2; day <= 21; day++) await note(day, `The ${day}th`);
      await logbook.getByText('The 21th').waitFor();
      await logbook.getByText('Show earlier entries').waitFor();
      assert.equal(await logbook.getByLabel('Remarks').inputValue(), 'Half a sen');
      await logbook.getByLabel('Remarks').fill('Amended');
      await logbook.getByRole('button', { name: 'Save' }).click();
      await logbook
        .getByRole('status')
        .getByText('The entry has been amended.')
        .waitFor({ state: 'attached' });
      assert.equal(await logbook.getByLabel('Remarks').count(), 0);
      await logbook.getByText('Show earlier entries').click();
      await logbook.getByRole('listitem').nth(20).getByText('Amended', { exact: true }).waitFor();
    },
  },

  'an administrator makes an enrolment code': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Agent');
      await page.getByRole('button', { name: 'Make a code' }).click();
      const code = await page.getByTestId('enrolment-code').innerText();
      assert.ok(code.length >= 8, 'the code is shown');
      await page.getByText(`--code ${code}`).waitFor();
    },
  },

  'a new vessel says what is missing before there is a model': {
    allowedErrors: [
      notSignedIn,
      /status of 404 .*\/(model|deviation)\b/,
      /status of 422 .*\/vessels\b/,
    ],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('button', { name: 'Add a vessel' }).click();
      await page.getByLabel('Name').fill('Browser Test');
      await page.getByLabel('IMO number').fill('1234568');
      await page.getByRole('button', { name: 'Add vessel' }).click();
      await page.getByRole('alert').filter({ hasText: '1234568' }).waitFor();
      await page.getByLabel('IMO number').fill('');
      await page.getByRole('button', { name: 'Add vessel' }).click();
      await page.getByRole('link', { name: 'Browser Test' }).first().click();
      await page.getByTestId('no-model').getByText('No model yet').waitFor();
      await page.getByTestId('no-model').getByText('No sample has been analysed yet').waitFor();
      await shoot('new-vessel', { fullPage: true });
      await openTab(page, 'Deviation');
      await page.getByText('No samples yet.').waitFor();
      await openTab(page, 'Agent');
      await page.getByText('No agent has been enrolled').waitFor();
      await fitsItsWidth(page);
    },
  },

  'a phone shows the same, by night too': {
    viewport: phone,
    colorScheme: 'dark',
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await fitsItsWidth(page);
      await shoot('vessels-phone', { fullPage: true });
      await openVessel(page);
      await chart(page).locator('svg .dots path').first().waitFor({ state: 'attached' });
      await fitsItsWidth(page);
      await shoot('vessel-phone', { fullPage: true });
      await openTab(page, 'Deviation');
      await page.getByTestId('coverage-table').waitFor();
      await fitsItsWidth(page);
      await shoot('deviation-phone', { fullPage: true });
      await shoot('trust-phone', {}, page.locator('#trust'));
      await shoot('parameters-phone', {}, page.locator('#parameters'));
      await openTab(page, 'Changes');
      await fitsItsWidth(page);
      await shoot('history-phone', {}, page.locator('#history'));
      const logbook = page.getByRole('region', { name: 'Logbook' });
      await logbook.getByRole('button', { name: 'Report' }).click();
      await fitsItsWidth(page);
      await shoot('logbook-phone', {}, logbook);
    },
  },
};
