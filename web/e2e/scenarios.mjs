/** What a user must be able to do, each in a browser of its own. */
import assert from 'node:assert/strict';

const phone = { width: 390, height: 844 };
/** Chromium reports every 4xx answer in the console; these are asked for. */
const notSignedIn = /status of 401 .*\/api\/v1\/me\b/;

async function signIn(page, { email, password }) {
  await page.goto('/');
  await page.getByLabel('E-mail').fill(email);
  await page.getByLabel('Password').fill(password);
  await page.getByRole('button', { name: 'Sign in' }).click();
  await page.getByRole('heading', { name: 'Vessels', level: 1 }).waitFor();
}

/** Opens the first vessel of the list that has a model; answers her name. */
async function openVessel(page) {
  const row = page
    .getByRole('row')
    .filter({ hasText: /\(95 %\)/ })
    .first();
  await row.waitFor();
  const name = await row.getByRole('link').innerText();
  await row.getByRole('link').click();
  await page.getByRole('heading', { name, level: 1 }).waitFor();
  await curve(page).waitFor();
  return name;
}

const chart = (page) => page.getByTestId('deviation-chart');
const curve = (page) => chart(page).locator('svg [aria-label="line"] path').last();

/** The first vessel that has a model, by the API. */
async function withModel(page) {
  const listed = await (await page.request.get('/api/v1/vessels')).json();
  return listed.items.find((vessel) => vessel.model);
}

/** The vessel that lightning struck, by the API. */
async function struck(page) {
  const listed = await (await page.request.get('/api/v1/vessels')).json();
  for (const vessel of listed.items) {
    const answer = await page.request.get(`/api/v1/vessels/${vessel.id}/changes`);
    const { changes } = await answer.json();
    if (changes.some((change) => change.cause === 'lightning_or_shock')) return vessel;
  }
  throw new Error('no vessel was struck by lightning');
}

/** Sets the limits of a vessel's alerts. */
async function limit(page, id, limits) {
  const path = `/api/v1/vessels/${id}/settings`;
  const found = await (await page.request.get(path)).json();
  const answer = await page.request.put(path, {
    headers: { 'X-Binnacle-Request': '1' },
    data: { ...found, alerts: { band95_deg: 45, ...limits } },
  });
  assert.ok(answer.ok(), await answer.text());
}

async function fitsItsWidth(page) {
  const excess = await page.evaluate(
    () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
  );
  assert.ok(excess <= 0, `the page is ${excess} px wider than the screen`);
}

export const scenarios = {
  'a wrong password is refused in words': {
    allowedErrors: [notSignedIn, /status of 401 .*\/api\/v1\/session\b/],
    async run({ page, settings, shoot }) {
      await page.goto('/');
      await page.getByLabel('E-mail').fill(settings.email);
      await page.getByLabel('Password').fill(`${settings.password}-not`);
      await page.getByRole('button', { name: 'Sign in' }).click();
      await page.getByRole('alert').filter({ hasText: 'E-mail or password is wrong' }).waitFor();
      assert.equal(await page.getByLabel('Password').inputValue(), '');
      await shoot('wrong-password');
    },
  },

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
      const samples = chart(page).locator('svg [aria-label="dot"] circle');
      await samples.nth(20).waitFor();
      assert.match(
        await chart(page).getByRole('img').getAttribute('aria-label'),
        /° [EW] on \d{3}°/,
      );
      assert.match(await page.getByTestId('worst').innerText(), /^\d+\.\d° [EW]$|^0\.0°$/);

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

      await page.getByTestId('residual-chart').locator('svg circle').first().waitFor();
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
      await page.getByText('accepted', { exact: true }).first().waitFor();
      await fitsItsWidth(page);
      await shoot('vessel', { fullPage: true });
    },
  },

  'the deviation is shown for another place': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      const before = await curve(page).getAttribute('d');
      await page.getByRole('button', { name: 'Choose another place' }).click();
      await page.getByLabel('Latitude').fill('95 N');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await page.getByRole('alert').filter({ hasText: 'Latitude' }).waitFor();
      await page.getByLabel('Latitude').fill('62 30.5 N');
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
    },
  },

  'cargo is reported, discharged and withdrawn': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
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
      await logbook.getByLabel('Discharged').fill('');
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

  'an administrator makes an enrolment code': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openVessel(page);
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
      await page.getByText('No samples yet.').waitFor();
      await page.getByText('No agent has been enrolled').waitFor();
      await fitsItsWidth(page);
      await shoot('new-vessel', { fullPage: true });
    },
  },

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
      await card.getByText('What shows it').click();
      await card.getByText('By the model of the samples').waitFor();
      await page.getByRole('link', { name: 'Binnacle' }).click();
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

  'a webhook is made, tested and removed': {
    allowedErrors: [notSignedIn, /status of 422 .*\/api\/v1\/webhooks\b/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: /^Alerts/ }).click();
      await page.getByRole('link', { name: 'Webhooks' }).click();
      await page.getByText('No program is told of alerts yet').waitFor();
      await page.getByRole('button', { name: 'Add a webhook' }).click();
      const made = page.getByRole('button', { name: 'Make the webhook' });
      await made.click();
      await page.getByRole('alert').getByText('Enter an address').waitFor();
      await page.getByLabel('Address').fill('https://127.0.0.1/hook');
      await made.click();
      await page.getByRole('alert').getByText('not an address of the public internet').waitFor();
      // A name that no resolver knows (RFC 2606).
      await page.getByLabel('Address').fill('https://hooks.invalid/binnacle');
      await made.click();
      await page.getByText(/^bns_/).waitFor();
      await page.getByRole('button', { name: 'Done' }).click();
      const card = page.getByRole('article').filter({ hasText: 'hooks.invalid' });
      await card.getByRole('button', { name: 'Send a test' }).click();
      await card.getByTestId('deliveries').getByText('waiting').waitFor();
      await card.getByTestId('deliveries').getByText('1 try').waitFor();
      await shoot('webhooks', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('webhooks-phone', { fullPage: true });
      await card.getByRole('button', { name: 'Remove' }).click();
      await card.getByRole('button', { name: 'Remove the webhook' }).click();
      await page.getByText('No program is told of alerts yet').waitFor();
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
      await page.goto(`/vessels/${vessel.id}`);
      const changes = page.getByRole('region', { name: 'What changed' });
      const change = changes.getByRole('listitem').filter({ hasText: 'Lightning or a shock' });
      await change.first().waitFor();
      const said = await change.first().innerText();
      assert.match(said, /\d{1,2} [A-Z][a-z]{2} 20\d\d, \d\d:\d\d UTC/);
      assert.match(said, /Deviation changed by \d+\.\d°/);
      assert.match(said, /[+−]\d\.\d ± \d\.\d\sµT fore-and-aft/);
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

  'a ship to whom nothing happened says since when': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const { id: other } = await struck(page);
      const listed = await (await page.request.get('/api/v1/vessels')).json();
      const calm = listed.items.find((vessel) => vessel.model && vessel.id !== other);
      await page.goto(`/vessels/${calm.id}`);
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
      await page.getByTestId('alert-badge').waitFor();
      await fitsItsWidth(page);
      await shoot('vessels-alerts-phone', { fullPage: true });
      await page.getByRole('link', { name: /^Alerts/ }).click();
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

  'the keyboard alone reaches a vessel, and back': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await page.goto('/');
      await page.getByLabel('E-mail').focus();
      await page.keyboard.type(settings.email);
      await page.keyboard.press('Tab');
      await page.keyboard.type(settings.password);
      await page.keyboard.press('Enter');
      await page.getByRole('heading', { name: 'Vessels', level: 1 }).waitFor();
      const link = page.getByRole('row').getByRole('link').first();
      await link.waitFor();
      for (let presses = 0; presses < 30; presses++) {
        if (await link.evaluate((element) => element === document.activeElement)) break;
        await page.keyboard.press('Tab');
      }
      await page.keyboard.press('Enter');
      await page.waitForURL(/\/vessels\//);
      await page.goBack();
      await page.getByRole('heading', { name: 'Vessels', level: 1 }).waitFor();
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
      await chart(page).locator('svg [aria-label="dot"] circle').first().waitFor();
      await page.getByTestId('coverage-table').waitFor();
      await fitsItsWidth(page);
      await shoot('vessel-phone', { fullPage: true });
      await shoot('trust-phone', {}, page.locator('#trust'));
      await shoot('parameters-phone', {}, page.locator('#parameters'));
      const logbook = page.getByRole('region', { name: 'Logbook' });
      await logbook.getByRole('button', { name: 'Report' }).click();
      await fitsItsWidth(page);
      await shoot('logbook-phone', {}, logbook);
    },
  },

  'an address of nobody shows nothing': {
    allowedErrors: [notSignedIn, /status of 404 .*\/api\/v1\/vessels\//],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.goto('/vessels/01900000-0000-7000-8000-000000000000');
      await page.getByRole('heading', { name: 'Nothing here' }).waitFor();
    },
  },

  'losing the server is said, and its return is noticed': {
    allowedErrors: [notSignedIn, /ERR_INTERNET_DISCONNECTED/],
    async run({ page, context, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      await context.setOffline(true);
      await page.getByRole('button', { name: 'Choose another place' }).click();
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await page.getByText('The server cannot be reached', { exact: false }).waitFor();
      await context.setOffline(false);
      await page.getByRole('button', { name: 'Try again' }).click();
      await page
        .getByText('The server cannot be reached', { exact: false })
        .waitFor({ state: 'detached' });
    },
  },

  'signing out ends the session': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.getByRole('button', { name: 'Sign out' }).click();
      await page.getByRole('button', { name: 'Sign in' }).waitFor();
      await page.goto('/');
      await page.getByRole('button', { name: 'Sign in' }).waitFor();
    },
  },
};
